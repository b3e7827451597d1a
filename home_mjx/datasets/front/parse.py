"""Houses of 3D-FRONT as records: meshes of the building, furniture, and rooms with their instances."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.files import read_text
from home_mjx.datasets.gltf.decode.node_matrix import read_rotation
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue, Location
from home_mjx.schema.house import Material

MAX_JSON_BYTES = 1 << 28  # [bytes], maximum size of a house; the largest have about 40 MB
MAX_NUMBERS = 9_000_000  # maximum length of a list of coordinates
Matrix = Float[np.ndarray, "4 4"]


@dataclass(frozen=True)
class FrontMesh:
    """A mesh of the building.

    Attributes:
        kind: Its type, such as `WallInner`.
        triangles: Corners in its frame [m].
        uv: Texture coordinates of the corners.
        material: Its material.
    """

    kind: str
    triangles: Float[np.ndarray, "t 3 3"]
    uv: Float[np.ndarray, "t 3 2"]
    material: Material


@dataclass(frozen=True)
class FrontPiece:
    """A piece of furniture.

    Attributes:
        model: Name of its model in 3D-FUTURE.
        words: Its category and title.
        box: Minimum and maximum corner of the model [m]; None if the file does not say.
    """

    model: str
    words: tuple[str, ...]
    box: Float[np.ndarray, "2 3"] | None


@dataclass(frozen=True)
class FrontInstance:
    """A mesh or a piece in a room.

    Attributes:
        element: Its element path.
        ref: `uid` of the mesh or the piece.
        matrix: House from mesh or model.
        scale: Factors along the model's axes.
    """

    element: str
    ref: str
    matrix: Matrix
    scale: Float[np.ndarray, "3"]


@dataclass(frozen=True)
class FrontRoom:
    """A room with its instances."""

    element: str
    type: str
    children: tuple[FrontInstance, ...]


@dataclass(frozen=True)
class FrontHouse:
    """A house.

    Attributes:
        meshes: Meshes by `uid`.
        pieces: Furniture that is marked as valid, by `uid`.
        rooms: Rooms.
        num_invalid: Number of pieces that are not.
    """

    meshes: Mapping[str, FrontMesh]
    pieces: Mapping[str, FrontPiece]
    rooms: tuple[FrontRoom, ...]
    num_invalid: int


def read_front(path: Path) -> FrontHouse:
    """Read the JSON of a house.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: It is not such a file, or a value is missing, of another type or not finite.
    """
    try:
        document = JsonValue(path, "", json.loads(read_text(path, max_bytes=MAX_JSON_BYTES)))
    except (json.JSONDecodeError, RecursionError) as error:
        raise Location(path).error(f"not valid JSON: {error!s:.100}", "Fetch it again.") from None
    materials = {value.member("uid").text(): _material(value) for value in _list(document, "material")}
    meshes = {value.member("uid").text(): _mesh(value, materials) for value in _list(document, "mesh")}
    furniture = _list(document, "furniture")
    valid = [value for value in furniture if value.member("valid").data is True]
    pieces = {value.member("uid").text(): _piece(value) for value in valid}
    rooms = tuple(_room(value) for value in document.member("scene").member("room").entries())
    return FrontHouse(meshes, pieces, rooms, len(furniture) - len(valid))


def _list(document: JsonValue, key: str) -> list[JsonValue]:
    """Return the entries of a list; [] if it is absent."""
    value = document.member(key)
    return value.entries() if value.has_value else []


def _material(value: JsonValue) -> Material:
    """Return a material of its colour (0..255); images of 3D-FRONT are named by addresses, which are not read."""
    color = value.member("color")
    channels = np.clip([part.number() for part in color.entries()[:3]], 0, 255) / 255 if color.has_value else []
    red, green, blue = channels if len(channels) == 3 else (0.8, 0.8, 0.8)
    return Material(value.member("uid").text()[:80], (float(red), float(green), float(blue)), None, 1.0)


def _mesh(value: JsonValue, materials: Mapping[str, Material]) -> FrontMesh:
    """Return a mesh of the building."""
    points = _numbers(value.member("xyz"), 3)
    faces = _numbers(value.member("faces"), 3)
    index = faces.astype(np.int64)
    if (index != faces).any() or index.min(initial=0) < 0 or index.max(initial=-1) >= len(points):
        raise value.member("faces").error(f"expected indices of the {len(points)} corners")
    uv = _numbers(value.member("uv"), 2) if value.member("uv").has_value else np.zeros((0, 2))
    uv = uv if len(uv) == len(points) else np.zeros((len(points), 2))
    named = value.member("material")
    material = materials.get(named.text()) if named.has_value else None
    kind = value.member("type")
    name = kind.text()[:60] if kind.has_value else ""
    return FrontMesh(name, points[index], uv[index], material or Material("plaster", (0.8, 0.8, 0.8), None, 1.0))


def _numbers(value: JsonValue, width: int) -> Float[np.ndarray, "n w"]:
    """Return a flat list of numbers as rows; `DatasetError` for other values."""
    data = value.data
    if not isinstance(data, list) or len(data) % width or len(data) > MAX_NUMBERS:
        raise value.error(f"expected a list of {width} numbers for each entry, at most {MAX_NUMBERS} in all")
    if not all(type(number) in (int, float) and abs(number) <= MAX_COORDINATE for number in data):
        raise value.error("expected finite numbers")
    return np.array(data, float).reshape(-1, width)


def _piece(value: JsonValue) -> FrontPiece:
    """Return a piece of furniture."""
    words = (value.member(key) for key in ("category", "title"))
    named = tuple(word.text()[:100] for word in words if word.has_value)
    return FrontPiece(value.member("jid").name(), named, _box(value))


def _box(value: JsonValue) -> Float[np.ndarray, "2 3"] | None:
    """Return the box of a model: its `bbox`, else its `size` on the floor around its origin; None without both."""
    box, size = value.member("bbox"), value.member("size")
    if isinstance(box.data, dict):
        low, high = box.member("min").vector(3), box.member("max").vector(3)
        return np.stack([np.minimum(low, high), np.maximum(low, high)])
    if not size.has_value:
        return None
    x, y, z = np.abs(size.vector(3)).tolist()
    return np.array([[-x / 2, 0, -z / 2], [x / 2, y, z / 2]])


def _room(value: JsonValue) -> FrontRoom:
    """Return a room."""
    kind, children = value.member("type"), value.member("children")
    found = tuple(_instances(children)) if children.has_value else ()
    return FrontRoom(value.element, kind.text()[:60] if kind.has_value else "", found)


def _instances(children: JsonValue) -> Iterator[FrontInstance]:
    """Yield the instances of a room: scaled, turned (x y z w), then moved."""
    for value in children.entries():
        place, turn, scale = (value.member(key) for key in ("pos", "rot", "scale"))
        matrix = np.eye(4)
        if turn.has_value:
            matrix[:3, :3] = read_rotation(turn)
        if place.has_value:
            matrix[:3, 3] = place.vector(3)
        factors = scale.vector(3) if scale.has_value else np.ones(3)
        yield FrontInstance(value.element, value.member("ref").text(), matrix, factors)


def faces_up(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "t 3 3"]:
    """Return triangles wound so that all face up."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    order: Int[np.ndarray, "t 3"] = np.where(normal[:, 1:2] < 0, [[0, 2, 1]], [[0, 1, 2]])
    return triangles[np.arange(len(triangles))[:, None], order]
