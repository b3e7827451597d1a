"""Rooms of the floor plan: rectangles or L-shapes, their outlines and walls."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

LINE_TOLERANCE = 0.05  # [m], half the grid of the wall lines: closer lines count as the same line


class Rect(NamedTuple):
    """A rectangle in the floor plan [m]."""

    x0: float
    z0: float
    x1: float
    z1: float

    @property
    def extents(self) -> tuple[float, float]:
        """Extents along x and z [m]."""
        return self.x1 - self.x0, self.z1 - self.z0


@dataclass(frozen=True)
class PlanWall:
    """One straight wall of a room; the interior is on the side of `normal`."""

    start: tuple[float, float]  # (x, z) [m], on the centre-line
    end: tuple[float, float]

    @cached_property
    def axis(self) -> int:
        """0 if the wall runs along x, 1 if along z; index of the coordinate along it in (x, z)."""
        return int(self.start[0] == self.end[0])

    @cached_property
    def line(self) -> float:
        """Coordinate of the centre-line: z of a wall along x, x of a wall along z [m]."""
        return self.start[1 - self.axis]

    @cached_property
    def span(self) -> tuple[float, float]:
        """Lower and upper coordinate along the wall [m]."""
        low, high = sorted((self.start[self.axis], self.end[self.axis]))
        return low, high

    @cached_property
    def length(self) -> float:
        """Length along the centre-line [m]."""
        return self.span[1] - self.span[0]

    @cached_property
    def direction(self) -> Float[np.ndarray, " 2"]:
        """Unit vector (x, z) from start to end."""
        return np.sign(np.subtract(self.end, self.start))

    @cached_property
    def normal(self) -> Float[np.ndarray, " 2"]:
        """Unit vector (x, z) into the room: direction x up."""
        return np.array([-self.direction[1], self.direction[0]])

    def point(self, along: float, off: float = 0.0) -> tuple[float, float]:
        """Return the point (x, z) at a coordinate along the wall, `off` metres into the room."""
        at = np.empty(2)
        at[self.axis], at[1 - self.axis] = along, self.line
        x, z = np.round(at + off * self.normal, 6).tolist()
        return x, z


@dataclass(frozen=True)
class RoomPlan:
    """A room as one rectangle, or two that form an L."""

    type: str
    rects: tuple[Rect, ...]

    @cached_property
    def polygon(self) -> Float[np.ndarray, "n 2"]:
        """Centre-lines of the walls as corners (x, z), clockwise seen from above with x right and z down."""
        return outline(self.rects)

    @cached_property
    def walls(self) -> tuple[PlanWall, ...]:
        """One wall per side of the polygon, in the order of its corners."""
        corners = [(float(x), float(z)) for x, z in self.polygon]
        return tuple(PlanWall(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True))

    @property
    def area(self) -> float:
        """Floor area [m^2]."""
        return sum(width * depth for width, depth in (rect.extents for rect in self.rects))


def outline(rects: Sequence[Rect]) -> Float[np.ndarray, "n 2"]:
    """Return the corners of a connected union of rectangles, clockwise seen from above with x right and z down."""
    # Sets and lists, because NumPy takes several times as long for a few numbers.
    xs, zs = sorted({x for r in rects for x in (r.x0, r.x1)}), sorted({z for r in rects for z in (r.z0, r.z1)})
    edges: set[tuple[tuple[int, int], tuple[int, int]]] = set()
    for i, x in enumerate(xs[:-1]):
        for j, z in enumerate(zs[:-1]):
            if any(r.x0 <= x < r.x1 and r.z0 <= z < r.z1 for r in rects):
                loop = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                edges |= set(zip(loop, loop[1:] + loop[:1], strict=True))
    after = dict(edge for edge in edges if edge[::-1] not in edges)  # edges between two cells occur in both directions
    corners = [min(after)]
    while len(corners) < len(after):
        corners.append(after[corners[-1]])
    around = zip(corners[-1:] + corners[:-1], corners, corners[1:] + corners[:1], strict=True)
    turns = [(i, j) for (a, b), (i, j), (c, d) in around if (i != a) != (c != i) or (j != b) != (d != j)]
    return np.array([(xs[i], zs[j]) for i, j in turns])


def shared_span(wall: PlanWall, other: PlanWall) -> tuple[float, float] | None:
    """Return the common span (low, high) of two coinciding walls of different rooms [m]; None if they have none."""
    if wall.axis != other.axis or abs(wall.line - other.line) > LINE_TOLERANCE:
        return None
    low, high = max(wall.span[0], other.span[0]), min(wall.span[1], other.span[1])
    return (low, high) if high - low > LINE_TOLERANCE else None


def outer_spans(wall: PlanWall, others: Sequence[PlanWall]) -> list[tuple[float, float]]:
    """Return the spans (low, high) of a wall that none of the `others` shares [m], ascending; empty if none is left."""
    shared = sorted(span for other in others if (span := shared_span(wall, other)))
    spans, low = [], wall.span[0]
    for start, end in [*shared, (wall.span[1], wall.span[1])]:
        if start - low > LINE_TOLERANCE:
            spans.append((low, start))
        low = max(low, end)
    return spans
