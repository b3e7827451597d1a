"""Outline of a home: a hall, rows of rooms along it, and a block at its end. All storeys share it.

Lengths result from the rooms of the ground floor. Coordinates are local: the hall runs along x from 0, with one row
on either side. A wing has a hall along z that begins between two rooms of the row at greater z.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.shape.program import ROOM_REQUIREMENTS, SMALL_TYPES
from home_procgen.plan.shape.rows import (
    FOYER,
    PlacedRoom,
    RoomRow,
    RowCell,
    compute_widths,
    is_suitable,
    place_cells,
    snap_to_grid,
)

MIN_HALL_CONTACT = 1.3  # [m], minimum wall that each room shares with the hall, for its door
STAIRS_WIDTH = 2.2  # [m], between the centre-lines of the walls beside stairs
STAIRS = "Stairs"
FACADE_STEP_PROBABILITY = 0.45  # probability of a stepped facade
SIMILAR_LENGTH_TOLERANCE = 0.22  # relative difference below which two rows are made equally long


@dataclass(frozen=True)
class HomeShell:
    """Shape that the storeys of a home share.

    Attributes:
        hall: Rectangles of the hall or, in small flats, of the living room that replaces it.
        rows: Rows of rooms.
        hall_spans: Interval of its axis in which each row borders the hall [m].
        block: Rectangle of the room at the end of the hall; None if there is none.
        hall_ends: Rectangles beyond the ends of halls, each with the index of the row whose last room includes it.
        stairs: Rectangle of the stairs, a part of the hall; None if there are none.
        stairs_row: Index of the row with the stairs; -1 if none.
    """

    hall: tuple[Rect, ...]
    rows: tuple[RoomRow, ...]
    hall_spans: tuple[tuple[float, float], ...]
    block: Rect | None = None
    hall_ends: tuple[tuple[Rect, int], ...] = ()
    stairs: Rect | None = None
    stairs_row: int = -1


@dataclass(frozen=True)
class StoreyDraft:
    """A storey in local coordinates; `rooms` are those besides the hall."""

    shell: HomeShell
    rooms: tuple[PlacedRoom, ...]


def draw_cell(rng: np.random.Generator, kind: str) -> RowCell:
    """Return a room of a type with a random area in its range."""
    return RowCell(kind, _uniform(rng, ROOM_REQUIREMENTS[kind].min_area, ROOM_REQUIREMENTS[kind].max_area))


def _uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a uniform random number; `rng.uniform` takes several times as long, and plans take many attempts."""
    return low + (high - low) * rng.random()


def distribute_cells(
    rng: np.random.Generator, cells: Sequence[RowCell], depths: Sequence[float]
) -> list[list[RowCell]] | None:
    """Distribute cells over rows of similar length; None if one fits no row. Small cells come next to others."""
    rows: list[list[RowCell]] = [[] for _ in depths]
    length = [0.0 for _ in depths]
    for cell in sorted((c for c in cells if c.type not in SMALL_TYPES), key=lambda c: -c.area):
        able = [
            i
            for i, d in enumerate(depths)
            if is_suitable(cell.type, max(cell.area / d, ROOM_REQUIREMENTS[cell.type].min_side), d)
        ]
        if not able:
            return None
        i = min(able, key=lambda k: length[k] + _uniform(rng, 0, 1.5))
        rows[i].append(cell)
        length[i] += cell.area / depths[i]
    order = {id(cell): ROOM_REQUIREMENTS[cell.type].zone + _uniform(rng, -0.12, 0.12) for cell in cells}
    rows = [sorted(row, key=lambda cell: order[id(cell)]) for row in rows]
    for cell in (c for c in cells if c.type in SMALL_TYPES):
        i = min(range(len(rows)), key=lambda k: length[k] + _uniform(rng, 0, 1.5))
        at = sum(order[id(other)] < order[id(cell)] for other in rows[i])
        rows[i].insert(at, cell)
        length[i] += compute_widths(rows[i], depths[i])[0][at]
    return rows


def draw_straight(rng: np.random.Generator, types: Sequence[str], stairs: bool) -> StoreyDraft | None:
    """Try to draw a ground floor with one hall, rooms of `types` and stairs; None if the attempt fails."""
    across = snap_to_grid(rng.uniform(1.3, 1.7) if not stairs else rng.uniform(1.4, 2.0))
    depths = [
        snap_to_grid(rng.uniform(3.4, 4.8)),
        snap_to_grid(rng.uniform(3.0, 3.8) if stairs else rng.uniform(2.5, 4.2)),
    ]
    cells, block = _take_block(rng, [draw_cell(rng, kind) for kind in types], across, depths)
    rows = distribute_cells(rng, cells, depths)
    if rows is None or not all(rows):
        return None
    if stairs:
        rows[1].insert(int(rng.integers(len(rows[1]) + 1)), RowCell(STAIRS, STAIRS_WIDTH * depths[1]))
    if rng.random() < (0.5 if block is None else 0.75):
        i = int(rng.integers(2))
        rows[i].insert(int(rng.integers(min(2, len(rows[i])) + 1)), RowCell(FOYER, rng.uniform(1.6, 2.2) * depths[i]))
    length = _lengths(rows, depths)
    bases, signs = (across, 0.0), (1, -1)
    lines = [
        RoomRow(0, signs[i], bases[i], 0.0, length[i], depths[i], _step(rng, length[i], depths[i])) for i in range(2)
    ]
    laid = place_rows(zip(lines, rows, strict=True))
    return None if laid is None else complete_storey(rng, laid, across, max(length), block)


def _take_block(
    rng: np.random.Generator, cells: list[RowCell], across: float, depths: Sequence[float]
) -> tuple[list[RowCell], tuple[RowCell, Rect] | None]:
    """Return the cells, and a block across the hall's end with the living room or garage taken from them, or None."""
    for kind, odds in (("Living_Room", 0.5), ("Garage", 0.5)):
        cell = next((cell for cell in cells if cell.type == kind), None)
        if cell is None or rng.random() > odds:
            continue
        spans = [(0.0, across + depths[0]), (-depths[1], across), (-depths[1], across + depths[0])]
        for low, high in (spans[i] for i in rng.permutation(3)):
            width = snap_to_grid(cell.area / (high - low))
            if is_suitable(kind, width, high - low):
                rest = [other for other in cells if other is not cell]
                return rest, (cell, Rect(-width, snap_to_grid(low), 0.0, snap_to_grid(high)))
    return cells, None


def _lengths(rows: Sequence[Sequence[RowCell]], depths: Sequence[float]) -> list[float]:
    """Return the length of each row from the widths of its cells; similar lengths are made equal [m]."""
    plain = [[c for c in row if c.type != STAIRS] for row in rows]
    length = [sum(compute_widths(row, d)[0]) if row else 0.0 for row, d in zip(plain, depths, strict=True)]
    length = [x + STAIRS_WIDTH * any(c.type == STAIRS for c in row) for x, row in zip(length, rows, strict=True)]
    if max(length) - min(length) < SIMILAR_LENGTH_TOLERANCE * max(length):
        length = [sum(length) / len(length)] * len(length)
    return [snap_to_grid(x) for x in length]


def _step(rng: np.random.Generator, length: float, depth: float) -> tuple[float, float, float] | None:
    """Draw a step (start, end, depth) [m] of the facade, at one end of the row or in its middle; None for none."""
    if rng.random() > FACADE_STEP_PROBABILITY or length < 6:
        return None
    shift = float(rng.choice([-1, 1])) * rng.uniform(0.5, 1.3)
    start = rng.uniform(0.25, 0.7) * length
    end = length if rng.random() < 0.55 or start > 0.5 * length else rng.uniform(start + 2.5, length)
    return snap_to_grid(start), snap_to_grid(end), snap_to_grid(max(depth + shift, 2.6))


PlacedRow = tuple[RoomRow, list[PlacedRoom], Rect | None]  # the row, its rooms, and the rectangle of its stairs if any


def place_row(row: RoomRow, cells: Sequence[RowCell]) -> PlacedRow | None:
    """Place the rooms and stairs of a row; None if they do not fit.

    The step of the returned row is at a wall between rooms; it has none if the row has stairs or no suitable wall.
    """
    index = next((i for i, cell in enumerate(cells) if cell.type == STAIRS), None)
    if index is None:
        plain = row if row.step is None else replace(row, step=None)
        rooms = place_cells(plain, cells)
        if rooms is None:
            return None
        stepped = _snap_step(row, rooms)
        rooms = rooms if stepped.step is None else place_cells(stepped, cells)
        return None if rooms is None else (stepped, rooms, None)
    row = replace(row, step=None)
    before = sum(compute_widths(cells[:index], row.depth)[0]) if index else 0.0
    after = sum(compute_widths(cells[index + 1 :], row.depth)[0]) if index + 1 < len(cells) else 0.0
    free = row.end - row.start - STAIRS_WIDTH
    at = snap_to_grid(row.start + free * before / max(before + after, 1e-6))
    first = place_cells(row.with_ends(row.start, at), cells[:index])
    second = place_cells(row.with_ends(snap_to_grid(at + STAIRS_WIDTH), row.end), cells[index + 1 :])
    if first is None or second is None:
        return None
    return row, [*first, *second], row.rect(at, at + STAIRS_WIDTH, 0.0, row.depth)


def place_rows(pairs: Iterable[tuple[RoomRow, Sequence[RowCell]]]) -> list[PlacedRow] | None:
    """Place several rows; None if one of them cannot be placed."""
    found = []
    for row, cells in pairs:
        laid = place_row(row, cells)
        if laid is None:
            return None
        found.append(laid)
    return found


def _snap_step(row: RoomRow, rooms: Sequence[PlacedRoom]) -> RoomRow:
    step = row.step
    if step is None:
        return row
    walls = [rects[0][row.axis] for kind, rects in rooms[1:] if kind not in SMALL_TYPES]
    if not walls:
        return replace(row, step=None)
    start, end = (min([*walls, row.end], key=lambda at: abs(at - wanted)) for wanted in step[:2])
    return replace(row, step=(start, end, step[2]) if start < end else None)


def required_hall_end(laid: PlacedRow) -> float:
    """Return the coordinate up to which a row needs the hall: a front for every room, the full width of stairs [m]."""
    row, rooms, stairs = laid
    fronts = [min(rects[0][row.axis] + MIN_HALL_CONTACT, row.end) for _, rects in rooms]
    return max([*fronts, *([] if stairs is None else [stairs[row.axis + 2]])])


def complete_storey(
    rng: np.random.Generator,
    placed_rows: Sequence[PlacedRow],
    across: float,
    end: float,
    block: tuple[RowCell, Rect] | None,
) -> StoreyDraft:
    """Complete the storey of rows along one hall.

    The hall ends at the front of its last room, and the last room of a row includes the remaining rectangle.
    Otherwise the hall extends to the outer wall.

    Args:
        rng: Source of randomness.
        placed_rows: The rows from `place_rows`.
        across: Width of the hall [m].
        end: Upper end of the longest row [m].
        block: The room at the other end of the hall, and its rectangle; None if there is none.
    """
    rows = [row for row, _, _ in placed_rows]
    stop = snap_to_grid(max(required_hall_end(one) for one in placed_rows))
    takers = [
        i
        for i, row in enumerate(rows)
        if abs(row.end - end) < 0.05
        and placed_rows[i][1][-1][0] in ("Bedroom", "Living_Room", "Kitchen", "Office", "Gym")
        and placed_rows[i][1][-1][1][0].x1 == rows[i].end
    ]
    if end - stop < 0.7 or not takers or (block is not None and rng.random() < 0.4):
        stop, takers = end, []
    rests = ((Rect(stop, 0.0, snap_to_grid(end), across), takers[int(rng.integers(len(takers)))]),) if takers else ()
    place = next(((i, one[2]) for i, one in enumerate(placed_rows) if one[2] is not None), (-1, None))
    shell = HomeShell(
        hall=(Rect(0.0, 0.0, stop, across),),
        rows=tuple(rows),
        hall_spans=((0.0, stop),) * len(rows),
        block=None if block is None else block[1],
        hall_ends=rests,
        stairs=place[1],
        stairs_row=place[0],
    )
    rooms = [list(one[1]) for one in placed_rows]
    if rests:
        kind, rects = rooms[rests[0][1]][-1]
        rooms[rests[0][1]][-1] = (kind, (*rects, rests[0][0]))
    ends = [] if block is None else [(block[0].type, (block[1],))]
    return StoreyDraft(shell, (*(room for row in rooms for room in row), *ends))
