"""The layout of a room that may hold the place of stairs, or have no walls."""

import numpy as np

from home_mjx.datasets.homes.plan.storeys import Stairwell
from home_mjx.datasets.procedural.floor_plan.openings import HousePlan
from home_mjx.datasets.procedural.floor_plan.placed import Box
from home_mjx.datasets.procedural.floor_plan.walking import WalkingGrid
from home_mjx.datasets.procedural.furnish.layout import RoomLayout
from home_mjx.datasets.procedural.furnish.style import Style

ACCESS = 0.9  # [m], depth of the floor before stairs that stays free
BESIDE = 0.5  # [m], from the edge of stairs to the places that must be reached


class HomeLayout(RoomLayout):
    """A room that is being furnished.

    Args:
        plan: The storey.
        index: Which of its rooms.
        style: Of the home.
        stairs: The place of stairs in this room.
    """

    def __init__(self, plan: HousePlan, index: int, style: Style, stairs: Stairwell | None = None) -> None:
        super().__init__(plan, index, style)
        if stairs is None:
            return
        self._solid.append(_column(stairs, 0.0, plan.height))
        self._clear.append(_column(stairs, ACCESS, plan.height))
        ways = [o.placed.beside(0.0, side * 0.5) for o in plan.openings_of(index) if o.is_door for side in (-1, 1)]
        self._grid = WalkingGrid(self.room, self._solid, [*ways, *_landings(stairs)])


def _column(stairs: Stairwell, before: float, height: float) -> Box:
    """The space over a place of stairs and so far before it [m]."""
    x0, z0, x1, z1 = stairs.rect
    low, high = np.array([x0, 0.0, z0]), np.array([x1, height, z1])
    for axis, way in zip((0, 2), stairs.way, strict=True):
        low[axis] -= before * (way > 0)
        high[axis] += before * (way < 0)
    return np.stack([low, high])


def _landings(stairs: Stairwell) -> list[tuple[float, float]]:
    """Points before the foot and before the head of stairs."""
    middle = np.array([(stairs.rect.x0 + stairs.rect.x1) / 2, (stairs.rect.z0 + stairs.rect.z1) / 2])
    size, way = np.array(stairs.rect.sides), np.array(stairs.way, float)
    edge = middle - way * (size @ abs(way)) / 2
    aside = np.array([-way[1], way[0]]) * (size @ abs(way[::-1])) / 4
    points = [edge - BESIDE * way + side * aside for side in (-1, 1)]
    return [(float(x), float(z)) for x, z in points]
