"""A scene as a house: rooms with their floors, ceilings and walls, objects, and the rest as static pieces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.datasets.gltf.categories import STRUCTURE
from home_mjx.datasets.gltf.layout.rooms import SceneRoom
from home_mjx.datasets.gltf.layout.triangle_set import (
    MAX_UNCUT_EDGE,
    TriangleSet,
    concat_triangles,
    halve_long_edges,
    split_by_outlines,
)
from home_mjx.datasets.gltf.layout.walls import find_walls, mask_of
from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.polygons import polygon_area
from home_mjx.geometry.slabs import simplify, triangulate
from home_mjx.schema.house import Joint, Level, Mesh, ObjectNode, RoomNode

FLAT_SLOPE = 0.7  # minimum vertical component of the unit normals of floors and ceilings
GROUND_SLOPE = 0.95  # minimum vertical component of the unit normals of lawns
FLOOR_REACH, CEILING_REACH = 0.15, 0.3  # [m], maximum distance of faces from the height of a room's floor or ceiling
ROUGHNESS = 0.08  # [m], small faces up to this height above a floor belong to it, whatever their slope
PIECE_SIZE = 1.0  # [m], edge of the cells into which static geometry is cut; its colliders are boxes around parts of it
FAR_PIECE_SIZE = 8.0  # [m], the same for geometry that agents cannot reach, which is not cut
PLOT_MARGIN = 2.5  # [m], around all rooms, within which agents may be; a fence is at 2 m
MAX_PIECES = 2_000  # maximum number of pieces of a house; more would need larger cells
GROWTH = 1.3  # ratio of the sizes of cells that are tried
MAX_CUT_TRIANGLES = 300_000  # maximum number of triangles after cutting, see `_cutting_cost`
LONG_EDGE = 8.0  # [m], minimum extent of triangles that count by their extents, since they may be slivers
REACH = (-0.5, 2.2)  # [m] around floors: heights at which agents touch things


@runtime_checkable
class SceneObject(Protocol):
    """An object that a reader found in a scene."""

    @property
    def fine(self) -> str:
        """Fine category, which is the id of its model."""
        ...

    @property
    def key(self) -> str:
        """Name of its mesh, equal for copies."""
        ...

    @property
    def matrix(self) -> Float[np.ndarray, "4 4"]:
        """House from object."""
        ...

    @property
    def points(self) -> Float[np.ndarray, "p 3"]:
        """Vertices in the house [m]."""
        ...

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Movable parts of its mesh."""
        ...

    @property
    def extra(self) -> Mapping[str, Any]:
        """Further entries of the file."""
        ...

    def mesh(self) -> Mesh:
        """Return its mesh in its own frame."""
        ...


@dataclass
class HouseParts:
    """Levels of a house under construction.

    Attributes:
        path: File of the scene, for messages.
        rooms: Rooms, by level.
        models: Meshes of the objects by key.
    """

    path: Path
    rooms: Sequence[SceneRoom]
    models: dict[str, Mesh] = field(default_factory=dict)

    def levels(self, triangles: TriangleSet, objects: Sequence[SceneObject]) -> tuple[Level, ...]:
        """Return the levels: rooms with the triangles that are theirs, objects, and all other triangles as pieces."""
        built, rest = [], triangles
        numbers = sorted({room.level for room in self.rooms})
        for number in numbers:
            rooms, rest = self._rooms(number, rest)
            built.append(rooms)
        floors = [min(r.shape.floor for r in self.rooms if r.level == n) for n in numbers]
        pieces = self._pieces(rest, floors)
        return tuple(
            Level(
                id=str(number),
                index=number,
                rooms=tuple(rooms),
                objects=tuple(self._objects(number, len(rooms), objects, pieces, floors, numbers)),
                boxes=(),
                grounds=(),
            )
            for number, rooms in zip(numbers, built, strict=True)
        )

    def _rooms(self, level: int, triangles: TriangleSet) -> tuple[list[RoomNode], TriangleSet]:
        """Return the rooms of a level, and the triangles that are in none of them."""
        rooms = [room for room in self.rooms if room.level == level]
        shapes = [room.shape for room in rooms]
        heights = min(s.floor for s in shapes) - 0.1, max(s.ceiling for s in shapes) + 0.1
        walls = find_walls(triangles, [s.corners for s in shapes], heights)
        taken = mask_of(walls, len(triangles))
        flat = triangles[~taken]
        floors, flat = _split_flat(flat, rooms, 1.0)
        ceilings, flat = _split_flat(flat, rooms, -1.0)
        nodes = [
            RoomNode(
                id=f"{level}_{i}",
                index=i,
                path=f"levels[{level}].rooms[{i}]",
                bbox=None,
                model_id=f"room_{level}_{i}",
                types=room.types,
                members=(),
                floor=floors[i].mesh(self.path) if len(floors[i]) else None,
                ceiling=ceilings[i].mesh(self.path) if len(ceilings[i]) else None,
                walls=_wall_mesh(self.path, triangles, walls.get(i, [])),
                shape=room.shape,
            )
            for i, room in enumerate(rooms)
        ]
        return nodes, flat

    def _pieces(self, triangles: TriangleSet, floors: Sequence[float]) -> list[TriangleSet]:
        """Return triangles by cells of a grid; those that agents can reach are cut to the size of a cell first."""
        reach = self._reachable(triangles, floors)
        ground = _is_ground(triangles, floors)
        near = reach & ~ground
        edge = max(PIECE_SIZE, float(np.sqrt(_cutting_cost(triangles[near]) / MAX_CUT_TRIANGLES)))
        parts = [halve_long_edges(triangles[near], edge), triangles[~reach & ~ground], triangles[ground]]
        kind = np.repeat(np.arange(3), [len(part) for part in parts])[:, None]
        triangles, size = concat_triangles(parts), np.where(kind > 0, FAR_PIECE_SIZE, PIECE_SIZE)
        while True:
            cells = np.concatenate([np.floor(triangles.middle / size), kind], axis=1).astype(int)
            found, number = unique_cells(cells)
            if len(found) <= MAX_PIECES:
                break
            # Cells of twice the size are about an eighth as many, or more: no size that suffices is passed.
            size = size * GROWTH ** max(1, int(np.log(len(found) / MAX_PIECES) / np.log(GROWTH) / 3))
        order = np.argsort(number, kind="stable")
        cuts = np.flatnonzero(np.diff(number[order])) + 1
        return [triangles[rows] for rows in np.split(order, cuts)] if len(order) else []

    def _reachable(self, triangles: TriangleSet, floors: Sequence[float]) -> Bool[np.ndarray, " t"]:
        """Return a mask of the triangles that agents may touch: near rooms, and at their heights."""
        corners = np.concatenate([room.shape.corners for room in self.rooms])
        low, high = corners.min(axis=0) - PLOT_MARGIN, corners.max(axis=0) + PLOT_MARGIN
        plan = triangles.corners[..., [0, 2]]
        beside = ((plan.max(axis=1) > low) & (plan.min(axis=1) < high)).all(axis=1)
        return beside & triangles.within(min(floors) + REACH[0], max(floors) + REACH[1])

    def _objects(
        self,
        level: int,
        first: int,
        objects: Sequence[SceneObject],
        pieces: Sequence[TriangleSet],
        floors: Sequence[float],
        numbers: Sequence[int],
    ) -> list[ObjectNode]:
        """Return the objects and pieces of a level, whose nodes are numbered from `first`."""
        nodes = []
        for one in objects:
            if numbers[_storey(float(one.points[:, 1].min()) + 0.5, floors)] == level:
                mesh = self.models.get(one.key) or one.mesh()
                node = self._node(level, first + len(nodes), one.fine, one.key, mesh, one.matrix)
                nodes.append(replace(node, joints=one.joints, extra=one.extra))
        for number, piece in enumerate(pieces):
            middle = piece.corners.reshape(-1, 3).mean(axis=0)
            if numbers[_storey(float(middle[1]), floors)] == level:
                moved = TriangleSet(piece.corners - middle, piece.uv, piece.slot, piece.materials)
                transform = np.eye(4)
                transform[:3, 3] = middle
                key = f"{STRUCTURE}_{number}"
                nodes.append(self._node(level, first + len(nodes), STRUCTURE, key, moved.mesh(self.path), transform))
        return nodes

    def _node(
        self, level: int, index: int, model_id: str, key: str, mesh: Mesh, transform: Float[np.ndarray, "4 4"]
    ) -> ObjectNode:
        """Return one object, and keep its mesh."""
        self.models[key] = mesh
        return ObjectNode(
            id=f"{level}_{index}",
            index=index,
            path=f"levels[{level}].objects[{index}]",
            bbox=None,
            model_id=model_id,
            model_key=key,
            transform=transform,
        )


def _cutting_cost(triangles: TriangleSet) -> float:
    """Return about the number of triangles after quartering to edges of 1 m; only that of short slivers is too low."""
    extent = np.ptp(triangles.corners, axis=1).max(axis=1, initial=0)
    return float(np.where(extent > LONG_EDGE, 4 * extent**2, 8 * triangles.area).sum())


def _is_ground(triangles: TriangleSet, floors: Sequence[float]) -> Bool[np.ndarray, " t"]:
    """Return a mask of level triangles at the height of a floor or just below, such as lawns: no obstacles."""
    high = triangles.heights[:, 1]
    near = [(high < floor + ROUGHNESS) & (high > floor + REACH[0]) for floor in floors]
    return (abs(triangles.slope) > GROUND_SLOPE) & np.any(near, axis=0)


def _storey(height: float, floors: Sequence[float]) -> int:
    """Return the index of the highest floor below a height [m]; 0 if none is."""
    return max(0, int(np.searchsorted(floors, height)) - 1)


def _split_flat(
    triangles: TriangleSet, rooms: Sequence[SceneRoom], side: float
) -> tuple[list[TriangleSet], TriangleSet]:
    """Return the floor (`side` 1) or ceiling (-1) of each room, and all other triangles."""
    heights = np.array([r.shape.floor if side > 0 else r.shape.ceiling for r in rooms])
    reach = FLOOR_REACH if side > 0 else CEILING_REACH
    low, high = heights.min() - reach, heights.max() + reach
    flat = (abs(triangles.slope) > FLAT_SLOPE) & triangles.within(low, high)
    if side > 0:  # rough floors of scans
        flat |= (triangles.extent < MAX_UNCUT_EDGE) & (triangles.heights[:, 1] < heights.max() + ROUGHNESS)
    order = np.argsort([polygon_area(room.shape.corners) for room in rooms], kind="stable")
    outlines = [list(_fill(rooms[i].shape.corners)) for i in order]
    parts, left = split_by_outlines(triangles[flat], outlines)
    found, rest = {}, [triangles[~flat], left]
    for i, part in zip(order.tolist(), parts, strict=True):
        near = abs(part.middle[:, 1] - heights[i]) <= reach
        near &= side > 0 or bool((part.slope[near] < -FLAT_SLOPE).any())  # tops of walls alone are no ceiling
        found[i] = part[near]
        rest.append(part[~near])
    return [found[i] for i in range(len(rooms))], concat_triangles(rest)


def _fill(corners: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "t 3 2"]:
    """Return triangles (x, z) that fill an outline."""
    simple = simplify(corners)
    return simple[triangulate(simple)]


def _wall_mesh(path: Path, triangles: TriangleSet, walls: Sequence[Int[np.ndarray, " _"]]) -> Mesh | None:
    """Return the walls of a room as one mesh with a part each; None without walls."""
    if not walls:
        return None
    part = np.repeat(np.arange(len(walls)), [len(rows) for rows in walls])
    return triangles[np.concatenate(walls)].mesh(path, part)
