"""Placement in corners: with two backs at two walls, or with the back across the corner."""

from collections.abc import Callable, Iterator

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_to
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan
from home_procgen.floor_plan.walls import FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.space.collision_boxes import collision_boxes
from home_procgen.furnish.space.floor_placement import (
    WALL_GAP,
    Spot,
    place_at_first,
    place_first_fitting,
    place_object,
    wall_spots,
)
from home_procgen.furnish.space.room_space import Companions, RoomSpace, no_companions

CORNER_TOLERANCE = 1e-6


def _corners(plan: RoomPlan) -> Iterator[tuple[PlanWall, int]]:
    """Generate each wall with each of its ends that is a convex corner (-1: the lower coordinate, 1: the higher)."""
    for wall in plan.walls:
        for end in (-1, 1):
            along = wall.span[(end + 1) // 2]
            if any(_is_convex_corner(wall, along, other) for other in plan.walls):
                yield wall, end


def _is_convex_corner(wall: PlanWall, along: float, other: PlanWall) -> bool:
    """Return whether another wall begins at the end of a wall, at `along`, and continues on the room's side of it."""
    if other.axis == wall.axis or abs(other.line - along) > CORNER_TOLERANCE:
        return False
    reach = np.subtract(other.span, wall.line) * float(wall.normal[1 - wall.axis])
    return bool(abs(reach).min() < CORNER_TOLERANCE and reach.max() > CORNER_TOLERANCE)


def corner_spots(room: RoomSpace, item: PlacedModel, y: float = FLOOR_TOP, gap: float = WALL_GAP) -> list[Spot]:
    """Return the corner spots of an object, with its back at one wall and its left side at another (right if mirrored).

    Args:
        room: The room.
        item: The object; its model's corner is at the back left.
        y: Height of its bottom [m].
        gap: Gap between it and the walls [m].
    """
    spots: list[Spot] = []
    inset = PRISM_THICKNESS + gap + float(item.size[0]) / 2
    for wall, end in _corners(room.plan):
        along = wall.span[(end + 1) // 2] - end * inset
        spot = wall_spots(item, wall, [along], y, gap)[0]
        side = item.moved_to(*spot).local_point(1.0 if item.mirrored else -1.0, 0.0)
        if (side[wall.axis] - (spot[0], spot[2])[wall.axis]) * end > 0:
            spots.append(spot)
    return spots


def place_in_corner(
    room: RoomSpace, item: PlacedModel, front: float = 0.0, companions: Companions = no_companions, y: float = FLOOR_TOP
) -> PlacedModel | None:
    """Place an object made for corners in a random corner; None if it does not fit.

    Args:
        room: The room.
        item: The object.
        front: Depth of the floor in front of it that stays free [m].
        companions: Returns further objects that must fit together with it.
        y: Height of its bottom [m].
    """
    spots = corner_spots(room, item, y)
    order = room.rng.permutation(len(spots)).tolist()
    return place_at_first(room, item, [spots[i] for i in order], front, companions)


def place_across_corner(
    room: RoomSpace, item: PlacedModel, companions: Companions = no_companions, gap: float = WALL_GAP
) -> PlacedModel | None:
    """Place an object with its back across a corner, as close to both walls as its boxes allow; None if none fits."""
    found = [(wall, end) for wall, end in _corners(room.plan) if wall.axis == 0]
    for index in room.rng.permutation(len(found)).tolist():
        wall, end = found[index]
        ways = np.array([-end, float(wall.normal[1])])  # (x, z), into the room
        plain = yaw_to(item, 0.0, 0.0, 0.0, float(np.arctan2(*ways)))
        boxes = collision_boxes(plain)[..., [0, 2]]
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        corner = np.array([wall.span[(end + 1) // 2], wall.line])
        x, z = (corner + ways * (PRISM_THICKNESS + gap + np.where(ways > 0, -low, high))).tolist()
        if placed := place_object(room, yaw_to(item, x, FLOOR_TOP, z, float(np.arctan2(*ways))), 0.0, companions):
            return placed
    return None


def add_in_corner(
    room: RoomSpace,
    kind: str,
    probability: float,
    place: Callable[[RoomSpace, PlacedModel], PlacedModel | None] = place_in_corner,
) -> PlacedModel | None:
    """Place an object of a kind in a corner with a probability; None if it is not placed."""
    if not room.draw_chance(probability):
        return None
    return place_first_fitting(room, kind, lambda item: place(room, item))
