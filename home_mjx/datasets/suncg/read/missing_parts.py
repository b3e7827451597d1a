"""Selection of fallbacks for missing parts of a house, with a list of them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.core.files import is_file
from home_mjx.datasets.suncg.fallbacks.builtin_categories import add_builtin_categories, has_category
from home_mjx.datasets.suncg.fallbacks.models import fallback_model, model_box
from home_mjx.datasets.suncg.fallbacks.rooms import OpeningSpan, build_fallback_part, find_room_shape, slab_mesh
from home_mjx.datasets.suncg.fallbacks.summary import list_missing_materials
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.formats.mtl import read_mtl
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata, other_variant
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.read.room_meshes import MESH_SUFFIX
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import Fallback, GroundNode, House, Material, ModelInfo, Node, ObjectNode, RoomNode

OPENING_CATEGORIES = ("door", "window", "arch", "garage_door")
MESH_FIELD = {"Floor": "floor", "Ceiling": "ceiling", "Wall": "walls"}
GROUND_MATERIAL = Material("", (0.45, 0.55, 0.35), None, 1.0)


def add_model_fallback(item: ObjectNode, error: DatasetError, reading: ReaderState) -> None:
    """Store a fallback for an object's model in `reading.models`; for a door, also one of its other state.

    `error` is that of reading the model; the recorded `Fallback` names it unless the file is missing.
    """
    info = _info(reading.tables, item.model_id)
    box, closed = model_box(info, item.transform, item.bbox), item.model_key != item.model_id
    path = reading.assets.model_path(item.model_id, item.model_key)
    reading.models[item.model_key], words = fallback_model(path, info.fine, box, closed)
    reading.fallback_keys.add(item.model_key)
    if info.fine == "door":
        other = other_variant(item.model_id, item.model_key)
        reading.other_models[other] = fallback_model(path.with_name(f"{other}.obj"), info.fine, box, not closed)[0]
    reading.fallbacks.append(Fallback("model", item.model_key, item.path, words, _reason(error)))


def _reason(error: DatasetError) -> str:
    """Return the message of an error; "" if a file is missing."""
    return "" if isinstance(error, MissingFileError) else error.message


def _info(tables: SuncgMetadata, model_id: str) -> ModelInfo:
    """Return a model's row, with built-in categories."""
    return add_builtin_categories(tables).info(model_id)


def add_part_fallbacks(nodes: Sequence[Node], reading: ReaderState) -> list[Node]:
    """Return a level's nodes with fallbacks for missing meshes of rooms and grounds, recorded in `reading`."""
    if not reading.missing_parts:
        return list(nodes)
    gaps = [gap for node in nodes if isinstance(node, ObjectNode) and (gap := _gap(node, reading)) is not None]
    found = {node.path: _with_parts(node, gaps, reading) for node in nodes if isinstance(node, RoomNode | GroundNode)}
    return [found.get(node.path, node) for node in nodes]


def _gap(item: ObjectNode, reading: ReaderState) -> OpeningSpan | None:
    """Return the span of a door, window or arch in the scene [m]; None for other objects.

    Its ends are those of the model's box along x, at z = 0 of the model.
    """
    info = _info(reading.tables, item.model_id)
    if info.coarse not in OPENING_CATEGORIES:
        return None
    mesh = reading.models[item.model_key]
    box = model_box(info, item.transform, item.bbox)
    box = np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)]) if box is None else box
    ends = np.array([[box[0, 0], box[0, 1], 0.0], [box[1, 0], box[1, 1], 0.0]])
    moved = ends @ item.transform[:3, :3].T + item.transform[:3, 3]
    low, high = np.sort(moved[:, 1]).tolist()
    return OpeningSpan(moved[0, [0, 2]], moved[1, [0, 2]], low, high)


def _with_parts(
    node: RoomNode | GroundNode, gaps: Sequence[OpeningSpan], reading: ReaderState
) -> RoomNode | GroundNode:
    """Return a node with fallbacks for its missing meshes; those of a room without known outline stay None."""
    kinds = [kind for kind in MESH_SUFFIX if (node.path, kind) in reading.missing_parts]
    if isinstance(node, GroundNode):
        return _with_ground(node, reading) if kinds else node
    shape = find_room_shape(node, gaps) if kinds else None
    for kind in kinds:
        path, reason = _missing(node, kind, reading)
        if shape is None:
            _give_up(node, path, reading)
            continue
        mesh = build_fallback_part(kind, shape, node, path, gaps, _materials(path, reading))
        node = replace(node, **{MESH_FIELD[kind]: mesh})
        taken = f"{kind.lower()} made from {shape.source}"
        reading.fallbacks.append(Fallback("room mesh", path.stem, node.path, taken, reason))
    return node


def _with_ground(node: GroundNode, reading: ReaderState) -> GroundNode:
    """Return a ground with a slab that fills its bounding box; unchanged, with a note, if that has no volume."""
    path, reason = _missing(node, "Ground", reading)
    size = np.zeros(3) if node.bbox is None else node.bbox[1] - node.bbox[0]
    if node.bbox is None or size.min() <= 0:
        _give_up(node, path, reading)
        return node
    (x0, y0, z0), (x1, y1, z1) = node.bbox.tolist()
    corners = np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
    mesh = slab_mesh(f"Ground#{node.id}", corners, (y0, y1), path, _materials(path, reading), GROUND_MATERIAL)
    reading.fallbacks.append(Fallback("room mesh", path.stem, node.path, "ground made from its bounding box", reason))
    return replace(node, mesh=mesh)


def _missing(node: RoomNode | GroundNode, kind: str, reading: ReaderState) -> tuple[Path, str]:
    """Return the path of a mesh in `missing_parts`, and the reason if it cannot be read; "" if it does not exist."""
    path = reading.assets.room_path(reading.house_id, node.model_id + MESH_SUFFIX[kind])
    return path, reading.missing_parts[node.path, kind]


def _give_up(node: RoomNode | GroundNode, path: Path, reading: ReaderState) -> None:
    """Note that a missing mesh has no fallback."""
    place = Location(reading.assets.root, f"{node.path}.modelId")
    reading.note(place, "missing-part", f"mesh {path.name} is missing, and its outline is unknown: not shown")


def _materials(path: Path, reading: ReaderState) -> Sequence[Material]:
    """Read the materials of a missing mesh from its MTL; empty if that is missing or broken."""
    library = path.with_suffix(".mtl")
    try:
        return read_mtl(library, reading.assets.textures) if is_file(library) else ()
    except DatasetError:
        return ()


def collect_fallbacks(house: House, reading: ReaderState) -> tuple[Fallback, ...]:
    """Return the fallbacks of a house, each once: materials, then models and room meshes, then metadata rows."""
    nodes = [node for level in house.levels for node in level.objects]
    without: dict[str, ObjectNode] = {}
    for node in nodes:
        if not has_category(reading.tables, node.model_id):
            without.setdefault(node.model_id, node)
    rows = [
        Fallback("metadata row", name, node.path, f"category `{_info(reading.tables, name).fine}`")
        for name, node in without.items()
    ]
    return (*list_missing_materials(house), *reading.fallbacks, *rows)
