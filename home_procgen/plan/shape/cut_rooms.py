"""Rooms with cut-off corners."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.rooms import PlanWall, RoomPlan, outline

Point = tuple[float, float]


@dataclass(frozen=True)
class CutRoom(RoomPlan):
    """A room with convex corners cut off at 45 degrees.

    Attributes:
        cuts: Corners (x, z), each with the length by which its walls are shortened [m].
    """

    cuts: tuple[tuple[float, float, float], ...] = ()

    @cached_property
    def polygon(self) -> Float[np.ndarray, "n 2"]:
        """Corners as in `RoomPlan`, with two for each one that is cut."""
        corners = outline(self.rects)
        found: list[np.ndarray] = []
        for before, corner, after in zip(np.roll(corners, 1, 0), corners, np.roll(corners, -1, 0), strict=True):
            size = next((s for x, z, s in self.cuts if np.allclose(corner, (x, z), atol=1e-6)), 0.0)
            ways = [(p - corner) / np.linalg.norm(p - corner) for p in (before, after)]
            found += [np.round(corner + size * way, 6) for way in ways] if size else [corner]
        return np.array(found)

    @cached_property
    def walls(self) -> tuple[PlanWall, ...]:
        """Axis-aligned walls only, because furniture and openings do not support others."""
        return tuple(PlanWall(a, b) for a, b in outline_sides(self) if a[0] == b[0] or a[1] == b[1])

    @property
    def area(self) -> float:
        """Floor area without the cut-off corners [m^2]."""
        return super().area - sum(size**2 / 2 for _, _, size in self.cuts)


def outline_sides(room: RoomPlan) -> list[tuple[Point, Point]]:
    """Return all sides of a room's outline in order, with slanted ones [m]."""
    corners = [(float(x), float(z)) for x, z in room.polygon]
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


def slanted_sides(room: RoomPlan) -> list[tuple[Point, Point]]:
    """Return the slanted sides of a room's outline [m]."""
    return [(a, b) for a, b in outline_sides(room) if a[0] != b[0] and a[1] != b[1]]


def is_beside_cut(room: RoomPlan, wall: PlanWall) -> bool:
    """Return whether a wall ends at a cut-off corner, as the front of a bay does."""
    ends = [end for side in slanted_sides(room) for end in side]
    return wall.start in ends or wall.end in ends
