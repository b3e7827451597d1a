"""The generated houses that stand in where no dataset is named."""

import itertools
from collections.abc import Sequence
from pathlib import Path

from home_mjx.core.paths import cache_folder
from home_mjx.datasets.procedural.dataset import VERSION, generate_dataset
from home_mjx.datasets.seeds import house_id, seeds_of
from home_mjx.datasets.splits import select_ids


def generated_houses(num_houses: int, progress: bool = False, split: str | None = None) -> tuple[Path, tuple[str, ...]]:
    """The first generated houses; made on first use and kept in the cache folder.

    Args:
        num_houses: How many.
        progress: Show a progress bar.
        split: Of those that belong to it.

    Returns:
        Root of their dataset, which may hold others, and their ids.

    Raises:
        ConfigError: There is no such split.
        DatasetError: The cache folder cannot be written to.
    """
    root = _root()
    seeds = (seed for seed in itertools.count() if select_ids([house_id(seed)], split))
    return root, generate_dataset(root, list(itertools.islice(seeds, num_houses)), progress=progress)


def houses_by_id(ids: Sequence[str], progress: bool = False) -> Path:
    """Generated houses by their ids, such as those that a file names; made on first use, in the same folder.

    Args:
        ids: Of houses of the first generator.
        progress: Show a progress bar.

    Returns:
        Root of their dataset, which may hold others.

    Raises:
        UnknownIdError: One is no generated house.
        DatasetError: The cache folder cannot be written to.
    """
    root = _root()
    generate_dataset(root, list(seeds_of(ids)), progress=progress)
    return root


def _root() -> Path:
    return cache_folder() / f"generated-v{VERSION}"
