"""Writes datasets of homes."""

from collections.abc import Sequence
from pathlib import Path

from home_mjx.datasets.homes.build import build_home
from home_mjx.datasets.homes.structure import structure_models
from home_mjx.datasets.procedural.categories import CATEGORIES, Category
from home_mjx.datasets.procedural.dataset import Generator, library_model, write_seeds
from home_mjx.datasets.procedural.furniture import library
from home_mjx.datasets.suncg.write.house import write_house
from home_mjx.datasets.suncg.write.metadata import LibraryModel

VERSION = 2  # raise it whenever the same seed would give another file
OWN = {"garage_door": Category("garage_door", "door", ("n03221720", "door.n.01"))}


def generate_homes(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Writes one home per seed; arguments and errors are those of `home_mjx.datasets.generate_dataset`."""
    return write_seeds(root, seeds, Generator(VERSION, library_models, write_home), progress)


def library_models() -> list[LibraryModel]:
    """Every model that homes may use, in the order of the metadata rows."""
    own = [model for models in structure_models().values() for model in models]
    return [library_model(model, {**CATEGORIES, **OWN}) for model in (*library().values(), *own)]


def write_home(root: Path, seed: int) -> None:
    """Writes the home of a seed below a dataset root."""
    write_house(root, build_home(seed))
