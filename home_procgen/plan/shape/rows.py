"""Rows of rooms along a hall: each room has a front on the hall; small ones may have a neighbour's nook behind them."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.needs.room_program import ROOMY, SMALL, WANTS

STEP = 0.1  # [m], grid of the wall lines
NOOK = 1.5  # [m], minimum depth of a nook
LEAST_SCALE, MOST_SCALE = 0.78, 1.3  # range of the scale of widths with which a row fills its length
LEAST_AREA, MOST_AREA = 0.78, 1.4  # range of the area, as a factor of the type's own range
FOYER = "Foyer"  # type of the part of the hall that reaches to the outer wall


class Cell(NamedTuple):
    """A cell of a row: a room, a foyer, or stairs."""

    type: str
    area: float  # requested area [m^2]


class Stack(NamedTuple):
    """A small room with a nook of its neighbour behind it."""

    host: int
    width: float  # [m], of the small room
    front: float  # [m], depth of the small room


Placed = tuple[str, tuple[Rect, ...]]


def snap(value: float) -> float:
    """Round a coordinate to the grid [m]."""
    return round(round(value / STEP) * STEP, 6)


@dataclass(frozen=True)
class Row:
    """A row of rooms.

    Attributes:
        axis: 0 if its rooms follow one another along x, 1 along z.
        sign: Sign of the direction across, away from the hall.
        base: Coordinate of the hall's edge across [m].
        low: Lower end along its axis [m].
        high: Upper end along its axis [m].
        depth: Extent across [m].
        step: Start, end and depth of a range along the axis with another depth [m]; None if the depth is constant.
    """

    axis: int
    sign: int
    base: float
    low: float
    high: float
    depth: float
    step: tuple[float, float, float] | None = None

    def rect(self, a: float, b: float, near: float, far: float) -> Rect:
        """Return the rectangle between two coordinates along the row and two depths [m]."""
        p, q = sorted((snap(self.base + self.sign * near), snap(self.base + self.sign * far)))
        a, b = snap(a), snap(b)
        return Rect(a, p, b, q) if self.axis == 0 else Rect(p, a, q, b)

    def rects(self, a: float, b: float, near: float = 0.0) -> tuple[Rect, ...]:
        """Return the rectangles between two coordinates along the row, from a depth to the row's outer edge [m]."""
        return tuple(self.rect(low, high, near, depth) for low, high, depth in self._parts(a, b))

    def _parts(self, a: float, b: float) -> Iterator[tuple[float, float, float]]:
        """Generate the parts of a range as start, end and depth [m]; each part has one depth."""
        start, end, depth = self.step or (self.high, self.high, self.depth)
        for low, high, deep in ((-math.inf, start, self.depth), (start, end, depth), (end, math.inf, self.depth)):
            if min(b, high) - max(a, low) > STEP / 2:
                yield max(a, low), min(b, high), deep

    def least_depth(self, a: float, b: float) -> float:
        """Return the minimum depth between two coordinates along the row [m]."""
        return min(depth for _, _, depth in self._parts(a, b))

    def with_ends(self, low: float, high: float) -> "Row":
        """Return the same row with other ends [m]."""
        return replace(self, low=low, high=high)


def suits(kind: str, width: float, depth: float) -> bool:
    """Return whether a rectangle satisfies the requirements of a room type [m]."""
    if kind == FOYER:
        return width > 1.3
    want, (short, long) = WANTS[kind], sorted((width, depth))
    return (
        short >= want.side - 1e-6
        and long <= want.aspect * short + 1e-6
        and LEAST_AREA * want.low <= width * depth <= MOST_AREA * want.high
    )


def widths(cells: Sequence[Cell], depth: float) -> tuple[list[float], Mapping[int, Stack]]:
    """Return the widths of a row's cells [m], and the stacks of small rooms by cell index."""
    stacks = _stacks(cells, depth)
    backs = {stack.host: stack.width * (depth - stack.front) for stack in stacks.values()}  # each host has at most one
    found = []
    for i, cell in enumerate(cells):
        side = 1.5 if cell.type == FOYER else WANTS[cell.type].side
        found.append(stacks[i].width if i in stacks else max((cell.area - backs.get(i, 0.0)) / depth, side))
    return found, stacks


def _stacks(cells: Sequence[Cell], depth: float) -> dict[int, Stack]:
    found: dict[int, Stack] = {}
    for i, cell in enumerate(cells):
        if cell.type not in SMALL:
            continue
        width = snap(min(max(math.sqrt(0.75 * cell.area), WANTS[cell.type].side), 2.0))
        front = snap(cell.area / width)
        if depth - front < NOOK:
            continue
        hosts = {stack.host for stack in found.values()}
        beside = (j for j in (i - 1, i + 1) if 0 <= j < len(cells) and cells[j].type in ROOMY and j not in hosts)
        if (host := next(beside, None)) is not None:
            found[i] = Stack(host, width, front)
    return found


def lay(row: Row, cells: Sequence[Cell]) -> list[Placed] | None:
    """Place the cells in a row from its lower to its upper end; None if they violate the limits of scale or of rooms.

    Args:
        row: The row.
        cells: Its cells in order.
    """
    if not cells:
        return [] if row.high - row.low < STEP else None
    wide, stacks = widths(cells, row.depth)
    fixed = sum(w for i, w in enumerate(wide) if i in stacks or cells[i].type == FOYER)
    free = sum(wide) - fixed
    if free <= 0:
        return None
    scale = (row.high - row.low - fixed) / free
    if not LEAST_SCALE <= scale <= MOST_SCALE:
        return None
    scaled = [w if i in stacks or cells[i].type == FOYER else w * scale for i, w in enumerate(wide)]
    edges = [snap(row.low + at) for at in (0.0, *itertools.accumulate(scaled[:-1]))] + [snap(row.high)]
    return _rooms(row, cells, edges, stacks)


def _rooms(row: Row, cells: Sequence[Cell], edges: Sequence[float], stacks: Mapping[int, Stack]) -> list[Placed] | None:
    nooks: dict[int, tuple[Rect, ...]] = {}
    found: list[Placed] = []
    for i, (cell, a, b) in enumerate(zip(cells, edges, edges[1:], strict=False)):
        depth = row.least_depth(a, b)
        if i in stacks:
            if depth - stacks[i].front < NOOK or not suits(cell.type, b - a, stacks[i].front):
                return None
            found.append((cell.type, (row.rect(a, b, 0.0, stacks[i].front),)))
            nooks[stacks[i].host] = row.rects(a, b, stacks[i].front)
        elif suits(cell.type, b - a, depth):
            found.append((cell.type, row.rects(a, b)))
        else:
            return None
    return [(kind, (*rects, *nooks.get(i, ()))) for i, (kind, rects) in enumerate(found)]
