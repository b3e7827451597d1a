"""Matterport3D's `.house` files and labelled PLY meshes, Z up, in metres."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.files import read_bytes, read_text
from home_mjx.datasets.gltf.decode.scene import Matrix
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.room_search import is_outline
from home_mjx.datasets.habitat.semantics import MAX_HEIGHT, MIN_HEIGHT, fine_of_word, stack_rooms
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location, printable
from home_mjx.datasets.taxonomy import UNKNOWN
from home_mjx.schema.house import Problem

MAX_TEXT_BYTES, MAX_PLY_BYTES = 1 << 26, 1 << 29  # [bytes]
MAX_FACES = 20_000_000  # maximum number of faces of a PLY mesh
LETTERS = {  # Matterport's letters of regions and our types of rooms
    **{"a": "Bathroom", "b": "Bedroom", "c": "Wardrobe", "d": "Dining_Room", "e": "Entryway", "f": "Living_Room"},
    **{"g": "Garage", "h": "Hallway", "i": "Office", "j": "Storage", "k": "Kitchen", "l": "Living_Room"},
    **{"m": "Room", "n": "Living_Room", "o": "Office", "p": "Terrace", "r": "Room", "s": "Hallway", "t": "Toilet"},
    **{"u": "Storage", "v": "Living_Room", "w": "Gym", "y": "Balcony", "z": "Room"},
    **{"B": "Room", "C": "Room", "D": "Room", "S": "Room"},
}
PLY_TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2"},
    **{"uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4"},
    **{"double": "f8", "float64": "f8"},
}
LABELS = ("object_id", "face_segment")  # properties of faces with their object, in Habitat's files and Matterport's


@dataclass(frozen=True)
class HouseFile:
    """Content of a `.house` file.

    Attributes:
        words: Category of each object by its index.
        rooms: Regions with their floor polygons, in the house.
        problems: Regions that are not used.
    """

    words: Mapping[int, str] = field(default_factory=dict)
    rooms: tuple[StatedRoom, ...] = ()
    problems: tuple[Problem, ...] = ()


def read_house_file(path: Path, matrix: Matrix) -> HouseFile:
    """Read a `.house` file; its counts are not checked, since released files have fewer entries.

    Args:
        path: The file.
        matrix: House from the scan, whose frame the file shares.

    Raises:
        DatasetError: A line has too few fields, or a number is not finite; the message names the line.
    """
    regions: dict[int, tuple[str, float, float]] = {}
    owner: dict[int, int] = {}
    outlines: dict[int, list[Float[np.ndarray, "3"]]] = {}
    categories: dict[int, str] = {}
    objects: dict[int, int] = {}
    for number, line in enumerate(read_text(path, max_bytes=MAX_TEXT_BYTES).splitlines(), 1):
        row = _Row(Location(path, f"line {number}"), line.split())
        kind = row.fields[0] if row.fields else ""
        if kind == "R":  # R region level 0 0 label  p  box  height
            regions[row.integer(1)] = row.text(5), row.number(11), row.number(15)
        elif kind == "S":  # S surface region 0 label  p  normal  box
            owner[row.integer(1)] = row.integer(2)
        elif kind == "V":  # V vertex surface label  p  normal
            point = np.array([row.number(i) for i in (4, 5, 6)])
            outlines.setdefault(owner.get(row.integer(2), -1), []).append(point)
        elif kind == "C":  # C category mapping_index name mpcat40_index mpcat40_name
            words = [row.text(i).replace("#", " ") for i in (3, 5)]
            categories[row.integer(1)] = words[fine_of_word(words[0]) == UNKNOWN]
        elif kind == "O":  # O object region category  p  axes  half lengths
            objects[row.integer(1)] = row.integer(3)
    named = {index: categories.get(category, "") for index, category in objects.items()}
    rooms, problems = _rooms(regions, outlines, matrix)
    return HouseFile(named, stack_rooms(rooms), tuple(problems))


@dataclass(frozen=True)
class _Row:
    """Fields of a line."""

    place: Location
    fields: Sequence[str]

    def text(self, index: int) -> str:
        """Return a field; `DatasetError` if there are too few."""
        if index >= len(self.fields):
            raise self.place.error(f"expected at least {index + 1} fields, got {len(self.fields)}")
        return self.fields[index][:100]

    def number(self, index: int) -> float:
        """Return a field as a finite number."""
        try:
            value = float(self.text(index))
        except ValueError:
            value = float("nan")
        if not abs(value) <= MAX_COORDINATE:
            raise self.place.error(f"expected a finite number, got `{printable(self.text(index))}`")
        return value

    def integer(self, index: int) -> int:
        """Return a field as an integer."""
        return int(self.number(index))


def _rooms(
    regions: Mapping[int, tuple[str, float, float]],
    outlines: Mapping[int, Sequence[Float[np.ndarray, "3"]]],
    matrix: Matrix,
) -> tuple[list[StatedRoom], list[Problem]]:
    """Return the regions with an outline as rooms in the house, and notes about the others."""
    found, problems = [], []
    for index, (label, low, height) in regions.items():
        points = np.array(outlines.get(index, [])).reshape(-1, 3)
        base = np.column_stack([points[:, :2], np.full(len(points), low)])
        corners = base @ matrix[:3, :3].T + matrix[:3, 3]
        if not is_outline(corners[:, [0, 2]]):
            problems.append(Problem(f"R {index}", "outline of the region has no area or crosses itself: not used"))
            continue
        floor = float(corners[:, 1].mean())
        ceiling = floor + float(np.clip(height, MIN_HEIGHT, MAX_HEIGHT))
        found.append(StatedRoom(corners[:, [0, 2]], LETTERS.get(label[:1], ""), 0, floor, ceiling))
    return found, problems


def read_labelled_ply(path: Path, matrix: Matrix) -> tuple[Float[np.ndarray, "f 3"], Int[np.ndarray, " f"]]:
    """Return the centroids in the house and the object of each triangle of a binary PLY mesh.

    Args:
        path: The file, little-endian, of triangles with a property of `LABELS`.
        matrix: House from the scan.

    Raises:
        DatasetError: The file is broken, of another form, or has no labels.
    """
    data = read_bytes(path, max_bytes=MAX_PLY_BYTES)
    place = Location(path)
    end = data[: 1 << 16].find(b"end_header\n")
    if not data.startswith(b"ply") or end < 0:
        raise place.error("file has no header of PLY")
    header = data[:end].decode("ascii", "replace")
    if "format binary_little_endian" not in header:
        raise place.error("expected a PLY in the format binary_little_endian")
    position = end + len(b"end_header\n")
    found: dict[str, np.ndarray] = {}
    for name, text, body in re.findall(r"element (\w+) (\d{1,9})\s*\n((?:property [^\n]*\n)*)", header + "\n"):
        kind, count = _row_type(place, name, body), int(text)
        if count > MAX_FACES or position + count * kind.itemsize > len(data):
            raise place.error(f"file ends before its {count} rows of `{name}`")
        found[name] = np.frombuffer(data, kind, count, position)
        position += count * kind.itemsize
    return _labelled(place, found, matrix)


def _row_type(place: Location, name: str, body: str) -> np.dtype:
    """Return the type of the rows of an element; lists are triangles."""
    fields: list[tuple[str, str] | tuple[str, str, int]] = []
    for line in body.splitlines():
        words = line.split()[1:]
        known = all(word in PLY_TYPES for word in (words[1:3] if words[:1] == ["list"] else words[:1]))
        if len(words) != (4 if words[:1] == ["list"] else 2) or not known:
            raise place.error(f"unknown property of `{name}`: `{printable(line[:60])}`")
        if words[0] == "list":
            fields += [(f"{words[3]}_count", f"<{PLY_TYPES[words[1]]}"), (words[3], f"<{PLY_TYPES[words[2]]}", 3)]
        else:
            fields.append((words[1], f"<{PLY_TYPES[words[0]]}"))
    try:
        return np.dtype(fields)
    except (ValueError, TypeError) as error:
        raise place.error(f"properties of `{name}` are not valid: {error}") from None


def _labelled(
    place: Location, found: Mapping[str, np.ndarray], matrix: Matrix
) -> tuple[Float[np.ndarray, "f 3"], Int[np.ndarray, " f"]]:
    """Return the centroids and labels of the triangles of a PLY mesh."""
    faces, points = found.get("face"), found.get("vertex")
    if faces is None or points is None or not {"x", "y", "z"} <= set(points.dtype.names or ()):
        raise place.error("mesh has no vertices or no faces")
    names = faces.dtype.names or ()
    corner = next((name for name in ("vertex_indices", "vertex_index") if name in names), None)
    label = next((name for name in LABELS if name in names), None)
    if corner is None or label is None:
        raise place.error(f"faces lack corners or labels ({', '.join(LABELS)})")
    index = faces[corner].astype(np.int64)
    if not (faces[f"{corner}_count"] == 3).all() or index.min(initial=0) < 0 or index.max(initial=-1) >= len(points):
        raise place.error("faces are not triangles of the mesh's vertices")
    vertices = np.stack([points[axis].astype(float) for axis in "xyz"], axis=1)
    if not (abs(vertices) <= MAX_COORDINATE).all():
        raise place.error("coordinates are not finite")
    middle = vertices[index].mean(axis=1)
    return middle @ matrix[:3, :3].T + matrix[:3, 3], faces[label].astype(int)
