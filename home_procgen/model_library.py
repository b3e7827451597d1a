"""Shared library of a home dataset: tables of all models; model and texture files written on first use."""

import os
import re
from collections.abc import Iterator, Mapping, Set
from functools import cache, lru_cache
from pathlib import Path

from PIL import Image

from home_mjx.core.files import read_text
from home_mjx.datasets.suncg.write.house import (
    JOINTS_DIGEST,
    is_folder_complete,
    write_joints,
    write_model,
    write_tables,
    write_textures,
)
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House, Material
from home_procgen.dataset_writer import library_model
from home_procgen.floor_plan.structure import structure_models
from home_procgen.outside.models import outside_models
from home_procgen.primitives.categories import CATEGORIES, Category
from home_procgen.primitives.family import FurnitureModel
from home_procgen.textures.recipes import texture
from home_procgen.things import library as things
from home_procgen.things import library_model as thing

MODEL_CATEGORIES = {**CATEGORIES, "roof": Category("roof", "otherstructure", ("n04105068", "roof.n.01"))}


@cache
def _building_models() -> Mapping[str, FurnitureModel]:
    """Return the models outside `things`, by id: those of the building and of its surroundings."""
    families = (*structure_models().values(), *outside_models().values())
    return {model.id: model for models in families for model in models}


def write_library_tables(root: Path) -> None:
    """Write the metadata tables. They list every model, so they do not depend on the homes of the dataset.

    Intact tables are kept, because building them requires building all models.
    """
    folder = root / "metadata"
    if is_folder_complete(folder) and is_folder_complete(folder, JOINTS_DIGEST):
        return
    models = [library_model(model, MODEL_CATEGORIES) for model in (*things().values(), *_building_models().values())]
    write_tables(root, models, digests=True)
    write_joints(root, models)


def has_intact_library(root: Path, house_id: str) -> bool:
    """Return whether all models and textures of a written home exist and are intact.

    Args:
        root: Dataset root.
        house_id: Id of the home.
    """
    try:
        text = read_text(root / "house" / house_id / "house.json")
        rooms = [read_text(path) for path in sorted((root / "room" / house_id).glob("*.mtl"))]
    except DatasetError:
        return False
    models = [root / "object" / name for name in set(re.findall(r'"modelId":"((?:home|gen)_[^"]+)"', text))]
    textures = set(re.findall(r'"texture":"([^"]+)"', text)).union(*(_textures_of(mtl) for mtl in rooms))
    for folder in models:
        if not _is_intact_folder(folder, _file_stamp(folder)):
            return False
        textures |= _textures_of(read_text(folder / f"{folder.name}.mtl"))
    return all(
        _is_intact_image(path, _file_stamp(path)) for path in (root / "texture" / f"{name}.png" for name in textures)
    )


def _textures_of(mtl: str) -> set[str]:
    return {Path(path).stem for path in re.findall(r"map_Kd (\S+)", mtl)}


def _file_stamp(path: Path) -> tuple[int, ...]:
    """Return sizes and modification times of a file, or of a folder's files; an equal stamp means unchanged files."""
    try:
        with os.scandir(path) as entries:
            found = [entry.stat() for entry in sorted(entries, key=lambda entry: entry.name)]
    except NotADirectoryError:
        found = [path.stat()]
    except FileNotFoundError:
        found = []
    return tuple(number for one in found for number in (one.st_size, one.st_mtime_ns))


@lru_cache(maxsize=4096)
def _is_intact_folder(folder: Path, stamp: tuple[int, ...]) -> bool:
    return bool(stamp) and is_folder_complete(folder)


@lru_cache(maxsize=4096)
def _is_intact_image(path: Path, stamp: tuple[int, ...]) -> bool:
    try:
        with Image.open(path) as image:
            image.load()
        return bool(stamp)
    except (OSError, ValueError, SyntaxError):  # raised by Pillow if the file is not an image
        return False


def write_used_models(root: Path, home: House) -> None:
    """Write the models and textures of a home that are missing or damaged.

    Args:
        root: Dataset root.
        home: The home that uses them.

    Raises:
        DatasetError: The folders cannot be written.
    """
    for name in sorted({item.model_id for level in home.levels for item in level.objects}):
        folder = root / "object" / name
        if not _is_intact_folder(folder, _file_stamp(folder)):
            model = _building_models().get(name) or thing(name)
            write_model(root, library_model(model, MODEL_CATEGORIES), digests=True)
    every = (material for materials in _materials(home) for material in materials)
    _write_textures(root, {material.texture.stem for material in every if material.texture is not None})


def _materials(home: House) -> Iterator[tuple[Material, ...]]:
    """Generate the materials of the home's parts, and the default materials of its models."""
    yield from (mesh.materials for mesh in home.models.values())
    for level in home.levels:
        yield from (item.materials for item in (*level.objects, *level.boxes))
        yield from (ground.mesh.materials for ground in level.grounds if ground.mesh is not None)
        for room in level.rooms:
            yield from (mesh.materials for mesh in (room.floor, room.ceiling, room.walls) if mesh is not None)


def _write_textures(root: Path, names: Set[str]) -> None:
    for name in sorted(names):
        path = root / "texture" / f"{name}.png"
        if not _is_intact_image(path, _file_stamp(path)):
            write_textures(root, {name: texture(name)})
