"""Generation of datasets: one house per seed, and the shared library."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from home_mjx.core.native.numba_cache import pause_gc
from home_mjx.datasets.suncg.write.house import write_house
from home_procgen.build import build_home
from home_procgen.dataset_writer import write_seeds
from home_procgen.model_library import write_used_models
from home_procgen.presets import HOME_VARIANT, Variant


def generate_dataset(
    root: str | Path, seeds: Sequence[int], progress: bool = False, preset: str = "home", detail: str = ""
) -> tuple[str, ...]:
    """Write one house per seed and the shared library in SUNCG's on-disk format.

    A seed always produces the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only files that differ are rewritten. Many houses are written by worker
    processes, so scripts that request them need the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; created if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.
        preset: `home`, of one to three storeys; or `flat`: one storey, 3 to 6 rooms, few small objects, no
            surroundings.
        detail: `full` or `low`, the level of detail of the models; "": that of the preset, low in flats.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1, or the preset or the detail is unknown.
        DatasetError: `root` cannot be written, or contains other data.

    Example:
        >>> ids = generate_dataset("houses", range(8))  # doctest: +SKIP
    """
    variant = Variant(preset, detail)
    return write_seeds(root, seeds, variant, partial(write_home, variant=variant), progress)


def write_home(root: Path, seed: int, variant: Variant = HOME_VARIANT) -> None:
    """Write the home of a seed below a dataset root, and the models and textures it uses that are not there yet."""
    with pause_gc():  # a home creates few cycles, and models many objects
        home = build_home(seed, variant)
        write_used_models(root, home, variant.detail)
        write_house(root, home)
