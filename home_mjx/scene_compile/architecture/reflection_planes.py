"""Rectangular planes for specular sound reflections: walls, floors and ceilings, without duplicates."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.polygons import find_smallest_room
from home_mjx.geometry.rectangle_cover import cell_centers, cover_with_rectangles, merge_close_values
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.architecture.shell import BuildingShell, ShellPart, WallPart, has_room_behind, inner_normal
from home_mjx.schema.compiled import MAX_MIRROR_DISTANCE, Planes, RoomTable

CORNER_MERGE_DISTANCE = 0.06  # [m], corners of neighbouring rooms closer than this are merged
MIN_RECTANGLE_EDGE = 0.2  # [m], minimum edge of a reflecting rectangle, and minimum overlap of two that are merged


@dataclass(frozen=True)
class ReflectionRectangle:
    """One reflecting rectangle, spanned by `u` and `v`."""

    center: Float[np.ndarray, "3"]  # [m]
    normal: Float[np.ndarray, "3"]
    u: Float[np.ndarray, "3"]  # [m], half extent vectors
    v: Float[np.ndarray, "3"]
    slot: int  # material slot of the architecture


def build_reflection_planes(shell: BuildingShell, rooms: RoomTable) -> Planes:
    """Build the reflection planes of a house: walls, floors and ceilings with edges above `MIN_RECTANGLE_EDGE`.

    A wall has its inner side and, if rooms are behind it, its outer side. Sides that overlap in a plane reflect once.
    Rows are inner sides, outer sides, floors, then ceilings; grounds have none.

    Args:
        shell: Its architecture, whose slots are the first rows of the house's material table.
        rooms: Its rooms.
    """
    walls = [(i, p, inner_normal(p, rooms)) for i, p in enumerate(shell.parts) if isinstance(p, WallPart)]
    inner = [_wall(p, normal, int(shell.inner_slot[i]), rooms) for i, p, normal in walls]
    outer = [
        _wall(p, -normal, int(shell.outer_slot[i]), rooms)
        for i, p, normal in walls
        if has_room_behind(p, normal, rooms)
    ]
    found = _merge_walls(_large(inner))
    # The far side of a wall is added only if no room has it as an inner side, for example around a nested room.
    known = _Table(found)
    found += [wall for wall in _merge_walls(_large(outer)) if not known.overlaps(wall).any()]
    found += _large(r for kind in ("floor", "ceiling") for r in _flat(shell, rooms, kind))
    return Planes(
        center=_rows(r.center for r in found),
        normal=_rows(r.normal for r in found),
        axis_u=_rows(r.u for r in found),
        axis_v=_rows(r.v for r in found),
        material=np.array([r.slot for r in found], np.int32),
    )


def _large(rectangles: Iterable[ReflectionRectangle]) -> list[ReflectionRectangle]:
    """Return the rectangles whose edges are both longer than `MIN_RECTANGLE_EDGE`."""
    return [r for r in rectangles if min(np.linalg.norm(r.u), np.linalg.norm(r.v)) * 2 > MIN_RECTANGLE_EDGE]


def _rows(vectors: Iterable[np.ndarray]) -> Float[np.ndarray, "p 3"]:
    """Stack vectors as rows; shape (0, 3) without any."""
    return np.array(list(vectors), float).reshape(-1, 3)


def _wall(part: WallPart, normal: Float[np.ndarray, "3"], slot: int, rooms: RoomTable) -> ReflectionRectangle:
    """Return the side of a wall that faces unit `normal`, from its room's floor to ceiling, with material `slot`."""
    slab = part.slab
    side = slab.high if slab.to_world(np.array([0.0, 1.0, 0.0])) @ normal > 0 else slab.low
    low, high = rooms.floor[part.room], rooms.ceiling[part.room]
    middle = np.array([(slab.low[0] + slab.high[0]) / 2, side[1], (low + high) / 2])
    along = slab.to_world(np.array([slab.length / 2, 0.0, 0.0]))
    return ReflectionRectangle(slab.to_world(middle), normal, along, np.array([0.0, 0.0, (high - low) / 2]), slot)


def _merge_walls(walls: Sequence[ReflectionRectangle]) -> list[ReflectionRectangle]:
    """Replace walls that overlap in a plane, as around nested rooms, by the rectangle around them until none do."""
    table, merged = _Table(walls), 0
    for wall in walls:
        twin = np.flatnonzero(table.overlaps(wall)[:merged])
        row = int(twin[0]) if len(twin) else merged
        table.set_row(row, _hull(table.rectangles[row], wall) if len(twin) else wall)
        merged += not len(twin)
    return table.rectangles[:merged] if merged == len(walls) else _merge_walls(table.rectangles[:merged])


class _Table:
    """Rectangles, and their columns for comparisons with one of them."""

    def __init__(self, rectangles: Sequence[ReflectionRectangle]) -> None:
        self.rectangles = list(rectangles)
        columns = ([getattr(r, name) for r in rectangles] for name in ("center", "normal", "u", "v"))
        self.center, self.normal, self.u, self.v = (_rows(vectors) for vectors in columns)

    def set_row(self, row: int, rectangle: ReflectionRectangle) -> None:
        """Replace the rectangle of a row in place."""
        self.rectangles[row] = rectangle
        self.center[row], self.normal[row] = rectangle.center, rectangle.normal
        self.u[row], self.v[row] = rectangle.u, rectangle.v

    def overlaps(self, a: ReflectionRectangle) -> Bool[np.ndarray, " n"]:
        """Return a mask of the walls in the plane of wall `a`, facing alike, that overlap it.

        That is by more than `MIN_RECTANGLE_EDGE` along it; in height, it is enough that they touch.
        """
        length = np.linalg.norm(a.u)
        direction, away = a.u / length, self.center - a.center
        near = (self.normal @ a.normal >= 0.999) & (abs(away @ a.normal) <= MAX_MIRROR_DISTANCE)
        near &= abs(away[:, 2]) <= a.v[2] + self.v[:, 2]
        return near & (abs(away @ direction) < length + abs(self.u @ direction) - MIN_RECTANGLE_EDGE)


def _hull(a: ReflectionRectangle, b: ReflectionRectangle) -> ReflectionRectangle:
    """Return the upright rectangle around two in the plane of `a`, with the material slot of the longer one.

    Of equally long ones, the slot is that of `a`.
    """
    direction = a.u / np.linalg.norm(a.u)
    along = np.array([[(r.center - a.center) @ direction, abs(r.u @ direction)] for r in (a, b)])
    low, high = (along[:, 0] - along[:, 1]).min(), (along[:, 0] + along[:, 1]).max()
    bottom, top = min(a.center[2] - a.v[2], b.center[2] - b.v[2]), max(a.center[2] + a.v[2], b.center[2] + b.v[2])
    center = a.center + direction * (low + high) / 2
    center[2] = (bottom + top) / 2
    slot = a.slot if along[0, 1] >= along[1, 1] else b.slot
    return ReflectionRectangle(
        center, a.normal, direction * (high - low) / 2, np.array([0, 0, (top - bottom) / 2]), slot
    )


def _flat(shell: BuildingShell, rooms: RoomTable, kind: str) -> list[ReflectionRectangle]:
    """Return the rectangles of floors or of ceilings (`kind`); where rooms nest, the smallest room owns the area."""
    found = []
    for part, slot in zip(shell.parts, shell.inner_slot, strict=True):
        if part.kind == kind:
            height = float((rooms.floor if kind == "floor" else rooms.ceiling)[part.room])
            normal = np.array([0.0, 0.0, 1.0 if kind == "floor" else -1.0])
            found += [_level(r, yaw, height, normal, int(slot)) for r, yaw in _plan_rectangles(shell, rooms, part)]
    return found


def _plan_rectangles(
    shell: BuildingShell, rooms: RoomTable, part: ShellPart
) -> list[tuple[Float[np.ndarray, "4"], float]]:
    """Return rectangles (u0, v0, u1, v1) [m] that cover the plan area where the part's room is the smallest one.

    Each comes with the yaw [rad] of its `u` axis, which is along the room's longest wall (0 without walls). The origin
    is the world's.
    """
    walls = [p.slab for p in shell.parts if isinstance(p, WallPart) and p.room == part.room]
    yaw = max(walls, key=lambda s: s.length).yaw if walls else 0.0
    turn = yaw_matrix(yaw)[:2, :2]
    here = np.flatnonzero(rooms.level == part.level)
    own = rooms.polygon[part.room] @ turn
    (u0, v0), (u1, v1) = own.min(axis=0), own.max(axis=0)
    others = np.concatenate([rooms.polygon[r] @ turn for r in here])
    within = ((others > [u0, v0]) & (others < [u1, v1])).all(axis=1)
    corners = np.concatenate([own, others[within]])
    u, v = (
        merge_close_values(corners[:, 0], CORNER_MERGE_DISTANCE),
        merge_close_values(corners[:, 1], CORNER_MERGE_DISTANCE),
    )
    mine = find_smallest_room(rooms, here, cell_centers(u, v) @ turn.T) == part.room
    return [(rectangle, yaw) for rectangle in cover_with_rectangles(u, v, mine)]


def _level(
    rectangle: Float[np.ndarray, "4"], yaw: float, height: float, normal: Float[np.ndarray, "3"], slot: int
) -> ReflectionRectangle:
    """Return a horizontal rectangle (u0, v0, u1, v1), in axes rotated by `yaw`, at a height [m]."""
    u0, v0, u1, v1 = rectangle
    turn = yaw_matrix(yaw)
    center = turn @ np.array([(u0 + u1) / 2, (v0 + v1) / 2, height])
    return ReflectionRectangle(center, normal, turn[:, 0] * (u1 - u0) / 2, turn[:, 1] * (v1 - v0) / 2, slot)
