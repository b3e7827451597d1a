"""The library of a dataset of homes: tables of all models; models and textures as homes come to use them."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from home_mjx.core.files import read_text
from home_mjx.datasets.homes.outside.models import outside_models
from home_mjx.datasets.homes.structure import structure_models
from home_mjx.datasets.homes.textures.recipes import texture
from home_mjx.datasets.homes.things import library as things
from home_mjx.datasets.homes.things import library_model as thing
from home_mjx.datasets.homes.things.categories import CATEGORIES
from home_mjx.datasets.procedural.categories import Category
from home_mjx.datasets.procedural.dataset import library_model
from home_mjx.datasets.procedural.primitives.family import Furniture
from home_mjx.datasets.suncg.write.house import DIGESTS, write_model, write_tables, write_textures
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House, Material

CLASSES = {**CATEGORIES, "roof": Category("roof", "otherstructure", ("n04105068", "roof.n.01"))}

_written: dict[Path, set[str]] = {}  # by this process, below each root


@cache
def _others() -> Mapping[str, Furniture]:
    """Models that are no things: of the building and of what is around it."""
    families = (*structure_models().values(), *outside_models().values())
    return {model.id: model for models in families for model in models}


def write_shared(root: Path) -> None:
    """Writes the tables, which list every model, so that they do not depend on which homes there are.

    Tables that are as they were written are kept: making them means building all models.
    """
    if _tables_are_whole(root / "metadata"):
        return
    models = (*things().values(), *_others().values())
    write_tables(root, [library_model(model, CLASSES) for model in models], digests=True)


def _tables_are_whole(folder: Path) -> bool:
    try:
        digests: dict[str, str] = json.loads(read_text(folder / DIGESTS))
        texts = {name: read_text(folder / name) for name in digests}
        return all(hashlib.sha256(text.encode()).hexdigest() == digests[name] for name, text in texts.items())
    except (DatasetError, ValueError, TypeError, AttributeError, RecursionError):
        return False


def write_used(root: Path, home: House) -> None:
    """Writes the models and textures of a home that this process has not written yet; what differs is mended.

    Args:
        root: Dataset root.
        home: Whose.

    Raises:
        DatasetError: The folders cannot be written.
    """
    done = _written.setdefault(root, set())
    used = sorted({item.model_id for level in home.levels for item in level.objects})
    for name in (name for name in used if name not in done):
        model = _others().get(name) or thing(name)
        write_model(root, library_model(model, CLASSES))
        _write_textures(root, done, model.mesh.materials)
        done.add(name)
    for materials in _materials(home):
        _write_textures(root, done, materials)


def _materials(home: House) -> Iterator[tuple[Material, ...]]:
    for level in home.levels:
        yield from (item.materials for item in (*level.objects, *level.boxes))
        yield from (ground.mesh.materials for ground in level.grounds if ground.mesh is not None)
        for room in level.rooms:
            yield from (mesh.materials for mesh in (room.floor, room.ceiling, room.walls) if mesh is not None)


def _write_textures(root: Path, done: set[str], materials: tuple[Material, ...]) -> None:
    names = {m.texture.name for m in materials if m.texture is not None} - done
    if names:
        write_textures(root, {Path(name).stem: texture(Path(name).stem) for name in sorted(names)})
        done |= names
