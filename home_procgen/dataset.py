"""Writer of home datasets."""

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from home_mjx.datasets.suncg.write.house import write_house
from home_procgen.build import build_home
from home_procgen.library import has_intact_library, write_library_tables, write_used_models
from home_procgen.v1.dataset import Generator, write_seeds

GENERATOR_VERSION = 2  # increase it whenever the same seed would produce another file


def generate_homes(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Write one home per seed; arguments and errors are those of `home_mjx.datasets.generate_dataset`."""
    return write_seeds(
        root, seeds, Generator(GENERATOR_VERSION, write_library_tables, write_home, has_intact_library), progress
    )


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
