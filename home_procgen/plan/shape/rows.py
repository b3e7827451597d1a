"""Rows of rooms along a hall: each room has a front on the hall; small ones may have a neighbour's nook behind them."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.shape.program import ROOM_REQUIREMENTS, ROOMY_TYPES, SMALL_TYPES

GRID_STEP = 0.1  # [m], grid of the wall lines
MIN_NOOK_DEPTH = 1.5  # [m], minimum depth of a nook
MIN_WIDTH_SCALE, MAX_WIDTH_SCALE = 0.78, 1.3  # range of the scale of widths with which a row fills its length
MIN_AREA_FACTOR, MAX_AREA_FACTOR = 0.78, 1.4  # range of the area, as a factor of the type's own range
FOYER = "Foyer"  # type of the part of the hall that reaches to the outer wall


class RowCell(NamedTuple):
    """A cell of a row: a room, a foyer, or stairs."""

    type: str
    area: float  # requested area [m^2]


class NookStack(NamedTuple):
    """A small room with a nook of its neighbour behind it."""

    host: int
    width: float  # [m], of the small room
    front: float  # [m], depth of the small room


PlacedRoom = tuple[str, tuple[Rect, ...]]


def snap_to_grid(value: float) -> float:
    """Round a coordinate to the nearest multiple of `GRID_STEP` [m]."""
    return round(round(value / GRID_STEP) * GRID_STEP, 6)


@dataclass(frozen=True)
class RoomRow:
    """A row of rooms.

    Attributes:
        axis: 0 if its rooms follow one another along x, 1 along z.
        sign: Sign of the direction across, away from the hall.
        base: Coordinate of the hall's edge across [m].
        start: Lower end along its axis [m].
        end: Upper end along its axis [m].
        depth: Extent across [m].
        step: Start, end and depth of a range along the axis with another depth [m]; None if the depth is constant.
    """

    axis: int
    sign: int
    base: float
    start: float
    end: float
    depth: float
    step: tuple[float, float, float] | None = None

    def rect(self, a: float, b: float, near: float, far: float) -> Rect:
        """Return the rectangle between two coordinates along the row and two depths from the hall's edge [m]."""
        p, q = sorted((snap_to_grid(self.base + self.sign * near), snap_to_grid(self.base + self.sign * far)))
        a, b = snap_to_grid(a), snap_to_grid(b)
        return Rect(a, p, b, q) if self.axis == 0 else Rect(p, a, q, b)

    def rects(self, a: float, b: float, near: float = 0.0) -> tuple[Rect, ...]:
        """Return the rectangles between two coordinates along the row, from a depth to the row's outer edge [m]."""
        return tuple(self.rect(low, high, near, depth) for low, high, depth in self._parts(a, b))

    def _parts(self, a: float, b: float) -> Iterator[tuple[float, float, float]]:
        """Generate the parts of a range as start, end and depth [m]; each part has one depth."""
        start, end, depth = self.step or (self.end, self.end, self.depth)
        for low, high, deep in ((-math.inf, start, self.depth), (start, end, depth), (end, math.inf, self.depth)):
            if min(b, high) - max(a, low) > GRID_STEP / 2:
                yield max(a, low), min(b, high), deep

    def min_depth(self, a: float, b: float) -> float:
        """Return the minimum depth between two coordinates along the row [m]."""
        return min(depth for _, _, depth in self._parts(a, b))

    def with_ends(self, start: float, end: float) -> "RoomRow":
        """Return the same row with other ends [m]."""
        return replace(self, start=start, end=end)


def is_suitable(kind: str, width: float, depth: float) -> bool:
    """Return whether a rectangle [m] meets a type's limits of sides and area; a foyer only needs a width of 1.3."""
    if kind == FOYER:
        return width > 1.3
    want, (short, long) = ROOM_REQUIREMENTS[kind], sorted((width, depth))
    return (
        short >= want.min_side - 1e-6
        and long <= want.max_aspect * short + 1e-6
        and MIN_AREA_FACTOR * want.min_area <= width * depth <= MAX_AREA_FACTOR * want.max_area
    )


def compute_widths(cells: Sequence[RowCell], depth: float) -> tuple[list[float], Mapping[int, NookStack]]:
    """Return the widths of a row's cells [m], and the stacks of small rooms by cell index."""
    stacks = _stacks(cells, depth)
    backs = {stack.host: stack.width * (depth - stack.front) for stack in stacks.values()}  # each host has at most one
    found = []
    for i, cell in enumerate(cells):
        side = 1.5 if cell.type == FOYER else ROOM_REQUIREMENTS[cell.type].min_side
        found.append(stacks[i].width if i in stacks else max((cell.area - backs.get(i, 0.0)) / depth, side))
    return found, stacks


def _stacks(cells: Sequence[RowCell], depth: float) -> dict[int, NookStack]:
    found: dict[int, NookStack] = {}
    for i, cell in enumerate(cells):
        if cell.type not in SMALL_TYPES:
            continue
        width = snap_to_grid(min(max(math.sqrt(0.75 * cell.area), ROOM_REQUIREMENTS[cell.type].min_side), 2.0))
        front = snap_to_grid(cell.area / width)
        if depth - front < MIN_NOOK_DEPTH:
            continue
        hosts = {stack.host for stack in found.values()}
        beside = (j for j in (i - 1, i + 1) if 0 <= j < len(cells) and cells[j].type in ROOMY_TYPES and j not in hosts)
        if (host := next(beside, None)) is not None:
            found[i] = NookStack(host, width, front)
    return found


def place_cells(row: RoomRow, cells: Sequence[RowCell]) -> list[PlacedRoom] | None:
    """Place the cells in a row from its lower to its upper end; None if they violate the limits of scale or of rooms.

    Args:
        row: The row.
        cells: Its cells in order.
    """
    if not cells:
        return [] if row.end - row.start < GRID_STEP else None
    wide, stacks = compute_widths(cells, row.depth)
    fixed = sum(w for i, w in enumerate(wide) if i in stacks or cells[i].type == FOYER)
    free = sum(wide) - fixed
    if free <= 0:
        return None
    scale = (row.end - row.start - fixed) / free
    if not MIN_WIDTH_SCALE <= scale <= MAX_WIDTH_SCALE:
        return None
    scaled = [w if i in stacks or cells[i].type == FOYER else w * scale for i, w in enumerate(wide)]
    edges = [snap_to_grid(row.start + at) for at in (0.0, *itertools.accumulate(scaled[:-1]))] + [snap_to_grid(row.end)]
    return _rooms(row, cells, edges, stacks)


def _rooms(
    row: RoomRow, cells: Sequence[RowCell], edges: Sequence[float], stacks: Mapping[int, NookStack]
) -> list[PlacedRoom] | None:
    nooks: dict[int, tuple[Rect, ...]] = {}
    found: list[PlacedRoom] = []
    for i, (cell, a, b) in enumerate(zip(cells, edges, edges[1:], strict=False)):
        depth = row.min_depth(a, b)
        if i in stacks:
            if depth - stacks[i].front < MIN_NOOK_DEPTH or not is_suitable(cell.type, b - a, stacks[i].front):
                return None
            found.append((cell.type, (row.rect(a, b, 0.0, stacks[i].front),)))
            nooks[stacks[i].host] = row.rects(a, b, stacks[i].front)
        elif is_suitable(cell.type, b - a, depth):
            found.append((cell.type, row.rects(a, b)))
        else:
            return None
    return [(kind, (*rects, *nooks.get(i, ()))) for i, (kind, rects) in enumerate(found)]
