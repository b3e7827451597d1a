"""Small flats: rooms on one to three sides of the living room, which serves as their hall."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.shape.rows import RoomRow, RowCell, compute_widths, is_suitable, snap_to_grid
from home_procgen.plan.shape.shell import (
    MIN_HALL_CONTACT,
    HomeShell,
    PlacedRow,
    StoreyDraft,
    distribute_cells,
    draw_cell,
    place_row,
)

MIN_LIVING_AREA, MAX_LIVING_AREA = 16.5, 40.0  # [m^2], range of the living room's area
ROW_SIDES = ((0, 1), (0, -1), (1, 1))  # axis and sign of the rows: two along the long sides, one at the end
L_SHAPE_FACTOR = 2.2  # probability of an L-shaped living room, times the number of other rooms
SIMILAR_LENGTH_TOLERANCE = 0.18  # relative difference up to which a row is as long as its side of the living room


def draw_hub(rng: np.random.Generator, types: Sequence[str]) -> StoreyDraft | None:
    """Try to draw a flat with rooms of `types` around the living room; None if the attempt fails."""
    across = snap_to_grid(rng.uniform(3.5, 6.0))
    length = snap_to_grid(rng.uniform(MIN_LIVING_AREA, MAX_LIVING_AREA) / across)
    if not is_suitable("Living_Room", length, across):
        return None
    most = min(3, len(types))
    count = int(rng.integers(1, most + 1))
    sides = [ROW_SIDES[int(i)] for i in sorted(rng.choice(3, size=count, replace=False))]
    depths = [snap_to_grid(rng.uniform(2.4, 4.6)) for _ in sides]
    dealt = distribute_cells(rng, [draw_cell(rng, kind) for kind in types], depths)
    if dealt is None or not all(dealt):
        return None
    hall = Rect(0.0, 0.0, length, across)
    laid: list[PlacedRow] = []
    for side, depth, cells in zip(sides, depths, dealt, strict=True):
        one = _row_at_side(rng, hall, side, depth, cells)
        if one is None:
            return None
        laid.append(one)
    rows = tuple(row for row, _, _ in laid)
    reach = tuple((hall[row.axis], hall[row.axis + 2]) for row in rows)
    whole = (hall, *_l_extension(rng, hall, sides)) if rng.random() < L_SHAPE_FACTOR / len(types) else (hall,)
    return StoreyDraft(HomeShell(whole, rows, reach), tuple(room for _, rooms, _ in laid for room in rooms))


def _l_extension(rng: np.random.Generator, hall: Rect, sides: Sequence[tuple[int, int]]) -> tuple[Rect, ...]:
    """Return the rectangle that makes the living room an L or a T, on a side without rooms; () if it does not fit."""
    free = [side for side in ((0, 1), (0, -1), (1, 1), (1, -1)) if side not in sides]
    axis, sign = free[int(rng.integers(len(free)))]
    length = hall[axis + 2] - hall[axis]
    wide, deep = snap_to_grid(rng.uniform(2.0, max(2.1, length - 0.8))), snap_to_grid(rng.uniform(1.0, 2.6))
    if wide > length - 0.5:
        return ()
    shift = float(rng.choice([0.0, 1.0, rng.random()])) * (length - wide)
    row = RoomRow(axis, sign, hall[3 - axis] if sign > 0 else hall[1 - axis], hall[axis], hall[axis + 2], deep)
    return (row.rect(hall[axis] + shift, hall[axis] + shift + wide, 0.0, deep),)


def _row_at_side(
    rng: np.random.Generator, hall: Rect, side: tuple[int, int], depth: float, cells: Sequence[RowCell]
) -> PlacedRow | None:
    """Return a row on one side of the living room; None if it does not fit or a room has too short a front on it."""
    axis, sign = side
    low, high = hall[axis], hall[axis + 2]
    wanted = sum(compute_widths(cells, depth)[0])
    if abs(wanted - (high - low)) < SIMILAR_LENGTH_TOLERANCE * (high - low):
        wanted = high - low
    flush = float(rng.choice([0.0, 1.0, rng.random()], p=[0.42, 0.42, 0.16]))
    shift = low + flush * (high - low - wanted)
    base = hall[3 - axis] if sign > 0 else hall[1 - axis]
    laid = place_row(RoomRow(axis, sign, base, snap_to_grid(shift), snap_to_grid(shift + wanted), depth), cells)
    if laid is None:
        return None
    fronts = [min(rects[0][axis + 2], high) - max(rects[0][axis], low) for _, rects in laid[1]]
    return laid if min(fronts) >= MIN_HALL_CONTACT - 0.1 else None
