"""Selection of fallbacks for missing parts of a house, with a list of them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.core.files import is_file
from home_mjx.datasets.suncg.fallbacks.extent import model_box
from home_mjx.datasets.suncg.fallbacks.known_models import has_row, with_known_models
from home_mjx.datasets.suncg.fallbacks.listing import lacking_materials_of
from home_mjx.datasets.suncg.fallbacks.models import fallback_model
from home_mjx.datasets.suncg.fallbacks.rooms import Gap, room_shape, slab_mesh, stand_in_part
from home_mjx.datasets.suncg.formats.element import Place
from home_mjx.datasets.suncg.formats.mtl import read_mtl
from home_mjx.datasets.suncg.read.reading import Reading
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import Ground, House, Material, Metadata, ModelInfo, Node, Object, Room, StandIn

OPENINGS = ("door", "window", "arch", "garage_door")
FIELDS = {"Floor": "floor", "Ceiling": "ceiling", "Wall": "walls"}
LETTERS = {"Floor": "f", "Ceiling": "c", "Wall": "w", "Ground": "f"}
LAWN = Material("", (0.45, 0.55, 0.35), None, 1.0)


def stand_in_for_model(item: Object, error: DatasetError, reading: Reading) -> None:
    """Store a fallback for an object's model in `reading.models`; for a door, also for its other state.

    Args:
        item: Object with the missing model.
        error: Error of reading its model.
        reading: State of the reader.
    """
    info = _info(reading.tables, item.model_id)
    box, closed = model_box(info, item.transform, item.bbox), item.model_key != item.model_id
    path = reading.assets.model_path(item.model_id, item.model_key)
    reading.models[item.model_key], words = fallback_model(path, info.fine, box, closed)
    reading.stood_in.add(item.model_key)
    if info.fine == "door":
        other = path.with_name(f"{item.other_key}.obj")
        reading.others[item.other_key] = fallback_model(other, info.fine, box, not closed)[0]
    reading.stand_ins.append(StandIn("model", item.model_key, item.path, words, _reason(error)))


def _reason(error: DatasetError) -> str:
    return "" if isinstance(error, MissingFileError) else error.message


def _info(tables: Metadata, model_id: str) -> ModelInfo:
    return with_known_models(tables).info(model_id)


def stand_in_for_parts(nodes: Sequence[Node], reading: Reading) -> list[Node]:
    """Return a level's nodes, with fallbacks for missing meshes of rooms and grounds.

    Args:
        nodes: Nodes of a level.
        reading: State of the reader.
    """
    if not reading.lacking_parts:
        return list(nodes)
    gaps = [gap for node in nodes if isinstance(node, Object) and (gap := _gap(node, reading)) is not None]
    found = {node.path: _with_parts(node, gaps, reading) for node in nodes if isinstance(node, Room | Ground)}
    return [found.get(node.path, node) for node in nodes]


def _gap(item: Object, reading: Reading) -> Gap | None:
    """Return the wall span of a door, window or arch; None for other objects."""
    info = _info(reading.tables, item.model_id)
    if info.coarse not in OPENINGS:
        return None
    mesh = reading.models[item.model_key]
    box = model_box(info, item.transform, item.bbox)
    box = np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)]) if box is None else box
    ends = np.array([[box[0, 0], box[0, 1], 0.0], [box[1, 0], box[1, 1], 0.0]])
    moved = ends @ item.transform[:3, :3].T + item.transform[:3, 3]
    low, high = np.sort(moved[:, 1]).tolist()
    return Gap(moved[0, [0, 2]], moved[1, [0, 2]], low, high)


def _with_parts(node: Room | Ground, gaps: Sequence[Gap], reading: Reading) -> Room | Ground:
    kinds = [kind for kind in LETTERS if (node.path, kind) in reading.lacking_parts]
    if isinstance(node, Ground):
        return _with_ground(node, reading) if kinds else node
    shape = room_shape(node, gaps) if kinds else None
    for kind in kinds:
        path, reason = _lacking(node, kind, reading)
        if shape is None:
            _give_up(node, path, reading)
            continue
        mesh = stand_in_part(kind, shape, node, path, gaps, _materials(path, reading))
        node = replace(node, **{FIELDS[kind]: mesh})
        taken = f"{kind.lower()} made from {shape.source}"
        reading.stand_ins.append(StandIn("room mesh", path.stem, node.path, taken, reason))
    return node


def _with_ground(node: Ground, reading: Reading) -> Ground:
    path, reason = _lacking(node, "Ground", reading)
    size = np.zeros(3) if node.bbox is None else node.bbox[1] - node.bbox[0]
    if node.bbox is None or size.min() <= 0:
        _give_up(node, path, reading)
        return node
    (x0, y0, z0), (x1, y1, z1) = node.bbox.tolist()
    corners = np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
    mesh = slab_mesh(f"Ground#{node.id}", corners, (y0, y1), path, _materials(path, reading), LAWN)
    reading.stand_ins.append(StandIn("room mesh", path.stem, node.path, "ground made from its bounding box", reason))
    return replace(node, mesh=mesh)


def _lacking(node: Room | Ground, kind: str, reading: Reading) -> tuple[Path, str]:
    """Return the path of a missing mesh, and the reason if the file exists but cannot be read."""
    path = reading.assets.room_path(reading.house_id, node.model_id + LETTERS[kind])
    return path, reading.lacking_parts[node.path, kind]


def _give_up(node: Room | Ground, path: Path, reading: Reading) -> None:
    place = Place(reading.assets.root, f"{node.path}.modelId")
    reading.note(place, "missing-part", f"mesh {path.name} is missing, and its outline is unknown: not shown")


def _materials(path: Path, reading: Reading) -> Sequence[Material]:
    """Read the materials of a missing mesh, if its MTL exists."""
    library = path.with_suffix(".mtl")
    try:
        return read_mtl(library, reading.assets.textures) if is_file(library) else ()
    except DatasetError:
        return ()


def all_stand_ins(house: House, reading: Reading) -> tuple[StandIn, ...]:
    """Return all fallbacks of a house in the order of `STAND_INS`, each once.

    Args:
        house: House as read.
        reading: State of the reader.
    """
    nodes = [node for level in house.levels for node in level.objects]
    without = {node.model_id: node for node in nodes if not has_row(reading.tables, node.model_id)}
    rows = [
        StandIn("metadata row", name, node.path, f"category `{_info(reading.tables, name).fine}`")
        for name, node in without.items()
    ]
    return (*lacking_materials_of(house), *reading.stand_ins, *rows)
