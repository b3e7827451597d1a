"""Generation of datasets by generator version."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from home_mjx.errors import ConfigError
from home_procgen import dataset as homes
from home_procgen.v1 import dataset as procedural

VERSIONS: Mapping[int, Any] = {
    procedural.VERSION: procedural.generate_dataset,
    homes.GENERATOR_VERSION: homes.generate_homes,
}


def generate_dataset(
    root: str | Path, seeds: Sequence[int], progress: bool = False, version: int = procedural.VERSION
) -> tuple[str, ...]:
    """Write one house per seed and the shared library in SUNCG's on-disk format.

    A seed always produces the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only files that differ are rewritten. Many houses are written by worker
    processes, so scripts that request them need the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; created if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.
        version: Generator version. 1: flats on one floor; 2: homes of up to three storeys.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1, or the version is unknown.
        DatasetError: `root` cannot be written, or contains other data.

    Example:
        >>> ids = generate_dataset("houses", range(8), version=2)  # doctest: +SKIP
    """
    check_version(version)
    return VERSIONS[version](root, seeds, progress)


def check_version(version: object) -> None:
    """Raise `ConfigError` if no generator has this version."""
    if isinstance(version, bool) or version not in VERSIONS:
        raise ConfigError(f"no generator has version {version!r}", hint=f"Known: {sorted(VERSIONS)}.")
