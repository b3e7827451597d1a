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
from home_mjx.datasets.suncg.formats.element import Value
from home_mjx.datasets.suncg.formats.materials import read_materials
from home_mjx.datasets.suncg.read.parts import read_part
from home_mjx.datasets.suncg.read.reading import Reading
from home_mjx.datasets.suncg.read.stand_ins import stand_in_for_model
from home_mjx.errors import DatasetError
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.house import Box, Ground, Material, Mesh, Node, Object, Room

TEXT_INDEX = re.compile("[0-9]{1,9}")


def read_object(node: Value, common: dict[str, Any], reading: Reading) -> Object | None:
    """Read an object and store its model in `reading.models`; None if it has no volume or the options exclude it."""
    model_id = node.member("modelId").name()
    if reading.left_out(model_id):
        return None
    transform = _transform(node, reading)
    if transform is None:
        return None
    item = Object(
        **common,
        model_id=model_id,
        state=_state(node.member("state"), model_id, reading),
        transform=transform,
        materials=_materials(node, reading),
    )
    if reading.tolerant:
        return read_or_stand_in(item, node, reading)
    mesh = reading.attempt(reading.model, model_id, item.model_key, node.member("modelId"))
    if mesh is None:
        return None
    _keep(item, mesh, node, reading)
    return item


def read_or_stand_in(item: Object, node: Value, reading: Reading) -> Object:
    """Store the object's model or its fallback in `reading.models` and return the object."""
    if item.model_key not in reading.stood_in:
        try:
            _keep(item, reading.model(item.model_id, item.model_key, node.member("modelId")), node, reading)
        except DatasetError as error:
            stand_in_for_model(item, error, reading)
    return item


def _keep(item: Object, mesh: Mesh, node: Value, reading: Reading) -> None:
    reading.models[item.model_key] = mesh
    _read_other(item, node, reading)
    if len(item.materials) > len(mesh.materials):
        extra = f"{len(item.materials)} materials for {len(mesh.materials)} slots: the others are ignored"
        reading.note(node.member("materials"), "extra-materials", extra)


def _read_other(item: Object, node: Value, reading: Reading) -> None:
    """Read the object's other state, if it exists; it is not visible, so a broken one is only noted."""
    key = item.other_key
    if key not in reading.others and is_file(reading.assets.model_path(item.model_id, key)):
        try:
            reading.others[key] = reading.model(item.model_id, key, node)
        except DatasetError as error:
            reading.note(node.member("modelId"), "broken-variant", f"other state is not used: {error}")


def read_box(node: Value, common: dict[str, Any], reading: Reading) -> Box | None:
    """Read a box; None if it has no volume."""
    transform = _transform(node, reading)
    dimensions = node.member("dimensions").vector(3)
    if transform is not None and dimensions.min() <= 0:
        reading.note(node.member("dimensions"), "flat-box", "box without volume: left out")
        transform = None
    if transform is None:
        return None
    return Box(**common, dimensions=dimensions, transform=transform, materials=_materials(node, reading))


def read_room(node: Value, common: dict[str, Any], reading: Reading) -> Room:
    """Read a room with its meshes; `members` are unchecked indices from the file."""
    members = node.member("nodeIndices")
    return Room(
        **common,
        model_id=node.member("modelId").name(),
        types=_room_types(node.member("roomTypes"), reading),
        members=_members(members, reading) if members.present else (),
        floor=reading.attempt(read_part, node, "Floor", common["id"], reading),
        ceiling=reading.attempt(read_part, node, "Ceiling", common["id"], reading),
        walls=reading.attempt(read_part, node, "Wall", common["id"], reading),
    )


def _members(values: Value, reading: Reading) -> tuple[int, ...]:
    """Read indices of nodes; exports of deep-synth and PlanIT write them as strings."""
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


def read_ground(node: Value, common: dict[str, Any], reading: Reading) -> Ground:
    """Read a slab of outdoor ground."""
    mesh = reading.attempt(read_part, node, "Ground", common["id"], reading)
    return Ground(**common, model_id=node.member("modelId").name(), mesh=mesh)


READERS: dict[str, Callable[[Value, dict[str, Any], Reading], Node | None]] = {
    "object": read_object,
    "box": read_box,
    "room": read_room,
    "ground": read_ground,
}


def read_bbox(node: Value, reading: Reading) -> Float[np.ndarray, "2 3"] | None:
    """Read the bounding box [m]; None, with a problem, if it is missing or its minimum exceeds its maximum."""
    bbox = node.member("bbox")
    if not bbox.present:
        reading.note(bbox, "missing-bbox", "no bounding box")
        return None
    corners = np.stack([bbox.member("min").vector(3), bbox.member("max").vector(3)])
    if (corners[0] > corners[1]).any():
        reading.note(bbox, "inverted-bbox", "bounding box is inside out: ignored")
        return None
    return corners * reading.scale


def _transform(node: Value, reading: Reading) -> Float[np.ndarray, "4 4"] | None:
    """Read the transform scene from model [m]; None, with a problem, if it is singular."""
    value = node.member("transform")
    if not value.present:
        reading.note(value, "missing-transform", "no transform: identity is used")
    matrix = value.vector(16).reshape(4, 4).T if value.present else np.eye(4)
    if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
        hint = "Transforms are column-major: the translation is in numbers 12 to 14."
        raise value.error(f"expected an affine transform, its last row is {matrix[3].tolist()}", hint)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    determinant = float(np.linalg.det(matrix[:3, :3]))
    if abs(determinant) <= 1e-9 * lengths.prod():
        reading.note(value, "flat-transform", "transform has no volume: node left out")
        return None
    mirrored = node.member("isMirrored")
    if mirrored.present and mirrored.flag() != (determinant < 0):
        reading.note(mirrored, "mirror-flag", "isMirrored contradicts the transform, which is used")
    return np.diag([reading.scale] * 3 + [1.0]) @ matrix


def _state(value: Value, model_id: str, reading: Reading) -> int | None:
    if not value.present:
        return None
    state = value.integer()
    if state < 0:
        raise value.error(f"expected a state of at least 0, got {state}")
    path = reading.assets.model_path(model_id, f"{model_id}_{state - 1}")
    if state and not is_file(path) and not (reading.tolerant and not is_file(path.with_name(f"{model_id}.obj"))):
        message = f"model has no variant `{model_id}_{state - 1}`: its base is used"
        reading.note(value, "missing-variant", message)
        return 0
    return state


def _materials(node: Value, reading: Reading) -> tuple[Material, ...]:
    return reading.attempt(read_materials, node, reading.materials, reading.assets.textures) or ()


def _room_types(values: Value, reading: Reading) -> tuple[str, ...]:
    types = tuple(value.text() for value in values.entries()) if values.present else ()
    for name in types:
        if name not in ROOM_TYPES:
            reading.note(values, "room-type", f"unknown room type `{name}`")
    return types
