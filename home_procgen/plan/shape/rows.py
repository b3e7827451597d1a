"""Rows of rooms along a hall: each has a front on the hall, small ones may stand before a nook of their neighbour."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.needs.room_program import ROOMY, SMALL, WANTS

STEP = 0.1  # [m], grid of the wall lines
NOOK = 1.5  # [m], least depth of a nook
LEAST_SCALE, MOST_SCALE = 0.78, 1.3  # of widths, so that a row fills its length
LEAST_AREA, MOST_AREA = 0.78, 1.4  # times what a type wants
FOYER = "Foyer"  # a part of the hall that reaches to the outer wall


class Cell(NamedTuple):
    """What stands in a row: a room, or a foyer."""

    type: str
    area: float  # [m^2]


class Stack(NamedTuple):
    """A small room with a nook of its neighbour behind it."""

    host: int
    width: float  # [m]
    front: float  # [m], depth of the small room


Placed = tuple[str, tuple[Rect, ...]]


def snap(value: float) -> float:
    """The nearest point of the grid [m]."""
    return round(round(value / STEP) * STEP, 6)


@dataclass(frozen=True)
class Row:
    """A row of rooms.

    Attributes:
        axis: 0 if its rooms follow one another along x, 1 along z.
        sign: Of the direction across, away from the hall.
        base: Coordinate of the hall's edge across [m].
        low: Where it begins along its axis [m].
        high: Where it ends.
        depth: Across [m].
        step: From where to where along its axis the depth is another one, and that depth; None if it is the same all
            along.
    """

    axis: int
    sign: int
    base: float
    low: float
    high: float
    depth: float
    step: tuple[float, float, float] | None = None

    def rect(self, a: float, b: float, near: float, far: float) -> Rect:
        """The rectangle between two places along the row and two depths [m]."""
        p, q = sorted((snap(self.base + self.sign * near), snap(self.base + self.sign * far)))
        a, b = snap(a), snap(b)
        return Rect(a, p, b, q) if self.axis == 0 else Rect(p, a, q, b)

    def rects(self, a: float, b: float, near: float = 0.0) -> tuple[Rect, ...]:
        """The rectangles between two places along the row, from a depth on to the row's end [m]."""
        return tuple(self.rect(low, high, near, depth) for low, high, depth in self._parts(a, b))

    def _parts(self, a: float, b: float) -> Iterator[tuple[float, float, float]]:
        """The parts of a range with one depth each."""
        start, end, depth = self.step or (self.high, self.high, self.depth)
        for low, high, deep in ((-math.inf, start, self.depth), (start, end, depth), (end, math.inf, self.depth)):
            if min(b, high) - max(a, low) > STEP / 2:
                yield max(a, low), min(b, high), deep

    def least_depth(self, a: float, b: float) -> float:
        """Between two places along it [m]."""
        return min(depth for _, _, depth in self._parts(a, b))

    def with_ends(self, low: float, high: float) -> "Row":
        """The same row between other ends [m]."""
        return replace(self, low=low, high=high)


def suits(kind: str, width: float, depth: float) -> bool:
    """Whether a rectangle serves as a room of a type [m]."""
    if kind == FOYER:
        return width > 1.3
    want, (short, long) = WANTS[kind], sorted((width, depth))
    return (
        short >= want.side - 1e-6
        and long <= want.aspect * short + 1e-6
        and LEAST_AREA * want.low <= width * depth <= MOST_AREA * want.high
    )


def widths(cells: Sequence[Cell], depth: float) -> tuple[list[float], Mapping[int, Stack]]:
    """The widths that cells of a row want [m], and which stand before a nook of which neighbour."""
    stacks = _stacks(cells, depth)
    backs = {stack.host: stack.width * (depth - stack.front) for stack in stacks.values()}  # one each
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
    """The rooms of a row, from its low to its high end; None if they do not fill it as rooms should.

    Args:
        row: Where.
        cells: What, in order.
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
