"""Reader of the nodes of house.json: objects, boxes, rooms and grounds.

Known defects of real houses are tolerated and recorded as a `Problem`; a meaningless node is an error.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import is_file
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.formats.materials import read_materials
from home_mjx.datasets.suncg.formats.variants import other_variant, variant_key
from home_mjx.datasets.suncg.read.missing_parts import add_model_fallback
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.read.room_meshes import read_part
from home_mjx.errors import DatasetError
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.house import BoxNode, GroundNode, Material, Mesh, Node, ObjectNode, RoomNode

TEXT_INDEX = re.compile("[0-9]{1,9}")


def read_object(node: JsonValue, common: dict[str, Any], reading: ReaderState) -> ObjectNode | None:
    """Read an object and store its model, or the fallback of a tolerant reader, in `reading.models`.

    Return None if it has no volume, the options exclude it, or an error of its model is collected.
    `common` has the fields of `Node`.
    """
    model_id = node.member("modelId").name()
    if reading.is_excluded(model_id):
        return None
    transform = _transform(node, reading)
    if transform is None:
        return None
    item = ObjectNode(
        **common,
        model_id=model_id,
        model_key=variant_key(model_id, _state(node.member("state"), model_id, reading)),
        transform=transform,
        materials=_materials(node, reading),
    )
    if reading.tolerant:
        return read_or_fallback(item, node, reading)
    mesh = reading.attempt(reading.model, model_id, item.model_key, node.member("modelId"))
    if mesh is None:
        return None
    _keep(item, mesh, node, reading)
    return item


def read_or_fallback(item: ObjectNode, node: JsonValue, reading: ReaderState) -> ObjectNode:
    """Store the object's model, or a fallback if that cannot be read, in `reading.models`; return the object."""
    if item.model_key not in reading.fallback_keys:
        try:
            _keep(item, reading.model(item.model_id, item.model_key, node.member("modelId")), node, reading)
        except DatasetError as error:
            add_model_fallback(item, error, reading)
    return item


def _keep(item: ObjectNode, mesh: Mesh, node: JsonValue, reading: ReaderState) -> None:
    """Store an object's mesh, and that of its other state; note materials beyond the mesh's slots."""
    reading.models[item.model_key] = mesh
    _read_other(item, node, reading)
    if len(item.materials) > len(mesh.materials):
        extra = f"{len(item.materials)} materials for {len(mesh.materials)} slots: the others are ignored"
        reading.note(node.member("materials"), "extra-materials", extra)


def _read_other(item: ObjectNode, node: JsonValue, reading: ReaderState) -> None:
    """Store the mesh of the object's other state in `reading.other_models`, if it exists; a broken one is noted."""
    key = other_variant(item.model_id, item.model_key)
    if key not in reading.other_models and is_file(reading.assets.model_path(item.model_id, key)):
        try:
            reading.other_models[key] = reading.model(item.model_id, key, node)
        except DatasetError as error:
            reading.note(node.member("modelId"), "broken-variant", f"other state is not used: {error}")


def read_box(node: JsonValue, common: dict[str, Any], reading: ReaderState) -> BoxNode | None:
    """Read a box, with the fields `common` of `Node`; None, with a note, if it has no volume."""
    transform = _transform(node, reading)
    dimensions = node.member("dimensions").vector(3)
    if transform is not None and dimensions.min() <= 0:
        reading.note(node.member("dimensions"), "flat-box", "box without volume: left out")
        transform = None
    if transform is None:
        return None
    return BoxNode(**common, dimensions=dimensions, transform=transform, materials=_materials(node, reading))


def read_room(node: JsonValue, common: dict[str, Any], reading: ReaderState) -> RoomNode:
    """Read a room; each mesh is None if hidden or missing, and `members` are unchecked indices from the file."""
    members = node.member("nodeIndices")
    return RoomNode(
        **common,
        model_id=node.member("modelId").name(),
        types=_room_types(node.member("roomTypes"), reading),
        members=_members(members, reading) if members.has_value else (),
        floor=reading.attempt(read_part, node, "Floor", common["id"], reading),
        ceiling=reading.attempt(read_part, node, "Ceiling", common["id"], reading),
        walls=reading.attempt(read_part, node, "Wall", common["id"], reading),
    )


def _members(values: JsonValue, reading: ReaderState) -> tuple[int, ...]:
    """Read indices of nodes, also from strings, as exports of deep-synth and PlanIT write them; note those.

    Other values than integers raise `DatasetError`; the range is not checked.
    """
    entries = values.entries()
    if any(isinstance(entry.data, str) and TEXT_INDEX.fullmatch(entry.data) for entry in entries):
        reading.note(values, "text-member", "indices are written as strings: read as numbers")
        entries = [
            replace(entry, data=int(entry.data))
            if isinstance(entry.data, str) and TEXT_INDEX.fullmatch(entry.data)
            else entry
            for entry in entries
        ]
    return tuple(entry.integer() for entry in entries)


def read_ground(node: JsonValue, common: dict[str, Any], reading: ReaderState) -> GroundNode:
    """Read a slab of outdoor ground; its mesh is None if hidden or missing."""
    mesh = reading.attempt(read_part, node, "Ground", common["id"], reading)
    return GroundNode(**common, model_id=node.member("modelId").name(), mesh=mesh)


READERS: dict[str, Callable[[JsonValue, dict[str, Any], ReaderState], Node | None]] = {
    "object": read_object,
    "box": read_box,
    "room": read_room,
    "ground": read_ground,
}


def read_bbox(node: JsonValue, reading: ReaderState) -> Float[np.ndarray, "2 3"] | None:
    """Read the bounding box [m]; None, with a problem, if it is missing or its minimum exceeds its maximum."""
    bbox = node.member("bbox")
    if not bbox.has_value:
        reading.note(bbox, "missing-bbox", "no bounding box")
        return None
    corners = np.stack([bbox.member("min").vector(3), bbox.member("max").vector(3)])
    if (corners[0] > corners[1]).any():
        reading.note(bbox, "inverted-bbox", "bounding box is inside out: ignored")
        return None
    return corners * reading.scale


def _transform(node: JsonValue, reading: ReaderState) -> Float[np.ndarray, "4 4"] | None:
    """Read the transform scene from model [m].

    A missing transform is read as identity, and a singular one as None; both are reported as problems.

    Raises:
        DatasetError: The value is not an affine 4x4 matrix.
    """
    value = node.member("transform")
    if not value.has_value:
        reading.note(value, "missing-transform", "no transform: identity is used")
    matrix = value.vector(16).reshape(4, 4).T if value.has_value else np.eye(4)
    if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
        hint = "Transforms are column-major: the translation is in numbers 12 to 14."
        raise value.error(f"expected an affine transform, its last row is {matrix[3].tolist()}", hint)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    determinant = float(np.linalg.det(matrix[:3, :3]))
    if abs(determinant) <= 1e-9 * lengths.prod():
        reading.note(value, "flat-transform", "transform has no volume: node left out")
        return None
    mirrored = node.member("isMirrored")
    if mirrored.has_value and mirrored.flag() != (determinant < 0):
        reading.note(mirrored, "mirror-flag", "isMirrored contradicts the transform, which is used")
    return np.diag([reading.scale] * 3 + [1.0]) @ matrix


def _state(value: JsonValue, model_id: str, reading: ReaderState) -> int | None:
    """Read the state of an object; None if null, and 0, with a note, if the model lacks its variant.

    A tolerant reader keeps the state if the base model is missing as well. A negative state is a `DatasetError`.
    """
    if not value.has_value:
        return None
    state = value.integer()
    if state < 0:
        raise value.error(f"expected a state of at least 0, got {state}")
    key = variant_key(model_id, state)
    path = reading.assets.model_path(model_id, key)
    if state and not is_file(path) and not (reading.tolerant and not is_file(path.with_name(f"{model_id}.obj"))):
        message = f"model has no variant `{key}`: its base is used"
        reading.note(value, "missing-variant", message)
        return 0
    return state


def _materials(node: JsonValue, reading: ReaderState) -> tuple[Material, ...]:
    """Read the material overrides of a node; () if their error is collected."""
    return reading.attempt(read_materials, node, reading.materials, reading.assets.textures) or ()


def _room_types(values: JsonValue, reading: ReaderState) -> tuple[str, ...]:
    """Read the types of a room, including unknown ones, which are noted; () if null."""
    types = tuple(value.text() for value in values.entries()) if values.has_value else ()
    for name in types:
        if name not in ROOM_TYPES:
            reading.note(values, "room-type", f"unknown room type `{name}`")
    return types
