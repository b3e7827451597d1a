"""Placement on the floor: at walls, opposite or beside others, or in the middle of a room."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from jaxtyping import Bool

from home_procgen.floor_plan.placed_model import FRONT_DIRECTIONS, Box, PlacedModel, quarter_towards, yaw_by
from home_procgen.floor_plan.rooms import PlanWall, Rect
from home_procgen.floor_plan.walls import FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.space.collision_boxes import (
    MAX_TOUCH_OVERLAP,
    Boxes,
    are_disjoint,
    boxes_overlap,
    collision_boxes,
)
from home_procgen.furnish.space.overlap_kernels import overlap_kernels
from home_procgen.furnish.space.room_space import Companions, RoomSpace, no_companions

WALL_GAP = 0.01  # [m], between furniture and a wall
NUM_CORE_BOXES = 3  # number of an object's largest boxes that are tested first
MAX_PLACES = 50  # maximum number of places to try for an object with companions
HANGING_GAP = 0.0015  # [m], between a hanging object and its wall

VIEWED_CLASSES = ("picture_frame", "mirror", "clock", "television", "whiteboard")  # seen from the front
MIN_VIEWED_HEIGHT = 0.3  # [m], height above the floor above which such an object hangs on a wall, or
STANDING_FAMILIES = ("photo", "table_clock")  # stands on furniture
VIEW_DEPTH = 0.45  # [m], depth of the space in front of it that stays free of furniture and open doors
VIEW_INSET = 0.03  # [m], from its lower and upper edge to that space

Spot = tuple[float, float, float, int]  # x, y, z [m] and quarter turns
PlaceFn = Callable[[PlacedModel], PlacedModel | None]


def place_first_fitting(room: RoomSpace, kind: str, place: PlaceFn) -> PlacedModel | None:
    """Place an object of the favourite model of a kind, or else of a small one that fits; None if none fits."""
    return next((placed for item in room.object_candidates(kind) if (placed := place(item))), None)


def add_at_wall(room: RoomSpace, kind: str, front: float = 0.0, probability: float = 1.0) -> PlacedModel | None:
    """Place an object of a kind against a wall with a probability; None if it is not placed.

    Args:
        room: The room.
        kind: Kind of the object.
        front: Depth of the floor in front of it that stays free [m].
        probability: Probability of an attempt.
    """
    if not room.draw_chance(probability):
        return None
    return place_first_fitting(room, kind, lambda item: place_against_wall(room, item, front))


def front_zone(item: PlacedModel, depth: float) -> Box:
    """Return the box in front of an object, of a depth and the object's width, from the floor to 1.2 m [m]."""
    x, z = item.local_point(0.0, float(item.size[2]) / 2 + depth / 2)
    half = np.array([item.size[0] / 2 - 0.02, depth / 2 - 0.02])[:: 1 if item.quarter % 2 == 0 else -1]
    return np.array([[x - half[0], FLOOR_TOP + 0.03, z - half[1]], [x + half[0], 1.2, z + half[1]]])


def view_zone(item: PlacedModel, depth: float) -> Box:
    """Return the space in front of an object on a wall, of a depth and the object's width and height [m]."""
    zone = front_zone(item, depth)
    zone[:, 1] = item.box[:, 1] + (VIEW_INSET, -VIEW_INSET)
    return zone


def place_object(
    room: RoomSpace, item: PlacedModel, front: float = 0.0, companions: Companions = no_companions, views: bool = True
) -> PlacedModel | None:
    """Place an object at its position, with its companions and a free zone in front of it; None if they do not fit."""
    zones = [front_zone(item, front)] if front else []
    if companions is no_companions:
        return item if room.try_place([item], zones, views, _views_of(item)) else None
    if room.solid.overlaps_any(np.concatenate([collision_boxes(item), *(zone[None] for zone in zones)])):
        return None
    group = [item]
    for one in companions(item):  # one by one: building them takes longer than a test that fails at the first
        if room.solid.overlaps_any(collision_boxes(one)) or room.clear.overlaps_any(collision_boxes(one)):
            return None
        group.append(one)
    return item if room.try_place(group, zones, views) else None


def _views_of(item: PlacedModel) -> list[Box]:
    """Return the space in front of a picture, mirror or clock on a wall, to be kept free; empty for other objects."""
    hangs = item.model.fine in VIEWED_CLASSES and item.box[0, 1] > FLOOR_TOP + MIN_VIEWED_HEIGHT
    return [view_zone(item, VIEW_DEPTH)] if hangs and item.model.family not in STANDING_FAMILIES else []


def place_at_first(
    room: RoomSpace,
    item: PlacedModel,
    spots: Sequence[Spot],
    front: float = 0.0,
    companions: Companions = no_companions,
    views: bool = True,
) -> PlacedModel | None:
    """Place an object at the first spot at which it and its companions fit; None if no spot fits."""
    if not len(spots):
        return None
    turned = {
        quarter: collision_boxes(item.moved_to(0.0, 0.0, 0.0, quarter)) for quarter in {spot[3] for spot in spots}
    }
    for index in _free_spots(room, spots, turned):
        x, y, z, quarter = spots[index]
        if room.solid.overlaps_any(turned[quarter] + (x, y, z)):
            continue
        if placed := place_object(room, item.moved_to(x, y, z, quarter), front, companions, views):
            return placed
    return None


def _free_spots(room: RoomSpace, spots: Sequence[Spot], turned: Mapping[int, Boxes]) -> list[int]:
    """Return the indices of spots at which the largest boxes of an object overlap no solid or reserved box."""
    order = list(turned)
    cores = np.stack([_largest_boxes(turned[quarter]) for quarter in order])
    at = np.array(spots)
    turns = np.array([order.index(spot[3]) for spot in spots]) if len(order) > 1 else np.zeros(len(spots), np.int64)
    places = np.ascontiguousarray(at[:, :3])
    return np.flatnonzero(
        overlap_kernels().free_mask(places, turns, cores, room.blocked_boxes, MAX_TOUCH_OVERLAP)
    ).tolist()


def _largest_boxes(boxes: Boxes) -> Boxes:
    """Return the at most `NUM_CORE_BOXES` largest boxes of an object by volume."""
    return boxes if len(boxes) == 1 else boxes[np.argsort(-(boxes[:, 1] - boxes[:, 0]).prod(axis=1))[:NUM_CORE_BOXES]]


def back_against(
    item: PlacedModel, wall: PlanWall, along: float, y: float = FLOOR_TOP, gap: float = WALL_GAP
) -> PlacedModel:
    """Return an object, not placed yet, with its back to a wall, its middle at a coordinate along the wall [m]."""
    return item.moved_to(*wall_spots(item, wall, [along], y, gap)[0])


def wall_spots(
    item: PlacedModel, wall: PlanWall, along: Sequence[float], y: float = FLOOR_TOP, gap: float = WALL_GAP
) -> list[Spot]:
    """Return the spots of an object with its back to a wall, its middle at given coordinates along the wall [m]."""
    off = wall.line + float(wall.normal[1 - wall.axis]) * (PRISM_THICKNESS + gap + float(item.size[2]) / 2)
    quarter = quarter_towards(*wall.normal)
    return [(a, y, off, quarter) if wall.axis == 0 else (off, y, a, quarter) for a in along]


def room_wall_spots(
    room: RoomSpace, item: PlacedModel, y: float = FLOOR_TOP, gap: float = WALL_GAP, step: float = 0.25
) -> tuple[list[Spot], Bool[np.ndarray, " n"]]:
    """Return the spots of an object at a room's walls, at most `step` apart [m], and a mask of those in corners."""
    spots: list[Spot] = []
    corner: list[bool] = []
    for wall in room.plan.walls:
        inset = PRISM_THICKNESS + WALL_GAP + float(item.size[0]) / 2
        low, high = wall.span[0] + inset, wall.span[1] - inset
        if high >= low:
            each = (high - low) / (count := int((high - low) / step) + 1)
            places = [*(low + each * i for i in range(count)), high]
            spots += wall_spots(item, wall, places, y, gap)
            corner += [i in (0, len(places) - 1) for i in range(len(places))]
    return spots, np.array(corner, bool)


def place_against_wall(
    room: RoomSpace,
    item: PlacedModel,
    front: float = 0.0,
    companions: Companions = no_companions,
    corners: float = 0.6,
) -> PlacedModel | None:
    """Place an object with its back to a random wall, with a preference for or against corners; None without a fit.

    Args:
        room: The room.
        item: The object.
        front: Depth of the floor in front of it that stays free [m].
        companions: Returns further objects that must fit together with it.
        corners: Factor on the random rank of corners; below 1, corners come earlier, above 1 later.
    """
    spots, corner = room_wall_spots(room, item)
    order = np.argsort(room.rng.random(len(spots)) * np.where(corner, corners, 1.0), kind="stable")
    return place_at_first(room, item, [spots[i] for i in order.tolist()], front, companions)


def place_freely(
    room: RoomSpace,
    item: PlacedModel,
    companions: Companions = no_companions,
    quarters: Iterable[int] = (0, 1),
    around: float = 0.0,
) -> PlacedModel | None:
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
        whole = {q: (item.moved_to(0.0, 0.0, 0.0, q).box + margin)[None] for q in turns}
        spots = [spots[i] for i in _free_spots(room, spots, whole)]
    order = room.rng.permutation(len(spots)).tolist()
    return place_at_first(room, item, [spots[i] for i in (order[:MAX_PLACES] if around else order)], 0.0, companions)


def random_point(room: RoomSpace, inset: float) -> tuple[float, float, Rect]:
    """Return a random point x, z in one of the rectangles of a room [m], and the rectangle.

    Args:
        room: The room.
        inset: Minimum distance to the rectangle's sides [m]; a narrower rectangle has its points on the middle line.
    """
    rect = room.plan.rects[int(room.rng.integers(len(room.plan.rects)))]
    half = np.array(rect.extents) / 2
    x, z = room.rng.uniform(-1, 1, 2) * np.maximum(half - inset, 0.0) + np.array([rect.x0, rect.z0]) + half
    return float(x), float(z), rect


def scatter(room: RoomSpace, kind: str, tries: int = 6) -> PlacedModel | None:
    """Place an object of a kind anywhere on the floor at a random angle; None if it fits in none of `tries` places."""
    for _ in range(tries):
        x, z, _ = random_point(room, 0.3)
        item = yaw_by(room.draw_object(kind).moved_to(x, FLOOR_TOP, z), float(room.rng.uniform(-np.pi, np.pi)))
        if placed := place_object(room, item):
            return placed
    return None


def place_next_to(room: RoomSpace, anchor: PlacedModel, item: PlacedModel, side: int) -> PlacedModel | None:
    """Place an object beside another, their backs in line: -1 on its left, 1 on its right; None if it does not fit."""
    right = side * float(anchor.size[0] / 2 + item.size[0] / 2 + 0.03)
    x, z = anchor.local_point(right, float(item.size[2] - anchor.size[2]) / 2)
    return place_object(room, item.moved_to(x, FLOOR_TOP, z, anchor.quarter))


def free_distance(room: RoomSpace, x: float, z: float, way: tuple[int, int], max_distance: float = 8.0) -> float:
    """Return the distance from a point to the end of the room along a unit direction, at most `max_distance` [m]."""
    far = np.arange(0.0, max_distance, 0.05)
    out = [not room.contains(x + way[0] * d, z + way[1] * d) for d in far.tolist()]
    return float(far[int(np.argmax(out))]) if any(out) else max_distance


def front_direction(item: PlacedModel) -> tuple[int, int]:
    """Return the direction (x, z) of an object's front by its quarter turns, without the angle of a yawed object."""
    return FRONT_DIRECTIONS[item.quarter]


def is_clear_of(item: PlacedModel, others: Iterable[PlacedModel]) -> bool:
    """Return whether an object overlaps none of the others."""
    return not any(
        boxes_overlap(collision_boxes(item), collision_boxes(other))
        for other in others
        if not are_disjoint(item, other)
    )
