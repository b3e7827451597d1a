"""Reader of SUNCG v2's `wall/<id>/<id>.arch.json`, which replaces room meshes, and construction of these meshes."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import JsonValue, Location, read_json
from home_mjx.datasets.suncg.formats.materials import read_material
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.geometry.mesh_pieces import CUT_MATERIAL, MeshPiece, join_pieces, wall_pieces
from home_mjx.geometry.slabs import slab
from home_mjx.geometry.wall_prisms import WALL_DEPTH, WALL_EXTRA_HEIGHT, Hole, WallSegment
from home_mjx.schema.house import Material, Mesh

WHITE = (1.0, 1.0, 1.0)
THICKNESS = {"Floor": 0.05, "Ceiling": 0.05, "Ground": 0.08}  # [m], default without `defaults` in the file
MAX_ELEMENTS = 10_000  # the largest house of SUNCG has 155 rooms
MAX_HOLES = 50  # maximum holes in one wall
MAX_CORNERS = 1_000  # maximum corners of one polygon

Note = Callable[[Location, str, str], None]


@dataclass(frozen=True)
class Architecture:
    """Architectural elements of one house; meshes are built on request."""

    file: Path
    scale: float  # [m] per unit of the file
    defaults: JsonValue
    elements: dict[tuple[str, str], list[JsonValue]]  # by type and room id; grounds by their own id
    textures: TextureLookup
    note: Note

    def mesh(self, kind: str, node_id: str) -> Mesh | None:
        """Build the `Wall`, `Floor`, `Ceiling` or `Ground` of a room or ground [m, Y up].

        None if the file has no such element, or only ones without faces.

        Raises:
            DatasetError: An element is broken.
        """
        values = self.elements.get((kind, node_id), [])
        pieces: list[MeshPiece] = []
        materials: list[Material] = []
        for value in values:
            found, slots = self._walls(value) if kind == "Wall" else self._slab(value, kind, node_id)
            pieces += [replace(piece, slot=piece.slot + len(materials)) for piece in found if len(piece.faces)]
            materials += slots
        return join_pieces(self.file, pieces, materials, self.scale) if pieces else None

    def _walls(self, value: JsonValue) -> tuple[list[MeshPiece], list[Material]]:
        """Return the pieces of a wall and its materials (inside, cut faces, outside); nothing if it has no length."""
        wall = self._wall(value)
        if wall is None:
            return [], []
        inside, outside = self._materials(value, 2)
        return wall_pieces(wall, value.member("id").text()), [inside, CUT_MATERIAL, outside]

    def _wall(self, value: JsonValue) -> WallSegment | None:
        """Read a wall in units of the file; None if it has no length, which is noted.

        Raise `DatasetError` if its ends differ in height.
        """
        start, end = (point.vector(3) for point in _exactly(value.member("points"), 2))
        if np.linalg.norm((end - start)[[0, 2]]) < 1e-6:
            self.note(value.member("points"), "flat-wall", "wall without length: left out")
            return None
        if abs(end - start)[1] > 1e-6:
            raise value.member("points").error(f"expected ends of one height, got {start[1]:g} and {end[1]:g}")
        return WallSegment(
            start,
            end,
            self._measure(value, "Wall", "height", 2.7),
            tuple(_hole(hole.member("box")) for hole in _holes(value.member("holes"))),
            self._measure(value, "Wall", "depth", WALL_DEPTH),
            self._measure(value, "Wall", "extraHeight", WALL_EXTRA_HEIGHT, least=0.0),
        )

    def _slab(self, value: JsonValue, kind: str, node_id: str) -> tuple[list[MeshPiece], list[Material]]:
        """Build a slab in units of the file over all polygons of an element, and return its one material.

        Corners are relative to `offset`, whose y is the height of the upper side.
        """
        x, high, z = value.member("offset").vector(3)
        if value.member("points").data == []:
            raise value.member("points").error("expected at least one polygon, got none")
        polygons = [_polygon(points) + np.array([x, z]) for points in value.member("points").entries()]
        low = high - self._measure(value, kind, "depth", THICKNESS[kind])
        outset = self._length(self._default("Wall", "depth"), WALL_DEPTH, 1e-3) / 5
        try:
            vertices, faces, uv = slab(polygons, low, high, outset)
        except ValueError as error:
            raise value.member("points").error(str(error)) from None
        return [MeshPiece(f"{kind}#{node_id}", vertices, faces, uv, np.zeros(len(faces), int))], self._materials(
            value, 1
        )

    def _measure(self, value: JsonValue, kind: str, key: str, default: float, least: float = 1e-3) -> float:
        """Return a length of an element in units of the file; else that of `defaults`, else `default` [m], converted.

        Raise `DatasetError` if it is below `least` units.
        """
        own = value.member(key)
        return self._length(own if own.has_value else self._default(kind, key), default, least)

    def _default(self, kind: str, key: str) -> JsonValue:
        """Return `defaults.<kind>.<key>` of the file, null if absent."""
        common = self.defaults.member(kind) if self.defaults.has_value else self.defaults
        return common.member(key) if common.has_value else common

    def _length(self, value: JsonValue, default: float, least: float) -> float:
        """Return a length in units of the file, that of `default` [m] if null; raise `DatasetError` below `least`."""
        length = value.coordinate() if value.has_value else default / self.scale
        if length < least:
            raise value.error(f"expected a length of at least {least:g}, got {length:g}")
        return length

    def _materials(self, value: JsonValue, count: int) -> list[Material]:
        """Return `count` opaque materials of an element; missing ones and missing colours are white.

        Further ones are dropped.
        """
        listed = value.member("materials")
        found = [read_material(entry, self.textures) for entry in listed.entries()] if listed.has_value else []
        padded = [*found, *[Material("")] * count][:count]
        return [replace(material, diffuse=material.diffuse or WHITE, opacity=1.0) for material in padded]


def read_architecture(path: Path, textures: TextureLookup, note: Note) -> Architecture:
    """Read the architecture of one house from its arch.json.

    `note` is called with place, rule and message of each tolerated irregularity.

    Raises:
        DatasetError: The file is missing, not JSON, or does not list elements.
    """
    document = read_json(path)
    version, scale = document.member("version"), document.member("scaleToMeters")
    if not version.has_value or not version.text().startswith("suncg-arch"):
        note(version, "format-version", "expected suncg-arch@1.0.0 or suncg-arch@1.0.2: read as such")
    house_id = document.member("id")
    if house_id.has_value and house_id.data != path.parent.name:
        note(house_id, "house-id", f"expected {path.parent.name}, the folder's name: ignored")
    if scale.has_value and not 1e-4 <= scale.number() <= 1e4:
        raise scale.error(f"expected metres per unit, got {scale.number():g}", "SUNCG writes 1.")
    elements: dict[tuple[str, str], list[JsonValue]] = defaultdict(list)
    values = document.member("elements").entries()
    if len(values) > MAX_ELEMENTS:
        raise document.member("elements").error(f"expected at most {MAX_ELEMENTS} elements, got {len(values)}")
    for value in values:
        kind = value.member("type").text()
        if kind in ("Wall", *THICKNESS):
            owner = value.member("id" if kind == "Ground" else "roomId")
            elements[kind, owner.text()].append(value)
        else:
            note(value.member("type"), "element-type", f"unknown element type `{kind}`: left out")
    unit = scale.number() if scale.has_value else 1.0
    return Architecture(path, unit, document.member("defaults"), dict(elements), textures, note)


def _exactly(value: JsonValue, count: int) -> list[JsonValue]:
    """Return the entries of a list; raise `DatasetError` unless there are `count`."""
    entries = value.entries()
    if len(entries) != count:
        raise value.error(f"expected {count} points, got {len(entries)}")
    return entries


def _holes(value: JsonValue) -> list[JsonValue]:
    """Return the holes of a wall, [] if null; raise `DatasetError` if there are more than `MAX_HOLES`."""
    entries = value.entries() if value.has_value else []
    if len(entries) > MAX_HOLES:
        raise value.error(f"expected at most {MAX_HOLES} holes in a wall, got {len(entries)}")
    return entries


def _hole(box: JsonValue) -> Hole:
    """Return (left, right, low, high) of a hole, from the wall's start and base, in units of the file.

    Raise `DatasetError` if a minimum is above its maximum; equal ones are accepted.
    """
    (left, low), (right, high) = box.member("min").vector(2).tolist(), box.member("max").vector(2).tolist()
    if left > right or low > high:
        raise box.error("hole is inside out")
    return left, right, low, high


def _polygon(points: JsonValue) -> Float[np.ndarray, "n 2"]:
    """Return the corners (x, z) of a polygon in units of the file; their y is ignored.

    Raise `DatasetError` for less than 3 or more than `MAX_CORNERS` corners.
    """
    entries = points.entries()
    if not 3 <= len(entries) <= MAX_CORNERS:
        raise points.error(f"expected 3 to {MAX_CORNERS} corners, got {len(entries)}")
    corners = [point.vector(3)[[0, 2]] for point in entries]
    return np.array(corners)
