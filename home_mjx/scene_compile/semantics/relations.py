"""Spatial relations of objects: on, in, next to; and, for an observer, left of, right of, in front of, behind."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from home_mjx.geometry.boxes import BoxSet, footprint, footprint_distance, penetration_depth
from home_mjx.scene_compile.semantics.supports import Support

MAX_NEIGHBOUR_GAP = 0.5  # [m], maximum distance between the footprints of neighbours
MIN_SEPARATION = 0.1  # [m], minimum distance across or along the line of sight for a relation
MAX_VIEW_ANGLE = np.deg2rad(135)  # maximum angle between two objects; no field of view is larger
OPPOSITE = {"left of": "right of", "in front of": "behind"}


@dataclass(frozen=True)
class Relation:
    """Relation between two objects, by object id: `subject` is on, in, next to, left of … `object`."""

    subject: int
    predicate: str
    object: int


@dataclass(frozen=True)
class ObserverPose:
    """Position and heading of an observer.

    Attributes:
        x: World x [m].
        y: World y [m].
        heading: Direction of view about +z, 0 along +x [rad].
    """

    x: float
    y: float
    heading: float = 0.0

    def side(self, point: Sequence[float]) -> str:
        """Return the quadrant of a point relative to the observer: `ahead`, `left`, `behind` or `right`.

        Args:
            point: World x and y [m]; further numbers are ignored.

        Example:
            >>> ObserverPose(0.0, 0.0, heading=np.pi / 2).side((-2.0, 0.5))
            'left'
        """
        bearing = np.arctan2(point[1] - self.y, point[0] - self.x) - self.heading
        return ("ahead", "left", "behind", "right")[int(np.round(bearing / (np.pi / 2))) % 4]


def static_relations(
    ids: Sequence[int], boxes: BoxSet, places: Int[np.ndarray, "o 2"], supports: Sequence[Support]
) -> tuple[Relation, ...]:
    """Return the relations that are independent of the observer.

    An object is `in` its container or else `on` the object below; floors and walls give no relations. `next to` is
    listed in both directions. It relates objects of one room with footprints at most `MAX_NEIGHBOUR_GAP` apart and
    overlapping heights, unless one is on or in the other.

    Args:
        ids: Object ids.
        boxes: Their upright boxes.
        places: Level and room of each object.
        supports: Support of each object.
    """
    held = [
        Relation(i, "in", s.container) if s.container >= 0 else Relation(i, "on", s.supporter)
        for i, s in zip(ids, supports, strict=True)
        if s.kind == "object"
    ]
    apart = {frozenset((r.subject, r.object)) for r in held}
    near = [
        Relation(ids[a], "next to", ids[b])
        for a in range(len(ids))
        for b in _neighbours(a, boxes, places)
        if frozenset((ids[a], ids[b])) not in apart
    ]
    return (*held, *(r for pair in near for r in (pair, Relation(pair.object, pair.predicate, pair.subject))))


def _neighbours(index: int, boxes: BoxSet, places: Int[np.ndarray, "o 2"]) -> list[int]:
    """Return the indices above `index` of objects in its room, `MAX_NEIGHBOUR_GAP` apart or less, at common heights."""
    reach = np.hypot(boxes.half[:, 0], boxes.half[:, 1])
    apart = np.hypot(*(boxes.center[:, :2] - boxes.center[index, :2]).T)
    near = (
        (places == places[index]).all(axis=1) & (places[:, 1] >= 0) & (apart < reach + reach[index] + MAX_NEIGHBOUR_GAP)
    )
    near &= np.minimum(boxes.top, boxes.top[index]) > np.maximum(boxes.bottom, boxes.bottom[index])
    later = np.flatnonzero(near)
    return [b for b in later[later > index].tolist() if footprint_gap(boxes, index, b) <= MAX_NEIGHBOUR_GAP]


def footprint_gap(boxes: BoxSet, a: int, b: int) -> float:
    """Return the distance between the footprints of two boxes [m]; 0 if they touch or overlap."""
    if penetration_depth(boxes[[a]], boxes[[b]])[0, 0] >= 0:
        return 0.0
    # One of the nearest points of two apart convex polygons is a corner.
    return float(footprint_distance(boxes[[b, a]], np.stack([footprint(boxes, a), footprint(boxes, b)])).min())


def observer_relations(
    ids: Sequence[int], boxes: BoxSet, places: Int[np.ndarray, "o 2"], observer: ObserverPose
) -> tuple[Relation, ...]:
    """Return both relations of each pair of objects of a room, relative to an observer.

    Two distances between their centres are compared: across the line of sight (mean range times difference of bearings)
    and along it (difference of ranges). The larger one decides: left of or right of, else in front of (nearer) or
    behind. Pairs on opposite sides of the observer (`MAX_VIEW_ANGLE`) are omitted. So are pairs whose larger distance,
    or the distance of one to the observer, is below `MIN_SEPARATION`.

    Args:
        ids: Object ids.
        boxes: Their upright boxes.
        places: Level and room of each object.
        observer: Position of the observer; its heading is not used.

    Example:
        >>> boxes = box_set([[2.0, 1.0, 0.0], [2.0, -1.0, 0.0]], [0.2, 0.2, 0.2])  # doctest: +SKIP
        >>> observer_relations([7, 8], boxes, np.zeros((2, 2), int), ObserverPose(0.0, 0.0))[0]  # doctest: +SKIP
        Relation(subject=7, predicate='left of', object=8)
    """
    way = boxes.center[:, :2] - (observer.x, observer.y)
    reach, bearing = np.hypot(way[:, 0], way[:, 1]), np.arctan2(way[:, 1], way[:, 0])
    found = []
    for a, b in _pairs(places):
        turn = (bearing[a] - bearing[b] + np.pi) % (2 * np.pi) - np.pi
        if abs(turn) > MAX_VIEW_ANGLE or min(reach[a], reach[b]) < MIN_SEPARATION:
            continue
        found += _order(ids[a], ids[b], float(turn * (reach[a] + reach[b]) / 2), float(reach[b] - reach[a]))
    return tuple(found)


def _pairs(places: Int[np.ndarray, "o 2"]) -> list[tuple[int, int]]:
    """Return index pairs (lower, higher) of objects in the same room; objects outside all rooms have none."""
    together = (places[:, None] == places).all(axis=-1) & (places[:, 1] >= 0)
    return [(int(a), int(b)) for a, b in np.argwhere(np.triu(together, 1))]


def _order(a: int, b: int, leftward: float, nearer: float) -> list[Relation]:
    """Return both relations of objects `a` and `b` by the larger distance; empty if it is below `MIN_SEPARATION`.

    `leftward` [m] is positive if `a` is left of `b`, `nearer` [m] if `a` is in front of `b`.
    """
    across = abs(leftward) >= abs(nearer)
    way, predicate = (leftward, "left of") if across else (nearer, "in front of")
    if abs(way) < MIN_SEPARATION:
        return []
    first, second = (a, b) if way > 0 else (b, a)
    return [Relation(first, predicate, second), Relation(second, OPPOSITE[predicate], first)]
