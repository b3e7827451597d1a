"""Invisible barriers along floor edges with a drop and without a wall."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import BoxSet, concat_boxes, footprint_distance, make_boxes
from home_mjx.scene_compile.collision.floors import FLOOR_THICKNESS, FloorPlan, highest_top_below
from home_mjx.scene_compile.objects.stairs import Staircase

MAX_SAFE_DROP = 0.3  # [m], drops up to this height need no barrier
BARRIER_HEIGHT = 1.1  # [m], height of a barrier
BARRIER_THICKNESS = 0.06  # [m], of a barrier
SAMPLE_SPACING = 0.05  # [m], maximum distance of the points at which an edge is tested
DROP_PROBE_DISTANCE = 0.05  # [m], distance beyond an edge at which the drop is measured
MAX_WALL_DISTANCE = 0.08  # [m], maximum distance from an edge to its wall; outlines run in or beside walls


@dataclass(frozen=True)
class FloorEdge:
    """A straight edge of a floor.

    Attributes:
        start: First end [m].
        end: Second end [m].
        outward: Unit direction away from the floor.
        height: Height of the floor [m].
    """

    start: Float[np.ndarray, "2"]
    end: Float[np.ndarray, "2"]
    outward: Float[np.ndarray, "2"]
    height: float

    @property
    def points(self) -> Float[np.ndarray, "n 2"]:
        """Middles of equal pieces of the edge, each at most `SAMPLE_SPACING` long [m]; at least one."""
        count = max(int(np.ceil(np.linalg.norm(self.end - self.start) / SAMPLE_SPACING)), 1)
        return self.start + (np.arange(count) + 0.5)[:, None] / count * (self.end - self.start)

    def segment(self, first: int, last: int) -> "FloorEdge":
        """Return the part of the edge around its points `first` (inclusive) to `last` (exclusive)."""
        way = (self.end - self.start) / len(self.points)
        return FloorEdge(self.start + first * way, self.start + last * way, self.outward, self.height)

    @property
    def barrier(self) -> BoxSet:
        """Upright box just beyond the edge; slightly longer, so that barriers meet at corners."""
        way = self.end - self.start
        length = float(np.linalg.norm(way))
        middle = (self.start + self.end) / 2 + self.outward * BARRIER_THICKNESS / 2
        low, high = self.height - FLOOR_THICKNESS, self.height + BARRIER_HEIGHT
        half = [length / 2 + BARRIER_THICKNESS, BARRIER_THICKNESS / 2, (high - low) / 2]
        return make_boxes([*middle, (low + high) / 2], half, float(np.arctan2(way[1], way[0])))


def build_drop_barriers(
    plans: Sequence[FloorPlan], floors: BoxSet, stairs: Sequence[Staircase], walls: BoxSet, ground_height: float
) -> BoxSet:
    """Return barriers along all edges of floors with a drop over `MAX_SAFE_DROP`, where no wall closes them.

    Args:
        plans: Floors of the levels.
        floors: Boxes of these floors.
        stairs: Stairs, which close the drop at their head.
        walls: Boxes that close an edge: walls, windows, existing barriers.
        ground_height: Height of the plane below everything [m].
    """
    found = []
    for plan in plans:
        for edge in _edges(plan):
            found += _runs(edge, _over_a_drop(edge, floors, stairs, ground_height) & ~_closed(edge, walls))
    return concat_boxes(edge.barrier for edge in found)


def _edges(plan: FloorPlan) -> Iterator[FloorEdge]:
    """Yield straight runs of cell sides with a floor and, beyond, no floor or one over `MAX_SAFE_DROP` lower."""
    padded = np.pad(plan.height, 1, constant_values=-np.inf)
    lines = plan.u, plan.v
    for axis in (0, 1):  # across u, then across v
        turned = padded[1:-1] if axis == 0 else padded[:, 1:-1].T
        for side in (1, -1):
            inner, outer = (turned[:, :-1], turned[:, 1:])[::side]
            over = inner > outer + MAX_SAFE_DROP
            for line in range(over.shape[1]):
                yield from _along(
                    plan, lines[axis][line], lines[1 - axis], np.where(over, inner, -np.inf)[:, line], axis, side
                )


def _along(
    plan: FloorPlan, at: float, stops: Float[np.ndarray, " n"], height: Float[np.ndarray, " m"], axis: int, side: int
) -> Iterator[FloorEdge]:
    """Yield the edges on the grid line u = `at` (axis 0) or v = `at` (axis 1), each along cells of equal height.

    `height` [m] is that of each cell between two `stops`, -inf for none; `side` is the sign of the outward direction.
    """
    breaks = np.flatnonzero(np.concatenate([[True], height[1:] != height[:-1], [True]]))
    for first, last in zip(breaks[:-1].tolist(), breaks[1:].tolist(), strict=True):
        if np.isfinite(height[first]):
            ends = np.array([[at, stops[first]], [at, stops[last]]])
            out = np.array([float(side), 0.0])
            ends, out = (ends, out) if axis == 0 else (ends[:, ::-1], out[::-1])
            start, end = plan.to_world(ends)
            yield FloorEdge(start, end, plan.to_world(out), float(height[first]))


def _over_a_drop(edge: FloorEdge, floors: BoxSet, stairs: Sequence[Staircase], ground: float) -> Bool[np.ndarray, " n"]:
    """Return for each point of an edge whether the surface just beyond it is over `MAX_SAFE_DROP` lower.

    The surface is the highest of the stairs, the `ground` [m], and the floors at most `MAX_SAFE_DROP` above the edge.
    """
    beyond = edge.points + DROP_PROBE_DISTANCE * edge.outward
    below = np.maximum(highest_top_below(floors, beyond, edge.height + MAX_SAFE_DROP), ground)
    for one in stairs:
        below = np.maximum(below, one.surface(beyond))
    return edge.height - below > MAX_SAFE_DROP


def _closed(edge: FloorEdge, walls: BoxSet) -> Bool[np.ndarray, " n"]:
    """Return for each point of the edge whether a box within `MAX_WALL_DISTANCE` spans the middle of a barrier."""
    middle = edge.height + BARRIER_HEIGHT / 2
    around = walls[(walls.bottom < middle) & (walls.top > middle)]
    return np.asarray((footprint_distance(around, edge.points[None]) < MAX_WALL_DISTANCE).any(axis=0))


def _runs(edge: FloorEdge, wanted: Bool[np.ndarray, " n"]) -> list[FloorEdge]:
    """Return the parts of an edge whose points are wanted, one per run of them, in order."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], wanted, [False]]).astype(int)))
    return [edge.segment(int(first), int(last)) for first, last in ends.reshape(-1, 2)]
