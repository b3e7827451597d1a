"""Generated houses by version of their generator, on disk or by a name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.homes import dataset as homes
from home_mjx.datasets.procedural import dataset as procedural
from home_mjx.datasets.seeds import house_id
from home_mjx.errors import ConfigError

VERSIONS: Mapping[int, Any] = {procedural.VERSION: procedural.generate_dataset, homes.VERSION: homes.generate_homes}
PREFIX = "procedural:"
FORM = "Write `procedural:N` or `procedural:N?seed=S&version=V`, all whole numbers."


def generate_dataset(
    root: str | Path, seeds: Sequence[int], progress: bool = False, version: int = procedural.VERSION
) -> tuple[str, ...]:
    """Writes one house per seed, and the shared library, in SUNCG's on-disk format.

    A seed always gives the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only what differs from what was written is written again. Many houses are
    written by worker processes: a script that asks for them needs the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; made if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.
        version: Of the generator. 1: flats on one floor; 2: homes of up to three storeys.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1, or there is no such version.
        DatasetError: `root` cannot be written, or holds something else.

    Example:
        >>> ids = generate_dataset("houses", range(8), version=2)  # doctest: +SKIP
    """
    check_version(version)
    return VERSIONS[version](root, seeds, progress)


def check_version(version: object) -> None:
    """Raises `ConfigError` if there is no generator of this version."""
    if isinstance(version, bool) or version not in VERSIONS:
        raise ConfigError(f"there is no generator of version {version!r}", hint=f"There are {sorted(VERSIONS)}.")


@dataclass(frozen=True)
class ProceduralHouses:
    """Generated houses of consecutive seeds, kept in the cache folder.

    Attributes:
        count: How many.
        seed: The first one.
        version: Of the generator.
    """

    count: int
    seed: int = 0
    version: int = procedural.VERSION

    def __post_init__(self) -> None:
        check_number("N", self.count, 1, whole=True)
        check_number("seed", self.seed, 0, whole=True)
        check_version(self.version)

    @classmethod
    def named(cls, text: object) -> "ProceduralHouses | None":
        """The houses of a name; None if it is none, but a folder.

        Args:
            text: Such as `procedural:16?seed=100&version=2`.

        Raises:
            ConfigError: The name has other parts.

        Example:
            >>> ProceduralHouses.named("procedural:16?seed=100")
            ProceduralHouses(count=16, seed=100, version=1)
        """
        if not isinstance(text, str) or not text.startswith(PREFIX):
            return None
        count, _, options = text.removeprefix(PREFIX).partition("?")
        try:
            pairs = dict(parse_qsl(options, keep_blank_values=True, strict_parsing=bool(options)))
            check_known("option of generated houses", pairs, ("seed", "version"))
            return cls(int(count), **{name: int(value) for name, value in pairs.items()})
        except ValueError:
            raise ConfigError(f"`{text}` does not name generated houses", hint=FORM) from None

    @property
    def ids(self) -> tuple[str, ...]:
        """Of the houses, by their seeds."""
        return tuple(house_id(seed) for seed in range(self.seed, self.seed + self.count))

    def write(self, progress: bool = False) -> Path:
        """The root of their dataset, which may hold others; they are made on first use.

        Args:
            progress: Show a progress bar.

        Raises:
            DatasetError: The cache folder cannot be written to.
        """
        root = cache_folder() / f"generated-v{self.version}"
        generate_dataset(root, range(self.seed, self.seed + self.count), progress, self.version)
        return root
