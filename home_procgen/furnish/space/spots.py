"""Placement on the floor: at walls, opposite or beside others, or in the middle of a room."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from jaxtyping import Bool

from home_procgen.floor_plan.placed import FACING, Box, PlacedFurniture, quarter_towards
from home_procgen.floor_plan.rooms import Rect, Wall
from home_procgen.floor_plan.walls import FLOOR_TOP, HALF
from home_procgen.furnish.space.occupied import TOLERANCE, Boxes, apart, hull, meet
from home_procgen.furnish.space.room import Companions, Room, alone
from home_procgen.furnish.space.touching import touching
from home_procgen.furnish.space.turned import askew

GAP = 0.01  # [m], between furniture and a wall
CORE = 3  # number of an object's largest boxes that are tested first
MOST = 50  # maximum number of places to try for an object with companions
HUNG = 0.0015  # [m], between a hanging object and its wall

Spot = tuple[float, float, float, int]  # x, y, z [m] and quarter turns
Place = Callable[[PlacedFurniture], PlacedFurniture | None]


def fit(room: Room, kind: str, place: Place) -> PlacedFurniture | None:
    """Place an object of the favourite model of a kind, or else of a small one that fits; None if none fits."""
    return next((placed for item in room.options(kind) if (placed := place(item))), None)


def add(room: Room, kind: str, front: float = 0.0, probability: float = 1.0) -> PlacedFurniture | None:
    """Place an object of a kind against a wall with a probability; None if it is not placed.

    Args:
        room: The room.
        kind: Kind of the object.
        front: Depth of the floor in front of it that stays free [m].
        probability: Probability of an attempt.
    """
    if not room.chance(probability):
        return None
    return fit(room, kind, lambda item: against_wall(room, item, front))


def zone_before(item: PlacedFurniture, depth: float) -> Box:
    """Return the box of the floor in front of an object, of a depth and the object's width [m]."""
    x, z = item.beside(0.0, float(item.size[2]) / 2 + depth / 2)
    half = np.array([item.size[0] / 2 - 0.02, depth / 2 - 0.02])[:: 1 if item.quarter % 2 == 0 else -1]
    return np.array([[x - half[0], FLOOR_TOP + 0.03, z - half[1]], [x + half[0], 1.2, z + half[1]]])


def place(
    room: Room, item: PlacedFurniture, front: float = 0.0, companions: Companions = alone, views: bool = True
) -> PlacedFurniture | None:
    """Place an object at its position, with its companions and a free zone in front of it; None if they do not fit."""
    zones = [zone_before(item, front)] if front else []
    if companions is alone:
        return item if room.put([item], zones, views) else None
    if room.solid.meets(np.concatenate([hull(item), *(zone[None] for zone in zones)])):
        return None
    group = [item]
    for one in companions(item):  # one by one: building them takes longer than a test that fails at the first
        if room.solid.meets(hull(one)) or room.clear.meets(hull(one)):
            return None
        group.append(one)
    return item if room.put(group, zones, views) else None


def first(
    room: Room,
    item: PlacedFurniture,
    spots: Sequence[Spot],
    front: float = 0.0,
    companions: Companions = alone,
    views: bool = True,
) -> PlacedFurniture | None:
    """Place an object at the first spot at which it and its companions fit; None if no spot fits."""
    if not len(spots):
        return None
    turned = {quarter: hull(item.at(0.0, 0.0, 0.0, quarter)) for quarter in {spot[3] for spot in spots}}
    for index in _unblocked(room, spots, turned):
        x, y, z, quarter = spots[index]
        if room.solid.meets(turned[quarter] + (x, y, z)):
            continue
        if placed := place(room, item.at(x, y, z, quarter), front, companions, views):
            return placed
    return None


def _unblocked(room: Room, spots: Sequence[Spot], turned: Mapping[int, Boxes]) -> list[int]:
    """Return the indices of spots at which the largest boxes of an object overlap no solid or reserved box."""
    order = list(turned)
    cores = np.stack([_core(turned[quarter]) for quarter in order])
    at = np.array(spots)
    turns = np.array([order.index(spot[3]) for spot in spots]) if len(order) > 1 else np.zeros(len(spots), np.int64)
    places = np.ascontiguousarray(at[:, :3])
    return np.flatnonzero(touching().free(places, turns, cores, room.taken, TOLERANCE)).tolist()


def _core(boxes: Boxes) -> Boxes:
    """Return the `CORE` largest boxes of an object."""
    return boxes if len(boxes) == 1 else boxes[np.argsort(-(boxes[:, 1] - boxes[:, 0]).prod(axis=1))[:CORE]]


def backed(item: PlacedFurniture, wall: Wall, along: float, y: float = FLOOR_TOP, gap: float = GAP) -> PlacedFurniture:
    """Return an object with its back to a wall, its middle at a coordinate along the wall."""
    return item.at(*at_wall(item, wall, [along], y, gap)[0])


def at_wall(
    item: PlacedFurniture, wall: Wall, along: Sequence[float], y: float = FLOOR_TOP, gap: float = GAP
) -> list[Spot]:
    """Return the spots of an object with its back to a wall, its middle at the given coordinates along the wall."""
    off = wall.line + float(wall.normal[1 - wall.axis]) * (HALF + gap + float(item.size[2]) / 2)
    quarter = quarter_towards(*wall.normal)
    return [(a, y, off, quarter) if wall.axis == 0 else (off, y, a, quarter) for a in along]


def along_walls(
    room: Room, item: PlacedFurniture, y: float = FLOOR_TOP, gap: float = GAP, step: float = 0.25
) -> tuple[list[Spot], Bool[np.ndarray, " n"]]:
    """Return the spots of an object at the walls of a room, and a mask of those in corners."""
    spots: list[Spot] = []
    corner: list[bool] = []
    for wall in room.plan.walls:
        inset = HALF + GAP + float(item.size[0]) / 2
        low, high = wall.span[0] + inset, wall.span[1] - inset
        if high >= low:
            each = (high - low) / (count := int((high - low) / step) + 1)
            places = [*(low + each * i for i in range(count)), high]
            spots += at_wall(item, wall, places, y, gap)
            corner += [i in (0, len(places) - 1) for i in range(len(places))]
    return spots, np.array(corner, bool)


def against_wall(
    room: Room,
    item: PlacedFurniture,
    front: float = 0.0,
    companions: Companions = alone,
    corners: float = 0.6,
) -> PlacedFurniture | None:
    """Place an object with its back to a random wall, with a preference for or against corners; None without a fit.

    Args:
        room: The room.
        item: The object.
        front: Depth of the floor in front of it that stays free [m].
        companions: Returns further objects that must fit together with it.
        corners: Factor on the random rank of corners; below 1, corners come earlier, above 1 later.
    """
    spots, corner = along_walls(room, item)
    order = np.argsort(room.rng.random(len(spots)) * np.where(corner, corners, 1.0), kind="stable")
    return first(room, item, [spots[i] for i in order.tolist()], front, companions)


def freely(
    room: Room,
    item: PlacedFurniture,
    companions: Companions = alone,
    quarters: Iterable[int] = (0, 1),
    around: float = 0.0,
) -> PlacedFurniture | None:
    """Place an object anywhere on the floor, parallel to the axes; None if it does not fit.

    Args:
        room: The room.
        item: The object.
        companions: Returns further objects that must fit together with it.
        quarters: Allowed quarter turns.
        around: Width of the free space around it, for its companions [m].
    """
    x, z = np.meshgrid(room.grid.x[3:-3:3], room.grid.z[3:-3:3], indexing="ij")
    points, turns = np.stack([x.ravel(), z.ravel()], axis=-1).tolist(), list(quarters)
    spots: list[Spot] = [(px, FLOOR_TOP, pz, q) for px, pz in points for q in turns]
    if around and spots:
        margin = np.array([[-around, 0.0, -around], [around, 0.0, around]])
        whole = {q: (item.at(0.0, 0.0, 0.0, q).box + margin)[None] for q in turns}
        spots = [spots[i] for i in _unblocked(room, spots, whole)]
    order = room.rng.permutation(len(spots)).tolist()
    return first(room, item, [spots[i] for i in (order[:MOST] if around else order)], 0.0, companions)


def somewhere(room: Room, inset: float) -> tuple[float, float, Rect]:
    """Return a random point in one of the rectangles of a room, and the rectangle.

    Args:
        room: The room.
        inset: Minimum distance to the rectangle's sides [m]; a narrower rectangle has its points on the middle line.
    """
    rect = room.plan.rects[int(room.rng.integers(len(room.plan.rects)))]
    half = np.array(rect.sides) / 2
    x, z = room.rng.uniform(-1, 1, 2) * np.maximum(half - inset, 0.0) + np.array([rect.x0, rect.z0]) + half
    return float(x), float(z), rect


def scattered(room: Room, kind: str, tries: int = 6) -> PlacedFurniture | None:
    """Place a small object anywhere on the floor at a random angle; None if it does not fit."""
    for _ in range(tries):
        x, z, _ = somewhere(room, 0.3)
        item = askew(room.object(kind).at(x, FLOOR_TOP, z), float(room.rng.uniform(-np.pi, np.pi)))
        if placed := place(room, item):
            return placed
    return None


def next_to(room: Room, anchor: PlacedFurniture, item: PlacedFurniture, side: int) -> PlacedFurniture | None:
    """Place an object beside another, their backs in line: -1 on its left, 1 on its right; None if it does not fit."""
    right = side * float(anchor.size[0] / 2 + item.size[0] / 2 + 0.03)
    x, z = anchor.beside(right, float(item.size[2] - anchor.size[2]) / 2)
    return place(room, item.at(x, FLOOR_TOP, z, anchor.quarter))


def reach(room: Room, x: float, z: float, way: tuple[int, int], most: float = 8.0) -> float:
    """Return the distance from a point to the end of the room in a direction, at most `most` [m]."""
    far = np.arange(0.0, most, 0.05)
    out = [not room.inside(x + way[0] * d, z + way[1] * d) for d in far.tolist()]
    return float(far[int(np.argmax(out))]) if any(out) else most


def ahead(item: PlacedFurniture) -> tuple[int, int]:
    """Return the direction (x, z) of an object's front."""
    return FACING[item.quarter]


def clear_of(item: PlacedFurniture, others: Iterable[PlacedFurniture]) -> bool:
    """Return whether an object overlaps none of the others."""
    return not any(meet(hull(item), hull(other)) for other in others if not apart(item, other))
