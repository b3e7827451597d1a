"""Shared library of a home dataset: tables of all models; model and texture files written on first use."""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from functools import cache, lru_cache
from pathlib import Path

from PIL import Image

from home_mjx.core.files import read_text
from home_mjx.datasets.suncg.digest_index import DigestIndex, FileFacts, Stamp, index_folder
from home_mjx.datasets.suncg.write.house import (
    JOINTS_DIGEST,
    is_folder_complete,
    write_model,
    write_table_texts,
    write_textures,
)
from home_mjx.datasets.suncg.write.metadata import LibraryModel
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House, Material, ModelInfo
from home_procgen.floor_plan.structure import structure_models
from home_procgen.model_store import library_model, model_store
from home_procgen.outside.models import outside_models
from home_procgen.primitives.categories import CATEGORIES, Category
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel
from home_procgen.textures.recipes import texture

MODEL_CATEGORIES = {**CATEGORIES, "roof": Category("roof", "otherstructure", ("n04105068", "roof.n.01"))}


@cache
def building_models() -> Mapping[str, FurnitureModel]:
    """Return the models outside `things`, by id: those of the building and of its surroundings."""
    families = (*structure_models().values(), *outside_models().values())
    return {model.id: model for models in families for model in models}


def write_library_tables(root: Path, detail: str = DETAILS[0]) -> None:
    """Write the metadata tables. They list every model, so they do not depend on the homes of the dataset.

    Args:
        root: Dataset root.
        detail: Level of detail of the models.
    """
    folder = root / "metadata"
    if is_folder_complete(folder) and is_folder_complete(folder, JOINTS_DIGEST):
        return
    write_table_texts(root, model_store().tables[detail])


def table_rows(models: Iterable[FurnitureModel]) -> list[LibraryModel]:
    """Return models with their rows in the metadata tables."""
    return [_with_row(model) for model in models]


def _with_row(model: FurnitureModel) -> LibraryModel:
    category = MODEL_CATEGORIES[model.fine]
    variants = {f"{model.id}_0": model.closed} if model.closed is not None else {}
    info = ModelInfo(model.id, model.fine, category.coarse, category.nyu40)
    return LibraryModel(info, model.mesh, category.synset, variants, model.lights, model.joints)


def has_intact_library(root: Path, house_id: str) -> bool:
    """Return whether all models and textures of a written home exist and are intact.

    Files are read only if their sizes, times or inodes differ from those in an index on disk, see `DigestIndex`.

    Args:
        root: Dataset root.
        house_id: Id of the home.
    """
    used = _intact_index(root).facts(
        f"house/{house_id}",
        _stamp(root / "house" / house_id, root / "room" / house_id),
        lambda: _facts(_names_in_house(root, house_id)),
    )
    found = [_model_facts(root, name) for name in used.names if name.startswith("object/")] if used.digest else [used]
    textures = {name for facts in (used, *found) for name in facts.names if name.startswith("texture/")}
    return all(facts.digest for facts in found) and all(has_intact_texture(root, Path(n).name) for n in textures)


def save_intact_index(root: Path) -> None:
    """Write the index of intact files to disk, for later processes."""
    _intact_index(root).save()


@lru_cache(maxsize=8)
def _intact_index(root: Path) -> DigestIndex:
    """Return the index of the intact folders and images of a dataset, and of the files that they name."""
    return DigestIndex(index_folder(root) / "intact.json")


def _facts(names: Set[str] | None) -> FileFacts:
    """Return the facts of an intact folder that names other files; None, not intact: the digest is empty."""
    return FileFacts(b"", ()) if names is None else FileFacts(b"intact", tuple(sorted(names)))


def _stamp(*paths: Path) -> Stamp:
    """Return the stamp of files, or of files in folders: total size, last times, sum of inodes; all 0 if missing."""
    found = []
    for path in paths:
        try:
            with os.scandir(path) as entries:
                found += [entry.stat() for entry in entries]
        except NotADirectoryError:
            found.append(path.stat())
        except FileNotFoundError:
            pass
    size, inode = sum(one.st_size for one in found), sum(one.st_ino for one in found)
    return size, max((s.st_mtime_ns for s in found), default=0), max((s.st_ctime_ns for s in found), default=0), inode


def _names_in_house(root: Path, house_id: str) -> Set[str] | None:
    """Return `object/<id>` and `texture/<stem>` of all that a home names; None if one of its files is missing."""
    try:
        text = read_text(root / "house" / house_id / "house.json")
        rooms = [read_text(path) for path in sorted((root / "room" / house_id).glob("*.mtl"))]
    except DatasetError:
        return None
    models = {f"object/{name}" for name in re.findall(r'"modelId":"((?:home|gen)_[^"]+)"', text)}
    textures = {f"texture/{name}" for name in re.findall(r'"texture":"([^"]+)"', text)}
    return models.union(textures, *(_textures_of(mtl) for mtl in rooms))


def _textures_of(mtl: str) -> set[str]:
    return {f"texture/{Path(path).stem}" for path in re.findall(r"map_Kd (\S+)", mtl)}


def _model_facts(root: Path, name: str) -> FileFacts:
    folder = root / name

    def look() -> FileFacts:
        return _facts(_textures_of(read_text(folder / f"{folder.name}.mtl")) if is_folder_complete(folder) else None)

    return _intact_index(root).facts(name, _stamp(folder), look)


def has_intact_texture(root: Path, stem: str) -> bool:
    """Return whether the texture with a name exists and is an image."""
    path = root / "texture" / f"{stem}.png"
    facts = _intact_index(root).facts(
        f"texture/{stem}", _stamp(path), lambda: _facts(set() if _is_image(path) else None)
    )
    return bool(facts.digest)


def _is_image(path: Path) -> bool:
    try:
        with Image.open(path) as image:
            image.load()
        return True
    except (OSError, ValueError, SyntaxError):  # raised by Pillow if the file is not an image
        return False


def write_used_models(root: Path, home: House, detail: str = DETAILS[0]) -> None:
    """Write the models and textures of a home that are missing or damaged.

    Args:
        root: Dataset root.
        home: The home that uses them.
        detail: Level of detail of the models.

    Raises:
        DatasetError: The folders cannot be written.
    """
    for name in sorted({item.model_id for level in home.levels for item in level.objects}):
        if not _model_facts(root, f"object/{name}").digest:
            model = building_models().get(name) or library_model(name, detail)
            write_model(root, _with_row(model), digests=True)
    every = (material for materials in _materials(home) for material in materials)
    write_textures_named(root, {material.texture.stem for material in every if material.texture is not None})


def _materials(home: House) -> Iterator[tuple[Material, ...]]:
    """Generate the materials of the home's parts, and the default materials of its models."""
    yield from (mesh.materials for mesh in home.models.values())
    for level in home.levels:
        yield from (item.materials for item in (*level.objects, *level.boxes))
        yield from (ground.mesh.materials for ground in level.grounds if ground.mesh is not None)
        for room in level.rooms:
            yield from (mesh.materials for mesh in (room.floor, room.ceiling, room.walls) if mesh is not None)


def write_textures_named(root: Path, names: Set[str]) -> None:
    """Write the textures with some names that are missing or damaged."""
    for name in sorted(names):
        if not has_intact_texture(root, name):
            write_textures(root, {name: texture(name)})
