"""Floor plans: which rooms a house has, and how they share its rectangle.

A rectangle is cut recursively into one piece per room, in proportion to the areas wanted; further pieces are merged
with a neighbour into an L-shaped room, or left outside so that the house itself is L-shaped.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.rooms import LINE_TOLERANCE, Rect, RoomPlan

STEP = 0.1  # [m], grid of the wall lines
MIN_JOINT = 1.3  # [m], narrowest passage inside an L-shaped room


class Want(NamedTuple):
    """The size and shape that a type of room needs."""

    low: float  # [m^2]
    high: float
    side: float  # [m], shortest side
    aspect: float  # longest side over shortest


WANTS = {
    "Living_Room": Want(18, 30, 3.4, 2.0),
    "Kitchen": Want(9, 15, 2.5, 2.0),
    "Dining_Room": Want(11, 17, 2.9, 1.8),
    "Bedroom": Want(12, 18, 2.9, 1.8),
    "Child_Room": Want(10, 14, 2.6, 1.8),
    "Guest_Room": Want(10, 14, 2.6, 1.8),
    "Office": Want(8, 13, 2.4, 1.9),
    "Bathroom": Want(5, 8.5, 1.9, 2.2),
    "Toilet": Want(2.6, 4, 1.4, 2.2),
    "Hallway": Want(6, 12, 1.5, 5.0),
    "Storage": Want(3, 6, 1.5, 2.4),
    "Wardrobe": Want(3.5, 6, 1.6, 2.4),
}
_CORE = ("Living_Room", "Bathroom", "Bedroom", "Kitchen")
_MORE = ("Bedroom", "Child_Room", "Office", "Dining_Room", "Toilet", "Guest_Room", "Storage", "Wardrobe")
_NOOK = Want(4, 9, 1.6, 2.5)  # a piece that makes its neighbour L-shaped
_YARD = Want(6, 16, 2.0, 3.0)  # a corner that stays outside
_ROOMY = ("Living_Room", "Kitchen", "Bedroom", "Hallway", "Dining_Room")  # may take a nook


def draw_rooms(
    rng: np.random.Generator, types: Sequence[str], origin: tuple[float, float]
) -> tuple[RoomPlan, ...] | None:
    """One attempt at a floor plan; None if it fails.

    Args:
        rng: Source of randomness.
        types: Types of the rooms.
        origin: Corner of the house with the smallest x and z [m].
    """
    extras = [_NOOK] * int(rng.random() < 0.6) + [_YARD] * int(rng.random() < 0.35)
    wants = [*(WANTS[name] for name in types), *extras]
    areas = np.array([rng.uniform(want.low, want.high) for want in wants])
    width = _snap(np.sqrt(areas.sum() * rng.uniform(0.7, 1.4)))
    house = Rect(*origin, _snap(origin[0] + width), _snap(origin[1] + areas.sum() / width))
    pieces = subdivide(rng, house, list(range(len(wants))), wants, areas)
    if pieces is None:
        return None
    rooms = [RoomPlan(name, (pieces[i],)) for i, name in enumerate(types)]
    for i, want in enumerate(extras, len(types)):
        if want is _YARD and not _at_corner(pieces[i], house):
            return None
        if want is _NOOK and not _merge(rng, rooms, pieces[i]):
            return None
    return tuple(rooms)


def draw_types(rng: np.random.Generator) -> list[str]:
    """Types of 3 to 8 rooms; small flats have the core only, larger ones a hallway."""
    count = int(rng.choice([3, 4, 5, 6, 7, 8], p=[0.1, 0.18, 0.22, 0.22, 0.16, 0.12]))
    types: list[str] = [*_CORE[: min(count, 4)]]
    if count >= 5 and (count >= 7 or rng.random() < 0.7):
        types.append("Hallway")
    types += rng.permutation(_MORE)[: count - len(types)].tolist()
    return types


def subdivide(
    rng: np.random.Generator, rect: Rect, items: list[int], wants: Sequence[Want], areas: Float[np.ndarray, " n"]
) -> dict[int, Rect] | None:
    """Cuts a rectangle into one piece per item, in proportion to their areas and mostly across its longer side.

    Returns:
        Item -> piece, or None if a few tries gave no cut with which every piece is shaped as wanted.
    """
    if len(items) == 1:
        return {items[0]: rect} if _suits(rect, wants[items[0]]) else None
    for _ in range(4):
        items = rng.permutation(items).tolist()
        first = int(rng.integers(1, len(items)))
        share = areas[items[:first]].sum() / areas[items].sum()
        one, other = _cut(rect, float(share), across_longer=rng.random() < 0.85)
        left = subdivide(rng, one, items[:first], wants, areas)
        right = left and subdivide(rng, other, items[first:], wants, areas)
        if left and right:
            return left | right
    return None


def _cut(rect: Rect, share: float, across_longer: bool) -> tuple[Rect, Rect]:
    width, depth = rect.extents
    if (width > depth) == across_longer:
        x = _snap(rect.x0 + share * width)
        return rect._replace(x1=x), rect._replace(x0=x)
    z = _snap(rect.z0 + share * depth)
    return rect._replace(z1=z), rect._replace(z0=z)


def _snap(value: float) -> float:
    return round(float(round(value / STEP) * STEP), 6)


def _suits(rect: Rect, want: Want) -> bool:
    short, long = sorted(rect.extents)
    return short >= want.side - 1e-6 and long <= want.aspect * short


def _at_corner(rect: Rect, house: Rect) -> bool:
    return (rect.x0 == house.x0 or rect.x1 == house.x1) and (rect.z0 == house.z0 or rect.z1 == house.z1)


def _merge(rng: np.random.Generator, rooms: list[RoomPlan], nook: Rect) -> bool:
    """Gives a nook to one of the roomy neighbours with which it forms an L."""
    for i in rng.permutation(len(rooms)):
        merged = RoomPlan(rooms[i].type, (*rooms[i].rects, nook))
        if rooms[i].type in _ROOMY and len(rooms[i].rects) == 1 and _is_l(rooms[i].rects[0], nook, merged):
            rooms[i] = merged
            return True
    return False


def _is_l(rect: Rect, nook: Rect, merged: RoomPlan) -> bool:
    """Whether two rectangles touch along a joint that is wide enough and their union has six corners."""
    across = min(rect.x1, nook.x1) - max(rect.x0, nook.x0), min(rect.z1, nook.z1) - max(rect.z0, nook.z0)
    touching = min(across) > -LINE_TOLERANCE and max(across) >= MIN_JOINT
    return touching and len(merged.polygon) == 6 and min(wall.length for wall in merged.walls) >= 0.7
