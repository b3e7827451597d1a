"""Reads the nodes of house.json: objects, boxes, rooms and grounds.

What real houses are known to lack is tolerated and noted as a `Problem`; what makes a node meaningless is an error.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.scene_compile.house import Box, Ground, Material, Mesh, Node, Object, Problem, Room

from .assets import Assets
from .categories import ROOM_TYPES
from .place import Place, Value


@dataclass
class Reading:
    """What reading one house needs, and what it gathers."""

    house_id: str
    assets: Assets
    materials: Value  # the house's own list, for nodes that have `materialIndices`
    scale: float = 1.0  # [m] per unit of the file
    models: dict[str, Mesh] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def note(self, place: Place, message: str) -> None:
        """Keeps an oddity that was tolerated."""
        self.problems.append(Problem(place.element, message))


def read_object(node: Value, common: dict[str, Any], reading: Reading) -> Object | None:
    """An object, with its model put into `reading.models`; None if it has no volume."""
    transform = _transform(node, reading)
    if transform is None:
        return None
    model_id = node.member("modelId").name()
    item = Object(
        **common,
        model_id=model_id,
        state=_state(node.member("state"), model_id, reading),
        transform=transform,
        materials=_materials(node, reading),
    )
    mesh = reading.assets.model(model_id, item.model_key, node.member("modelId"))
    reading.models[item.model_key] = mesh
    if len(item.materials) > len(mesh.materials):
        extra = f"{len(item.materials)} materials for {len(mesh.materials)} slots: the rest is ignored"
        reading.note(node.member("materials"), extra)
    return item


def read_box(node: Value, common: dict[str, Any], reading: Reading) -> Box | None:
    """A box; None if it has no volume."""
    transform = _transform(node, reading)
    dimensions = node.member("dimensions").vector(3)
    if transform is not None and dimensions.min() <= 0:
        reading.note(node.member("dimensions"), "box without volume: left out")
        transform = None
    if transform is None:
        return None
    return Box(**common, dimensions=dimensions, transform=transform, materials=_materials(node, reading))


def read_room(node: Value, common: dict[str, Any], reading: Reading) -> Room:
    """A room with its meshes; `members` are as in the file, to be checked against the level."""
    stem = node.member("modelId").name()
    members = node.member("nodeIndices")
    return Room(
        **common,
        model_id=stem,
        types=_room_types(node.member("roomTypes"), reading),
        members=tuple(item.integer() for item in members.entries()) if members.present else (),
        floor=_part(node, "hideFloor", f"{stem}f", reading),
        ceiling=_part(node, "hideCeiling", f"{stem}c", reading),
        walls=_part(node, "hideWalls", f"{stem}w", reading),
    )


def read_ground(node: Value, common: dict[str, Any], reading: Reading) -> Ground:
    """A slab of outdoor ground."""
    stem = node.member("modelId").name()
    return Ground(**common, model_id=stem, mesh=_part(node, "hideFloor", f"{stem}f", reading))


READERS: dict[str, Callable[[Value, dict[str, Any], Reading], Node | None]] = {
    "object": read_object,
    "box": read_box,
    "room": read_room,
    "ground": read_ground,
}


def read_bbox(node: Value, reading: Reading) -> Float[np.ndarray, "2 3"] | None:
    """The box that the file states, in metres; None, and a problem, if there is none or it is inside out."""
    bbox = node.member("bbox")
    if not bbox.present:
        reading.note(bbox, "no bounding box")
        return None
    corners = np.stack([bbox.member("min").vector(3), bbox.member("max").vector(3)])
    if (corners[0] > corners[1]).any():
        reading.note(bbox, "bounding box is inside out: ignored")
        return None
    return corners * reading.scale


def _transform(node: Value, reading: Reading) -> Float[np.ndarray, "4 4"] | None:
    """Scene from model, in metres; None, and a problem, if it flattens everything."""
    value = node.member("transform")
    if not value.present:
        reading.note(value, "no transform: identity taken")
    matrix = value.vector(16).reshape(4, 4).T if value.present else np.eye(4)
    if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
        hint = "Transforms are column-major: the translation is in numbers 12 to 14."
        raise value.error(f"expected an affine transform, its last row is {matrix[3].tolist()}", hint)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    determinant = float(np.linalg.det(matrix[:3, :3]))
    if abs(determinant) <= 1e-9 * lengths.prod():
        reading.note(value, "transform has no volume: node left out")
        return None
    mirrored = node.member("isMirrored")
    if mirrored.present and mirrored.flag() != (determinant < 0):
        reading.note(mirrored, "isMirrored contradicts the transform, which is taken")
    return np.diag([reading.scale] * 3 + [1.0]) @ matrix


def _state(value: Value, model_id: str, reading: Reading) -> int | None:
    if not value.present:
        return None
    state = value.integer()
    if state < 0:
        raise value.error(f"expected a state of 0 or more, got {state}")
    if state and not reading.assets.model_path(model_id, f"{model_id}_{state - 1}").is_file():
        reading.note(value, f"model has no variant `{model_id}_{state - 1}`: its base is shown")
        return 0
    return state


def _materials(node: Value, reading: Reading) -> tuple[Material, ...]:
    values = node.member("materials")
    if values.present:
        return tuple(_material(value, reading) for value in values.entries())
    indices = node.member("materialIndices")
    if not indices.present:
        return ()
    table = reading.materials.entries() if reading.materials.present else []
    return tuple(_material(table[_position(value, len(table))], reading) for value in indices.entries())


def _position(value: Value, count: int) -> int:
    index = value.integer()
    if not 0 <= index < count:
        raise value.error(f"expected an index into the house's {count} materials, got {index}")
    return index


def _material(value: Value, reading: Reading) -> Material:
    if not value.present:
        return Material("")
    name, texture, diffuse = (value.member(key) for key in ("name", "texture", "diffuse"))
    return Material(
        name=name.text() if name.present else "",
        diffuse=diffuse.color() if diffuse.data else None,
        texture=reading.assets.textures.named(texture.text(), texture) if texture.data else None,
    )


def _room_types(values: Value, reading: Reading) -> tuple[str, ...]:
    types = tuple(value.text() for value in values.entries()) if values.present else ()
    for name in types:
        if name not in ROOM_TYPES:
            reading.note(values, f"unknown room type `{name}`")
    return types


def _part(node: Value, hide: str, stem: str, reading: Reading) -> Mesh | None:
    """A mesh of a room or ground, in metres; None where it is hidden or, with a problem, missing."""
    if node.member(hide).flag():
        return None
    path = reading.assets.room_path(reading.house_id, stem)
    if not path.parent.is_dir():
        hint = "SUNCG v2 comes without room meshes: fetch them with `download_suncg.py -v v1 -t room`."
        raise node.error(f"house has no folder of room meshes {path.parent}", hint)
    if not path.is_file():
        reading.note(node.member("modelId"), f"mesh {path.name} is missing: not shown")
        return None
    mesh = reading.assets.mesh(path)
    return mesh if reading.scale == 1 else replace(mesh, vertices=mesh.vertices * reading.scale)
