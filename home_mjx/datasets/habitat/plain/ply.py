"""PLY files as triangles: ASCII and binary of both byte orders, polygons, triangle strips and colours."""

import re
import struct
from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.color import decode_srgb
from home_mjx.datasets.gltf.decode.primitives import STRIP, split_triangles
from home_mjx.datasets.habitat.plain.stl import parse_numbers
from home_mjx.datasets.shapes import Triangles
from home_mjx.datasets.suncg.formats.json_value import Location, printable

EXPORT = "Export it again."
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
KINDS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
KINDS |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f"}
KINDS |= {"float64": "d"}  # names of types, as letters of `struct` and NumPy
REALS = "fd"  # kinds of numbers that are not integers
MAX_HEADER = 1 << 16  # [bytes]
MAX_PROPERTIES = 1_000  # maximum number of properties of an element
END = re.compile(rb"[\r\n]end_header[ \t]*(?:\r\n|\r|\n)")
COLORS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))
INDICES = ("vertex_indices", "vertex_index")
Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class _Property:
    """A property of an element: its name, the kind of its values, and that of the length of a list; "" for others."""

    name: str
    kind: str
    count: str = ""


@dataclass(frozen=True)
class _Element:
    """An element of the header."""

    name: str
    count: int
    properties: list[_Property]


def read_ply(path: Path, data: bytes) -> tuple[Triangles, Float[np.ndarray, "t 3"] | None]:
    """Return the triangles of a PLY file, polygons as fans, and their linear colours; None if it states none.

    Args:
        path: The file, for messages.
        data: Its content.

    Raises:
        DatasetError: The header is broken, the file shorter than it says, or an index out of range.
    """
    place = Location(path)
    order, elements, start = _header(place, data)
    source: _Text | _Bytes = _Bytes(data, order, start) if order else _Text(parse_numbers(place, data[start:]))
    found: dict[str, Columns] = {}
    try:
        for element in elements:
            found[element.name] = _read(source, element)
    except (ValueError, IndexError, struct.error, OverflowError):
        raise place.error("file is shorter than its header says", "Fetch it again.") from None
    return _triangles(place, found.get("vertex", {}), found.get("face", {}), found.get("tristrips", {}))


def _header(place: Location, data: bytes) -> tuple[str, list[_Element], int]:
    """Return the byte order of a file, "" of text, its elements, and the start of their values."""
    end = END.search(data, 0, MAX_HEADER)
    if not data.startswith(b"ply") or end is None:
        raise place.error("not a file of PLY: no header", EXPORT)
    order, elements = None, list[_Element]()
    for line in data[: end.start()].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", kind, *_]:
                order = ORDERS.get(kind)
            case ["element", name, count] if count.isdecimal() and len(count) < 12:
                elements.append(_Element(name, int(count), []))
            case ["property", "list", count, kind, name] if elements and {count, kind} <= KINDS.keys():
                elements[-1].properties.append(_Property(name, KINDS[kind], KINDS[count]))
            case ["property", kind, name] if elements and kind in KINDS:
                elements[-1].properties.append(_Property(name, KINDS[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise place.error(f"unknown line of the PLY header: `{printable(line[:60])}`", EXPORT)
    if order is None or any(len(element.properties) > MAX_PROPERTIES for element in elements):
        raise place.error(f"expected a PLY header of the format {', '.join(ORDERS)}", EXPORT)
    return order, elements, end.end()


@dataclass
class _Text:
    """Values of a text, in their order."""

    values: Float[np.ndarray, " n"]
    position: int = 0

    def step(self, kind: str) -> int:
        """Return by how much a value moves the position."""
        return 1

    def length(self, kind: str, position: int) -> int:
        """Return the length of a list that a position has; raise `ValueError` if it is negative or beyond the end."""
        if position >= len(self.values) or not 0 <= self.values[position] <= len(self.values):
            raise ValueError("no length")
        return int(self.values[position])

    def gather(self, kind: str, start: Int[np.ndarray, " r"], length: Int[np.ndarray, " r"]) -> np.ndarray:
        """Return the values of lists, one after the other."""
        found = self.values[_places(start, length, 1)]
        return found if kind in REALS else found.astype(int)

    def scalar(self, kind: str) -> float:
        """Return the next value."""
        self.position += 1
        value = float(self.values[self.position - 1])
        return value if kind in REALS else int(value)

    def array(self, kind: str, count: int) -> np.ndarray:
        """Return the next values."""
        if count < 0 or self.position + count > len(self.values):
            raise ValueError("fewer values")
        self.position += count
        return self.values[self.position - count : self.position]

    def table(self, properties: list[_Property], count: int) -> Columns:
        """Return the columns of the next rows without lists."""
        rows = self.array("", count * len(properties)).reshape(count, len(properties))
        with np.errstate(invalid="ignore"):
            return {p.name: rows[:, i] if p.kind in REALS else rows[:, i].astype(int) for i, p in enumerate(properties)}


@dataclass
class _Bytes:
    """Values of a binary file."""

    data: bytes
    order: str
    position: int

    def step(self, kind: str) -> int:
        """Return by how much a value moves the position [bytes]."""
        return struct.calcsize(self.order + kind)

    def length(self, kind: str, position: int) -> int:
        """Return the length of a list that a position has; raise `ValueError` if it is negative or beyond the end."""
        found = self.data[position] if kind == "B" else struct.unpack_from(self.order + kind, self.data, position)[0]
        if not 0 <= found <= len(self.data):
            raise ValueError("no length")
        return int(found)

    def gather(self, kind: str, start: Int[np.ndarray, " r"], length: Int[np.ndarray, " r"]) -> np.ndarray:
        """Return the values of lists, one after the other."""
        step, raw = self.step(kind), np.frombuffer(self.data, np.uint8)
        places = _places(start, length, step)
        return np.stack([raw[places + i] for i in range(step)], axis=1).reshape(-1).view(self.order + kind)

    def scalar(self, kind: str) -> float:
        """Return the next value."""
        found = struct.unpack_from(self.order + kind, self.data, self.position)[0]
        self.position += struct.calcsize(self.order + kind)
        return found

    def array(self, kind: str, count: int) -> np.ndarray:
        """Return the next values."""
        if count < 0:
            raise ValueError("negative length")
        found = np.frombuffer(self.data, self.order + kind, count, self.position) if count else np.zeros(0, kind)
        self.position += found.nbytes
        return found

    def table(self, properties: list[_Property], count: int) -> Columns:
        """Return the columns of the next rows without lists."""
        kind = np.dtype([(f"{i}", self.order + one.kind) for i, one in enumerate(properties)])
        rows = np.frombuffer(self.data, kind, count, self.position) if count else np.zeros(0, kind)
        self.position += rows.nbytes
        return {one.name: rows[f"{i}"] for i, one in enumerate(properties)}


def _read(source: _Text | _Bytes, element: _Element) -> Columns:
    """Return the columns of an element; a list as its values in one array `NAME`, and its lengths `NAME.length`."""
    if not any(one.count for one in element.properties):
        return source.table(element.properties, element.count) if element.properties else {}
    return _read_equal(source, element) or _read_rows(source, element)


def _read_equal(source: _Text | _Bytes, element: _Element) -> Columns | None:
    """Return the columns of an element whose lists have the lengths of its first row; None if they differ."""
    start = source.position
    flat = _first_row(source, element) if element.count else []
    source.position = start
    if not flat or len(flat) > MAX_PROPERTIES:
        return None
    try:
        rows = source.table(flat, element.count)
    except ValueError:
        rows = {}
    lengths = {one.name: rows.get(f"{one.name}.length") for one in element.properties if one.count}
    if any(length is None or (length != length[0]).any() for length in lengths.values()):
        source.position = start
        return None
    entries = {name: [rows[f"{name}.{i}"] for i in range(int(n[0]))] for name, n in lengths.items() if n is not None}
    lists = {name: np.stack(e, axis=1).reshape(-1) if e else np.zeros(0) for name, e in entries.items()}
    return rows | lists


def _first_row(source: _Text | _Bytes, element: _Element) -> list[_Property]:
    """Return properties as of the next row, with one for the length and one for each value of its lists."""
    found: list[_Property] = []
    for one in element.properties:
        length = int(source.scalar(one.count)) if one.count else 1
        source.array(one.kind, length)
        if one.count:
            found.append(_Property(f"{one.name}.length", one.count))
        names = (f"{one.name}.{i}" if one.count else one.name for i in range(min(length, MAX_PROPERTIES)))
        found += [_Property(name, one.kind) for name in names]
    return found


def _read_rows(source: _Text | _Bytes, element: _Element) -> Columns:
    """Return the columns of an element whose lists have different lengths, which are found one by one."""
    steps = [
        (one.count, source.step(one.count) if one.count else 0, source.step(one.kind)) for one in element.properties
    ]
    starts, lengths, position = array("q"), array("q"), source.position
    for _ in range(element.count):
        for count, head, step in steps:
            length = source.length(count, position) if count else 1
            position += head
            starts.append(position)
            lengths.append(length)
            position += length * step
    source.position = position
    start, length = (np.frombuffer(rows, np.int64).reshape(-1, len(steps)).T for rows in (starts, lengths))
    columns = zip(element.properties, start, length, strict=True)
    found = {one.name: source.gather(one.kind, at, own) for one, at, own in columns}
    return found | {f"{one.name}.length": own for one, own in zip(element.properties, length, strict=True) if one.count}


def _places(start: Int[np.ndarray, " r"], length: Int[np.ndarray, " r"], step: int) -> Int[np.ndarray, " n"]:
    """Return the positions of the values of lists, one after the other."""
    first = np.cumsum(length) - length
    return np.repeat(start - first * step, length) + np.arange(int(length.sum())) * step


def _triangles(
    place: Location, vertex: Columns, face: Columns, strips: Columns
) -> tuple[Triangles, Float[np.ndarray, "t 3"] | None]:
    """Return the triangles of faces and strips, and their colours: of faces, else the mean of their vertices."""
    if not {"x", "y", "z"} <= vertex.keys():
        raise place.error("vertices of the PLY file have no x, y and z", EXPORT)
    points = np.stack([np.asarray(vertex[axis], float) for axis in "xyz"], axis=1)
    corner, owner = _fans(*_lists(face))
    corner = np.concatenate([corner, _strips(*_lists(strips))])
    if len(corner) and not 0 <= corner.min() <= corner.max() < len(points):
        raise place.error(f"faces have indices beyond the {len(points)} vertices", EXPORT)
    painted, tinted = _colors(face), _colors(vertex)
    if painted is not None and len(owner) == len(corner):
        return points[corner], painted[owner]
    return points[corner], None if tinted is None else tinted[corner].mean(axis=1)


def _lists(columns: Columns) -> tuple[Int[np.ndarray, " i"], Int[np.ndarray, " f"]]:
    """Return the indices of all faces, and the number of each one."""
    name = next((name for name in INDICES if f"{name}.length" in columns), None)
    if name is None:
        return np.zeros(0, int), np.zeros(0, int)
    return np.asarray(columns[name]).astype(int), np.asarray(columns[f"{name}.length"]).astype(int)


def _fans(
    index: Int[np.ndarray, " i"], length: Int[np.ndarray, " f"]
) -> tuple[Int[np.ndarray, "t 3"], Int[np.ndarray, " t"]]:
    """Return the triangles of polygons, and the polygon of each."""
    sides = np.maximum(length - 2, 0)
    owner = np.repeat(np.arange(len(length)), sides)
    first = np.repeat(np.cumsum(length) - length, sides)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(sides) - sides, sides)
    return index[np.stack([first, first + step + 1, first + step + 2], axis=1)].reshape(-1, 3), owner


def _strips(index: Int[np.ndarray, " i"], length: Int[np.ndarray, " f"]) -> Int[np.ndarray, "t 3"]:
    """Return the triangles of strips, each of which ends with -1 or its list, wound alike."""
    found = [np.zeros((0, 3), int)]
    for strip in np.split(index, np.cumsum(length)[:-1]) if len(length) else ():
        for part in np.split(strip, np.flatnonzero(strip < 0)):
            part = part[part >= 0]
            if len(part) >= 3:
                found.append(split_triangles(part, STRIP))
    return np.concatenate(found)


def _colors(columns: Columns) -> Float[np.ndarray, "n 3"] | None:
    """Return the linear colours of an element; integers are up to 255, reals up to 1; None without any."""
    names = next((names for names in COLORS if set(names) <= columns.keys()), None)
    if names is None:
        return None
    values = np.stack([np.asarray(columns[name], float) for name in names], axis=1)
    is_byte = columns[names[0]].dtype.kind in "iu"
    return decode_srgb(np.clip(values / 255 if is_byte else values, 0, 1))
