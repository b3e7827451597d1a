"""Writes a dataset of generated houses."""

from collections.abc import Sequence
from pathlib import Path

from home_mjx.datasets.suncg.write.house import write_house, write_library
from home_procgen.dataset_writer import Generator, library_model, write_seeds
from home_procgen.primitives.textures import BASE_RECIPES, base_texture
from home_procgen.v1.build import build_house
from home_procgen.v1.furniture import library

VERSION = 1  # raise it whenever the same seed would give another file


def generate_dataset(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Writes one house per seed, and the shared library, in SUNCG's on-disk format.

    A seed always gives the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only what differs from what was written is written again. Many houses are
    written by worker processes: a script that asks for them needs the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; made if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1.
        DatasetError: `root` cannot be written, or holds something else.

    Example:
        >>> ids = generate_dataset("houses", range(8))  # doctest: +SKIP
    """
    return write_seeds(root, seeds, Generator(VERSION, _write_library, _write, lambda _root, _house: True), progress)


def _write_library(root: Path) -> None:
    models = [library_model(model) for model in library().values()]
    write_library(root, models, {name: base_texture(name) for name in BASE_RECIPES})


def _write(root: Path, seed: int) -> None:
    write_house(root, build_house(seed))
