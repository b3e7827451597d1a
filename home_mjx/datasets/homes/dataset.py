"""Writes datasets of homes."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from home_mjx.datasets.homes.build import build_home
from home_mjx.datasets.homes.outside.models import outside_models
from home_mjx.datasets.homes.structure import structure_models
from home_mjx.datasets.homes.textures.recipes import texture, texture_names
from home_mjx.datasets.homes.things.categories import CATEGORIES
from home_mjx.datasets.procedural.categories import Category
from home_mjx.datasets.procedural.dataset import Generator, library_model, write_seeds
from home_mjx.datasets.procedural.furniture import library
from home_mjx.datasets.procedural.primitives.textures import RECIPES as BEFORE
from home_mjx.datasets.procedural.primitives.textures import Image
from home_mjx.datasets.suncg.write.house import write_house
from home_mjx.datasets.suncg.write.metadata import LibraryModel

VERSION = 2  # raise it whenever the same seed would give another file
OWN = {
    "garage_door": Category("garage_door", "door", ("n03221720", "door.n.01")),
    "roof": Category("roof", "otherstructure", ("n04105068", "roof.n.01")),
}

OUTDOORS = tuple(
    name for family in ("roof", "front", "foliage", "grass", "path", "concrete") for name in texture_names(family)
)


def generate_homes(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Writes one home per seed; arguments and errors are those of `home_mjx.datasets.generate_dataset`."""
    return write_seeds(root, seeds, Generator(VERSION, library_models, write_home, textures), progress)


def library_models() -> list[LibraryModel]:
    """Every model that homes may use, in the order of the metadata rows."""
    families = (*structure_models().values(), *outside_models().values())
    own = [model for models in families for model in models]
    return [library_model(model, {**CATEGORIES, **OWN}) for model in (*library().values(), *own)]


def textures() -> Mapping[str, Image]:
    """Every texture that homes may use, by name."""
    return {name: texture(name) for name in (*BEFORE, *OUTDOORS)}


def write_home(root: Path, seed: int) -> None:
    """Writes the home of a seed below a dataset root."""
    write_house(root, build_home(seed))
