"""Generation of datasets by generator version."""

import gc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from home_mjx.datasets.suncg.write.house import write_house
from home_mjx.errors import ConfigError
from home_procgen.build import build_home
from home_procgen.dataset_writer import Generator, write_seeds
from home_procgen.model_library import has_intact_library, save_intact_index, write_library_tables, write_used_models
from home_procgen.v1 import dataset as flats

GENERATOR_VERSION = 3  # increase it whenever the same seed would produce another file


def generate_dataset(
    root: str | Path, seeds: Sequence[int], progress: bool = False, version: int = flats.VERSION
) -> tuple[str, ...]:
    """Write one house per seed and the shared library in SUNCG's on-disk format.

    A seed always produces the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only files that differ are rewritten. Many houses are written by worker
    processes, so scripts that request them need the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; created if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.
        version: Generator version. 1: flats on one floor; 3: homes of up to three storeys.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1, or the version is unknown.
        DatasetError: `root` cannot be written, or contains other data.

    Example:
        >>> ids = generate_dataset("houses", range(8), version=3)  # doctest: +SKIP
    """
    check_version(version)
    return VERSIONS[version](root, seeds, progress)


def check_version(version: object) -> None:
    """Raise `ConfigError` if no generator has this version."""
    if isinstance(version, bool) or version not in VERSIONS:
        raise ConfigError(f"no generator has version {version!r}", hint=f"Known: {sorted(VERSIONS)}.")


def generate_homes(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Write one home per seed; arguments and errors are those of `generate_dataset`."""
    generator = Generator(GENERATOR_VERSION, write_library_tables, write_home, has_intact_library)
    ids = write_seeds(root, seeds, generator, progress)
    save_intact_index(Path(root).expanduser().absolute())
    return ids


def write_home(root: Path, seed: int) -> None:
    """Write the home of a seed below a dataset root, and the models and textures it uses that are not there yet."""
    with _pause_gc():
        home = build_home(seed)
        write_used_models(root, home)
        write_house(root, home)


@contextmanager
def _pause_gc() -> Iterator[None]:
    """Suspend cyclic garbage collection: it would scan all models repeatedly, and a home creates few cycles."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


VERSIONS: Mapping[int, Any] = {flats.VERSION: flats.generate_dataset, GENERATOR_VERSION: generate_homes}
