"""Ground floors of L-, T- and U-shaped homes.

A home with a wing has a second hall at right angles, with a row of rooms on either side. A split home has one hall; the
ends or the middle of the row on one side are deeper.
"""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.shape.program import ROOM_REQUIREMENTS
from home_procgen.plan.shape.rows import FOYER, PlacedRoom, RoomRow, RowCell, compute_widths, snap_to_grid
from home_procgen.plan.shape.shell import (
    STAIRS,
    STAIRS_WIDTH,
    HomeShell,
    PlacedRow,
    StoreyDraft,
    complete_storey,
    distribute_cells,
    draw_cell,
    place_rows,
    required_hall_end,
)

SHALLOW_DEPTH_RANGE, DEEP_DEPTH_RANGE = (2.9, 3.6), (4.8, 5.8)  # [m], ranges of row depths
U_SHAPE_PROBABILITY = 0.6  # share of U-shaped homes; the others are T-shaped


def draw_winged(rng: np.random.Generator, types: Sequence[str], stairs: bool) -> StoreyDraft | None:
    """Try to draw an L- or T-shaped ground floor: halls, rooms of `types` and stairs; None if the attempt fails."""
    across, aside = (snap_to_grid(rng.uniform(1.3, 1.7)) for _ in range(2))
    depths = [
        snap_to_grid(rng.uniform(3.4, 4.6)),
        snap_to_grid(rng.uniform(3.0, 3.8) if stairs else rng.uniform(2.6, 4.4)),
    ]
    wings = [snap_to_grid(rng.uniform(3.0, 4.4)) for _ in range(2)]
    cells = sorted(
        (draw_cell(rng, kind) for kind in types),
        key=lambda c: ROOM_REQUIREMENTS[c.type].zone + rng.uniform(-0.15, 0.15),
    )
    cut = round(len(cells) * rng.uniform(0.5, 0.7))
    main, wing = distribute_cells(rng, cells[:cut], depths), distribute_cells(rng, cells[cut:], wings)
    if main is None or wing is None or not all((*main, *wing)):
        return None
    north, south = main
    if stairs:
        south.insert(int(rng.integers(len(south) + 1)), RowCell(STAIRS, STAIRS_WIDTH * depths[1]))
    if rng.random() < 0.6:
        south.insert(int(rng.integers(len(south) + 1)), RowCell(FOYER, rng.uniform(1.6, 2.2) * depths[1]))
    at = len(north) if rng.random() < 0.5 else int(rng.integers(1, len(north) + 1))
    first, second = (sum(compute_widths(row, depths[0])[0]) for row in (north[:at], north[at:]))
    gap = snap_to_grid(first)
    total = snap_to_grid(gap + aside + second)
    want = sum(compute_widths([c for c in south if c.type != STAIRS], depths[1])[0]) + STAIRS_WIDTH * stairs
    end = total if 0.8 < total / want < 1.25 else snap_to_grid(max(want, gap + aside))
    begins = snap_to_grid(across + depths[0]), snap_to_grid(across + depths[0] if at < len(north) else across)
    ways = [sum(compute_widths(row, d)[0]) for row, d in zip(wing, wings, strict=True)]
    stops = [snap_to_grid(b + w) for b, w in zip(begins, ways, strict=True)]
    if abs(stops[0] - stops[1]) < 0.22 * min(ways):
        stops = [snap_to_grid(sum(stops) / 2)] * 2
    rows = [
        (RoomRow(0, 1, across, 0.0, gap, depths[0]), north[:at]),
        (RoomRow(0, -1, 0.0, 0.0, end, depths[1]), south),
        (RoomRow(0, 1, across, snap_to_grid(gap + aside), total, depths[0]), north[at:]),
        (RoomRow(1, -1, gap, begins[0], stops[0], wings[0]), wing[0]),
        (RoomRow(1, 1, snap_to_grid(gap + aside), begins[1], stops[1], wings[1]), wing[1]),
    ]
    laid = place_rows((row, cells) for row, cells in rows if cells)
    return None if laid is None else _complete_winged(laid, across, (gap, snap_to_grid(gap + aside)))


def _complete_winged(known: Sequence[PlacedRow], across: float, gap: tuple[float, float]) -> StoreyDraft:
    """Return the storey of the rows along both halls; each hall ends at the front of its last room."""
    ends = [max(required_hall_end(one) for one in known if one[0].axis == axis) for axis in (0, 1)]
    right, top = snap_to_grid(max(ends[0], gap[1])), snap_to_grid(ends[1])
    hall = (Rect(0.0, 0.0, right, across), Rect(gap[0], across, gap[1], top))
    place = next(((i, one[2]) for i, one in enumerate(known) if one[2] is not None), (-1, None))
    reach = tuple((0.0, right) if row.axis == 0 else (across, top) for row, _, _ in known)
    rooms: list[PlacedRoom] = [room for _, placed, _ in known for room in placed]
    shell = HomeShell(hall, tuple(row for row, _, _ in known), reach, stairs=place[1], stairs_row=place[0])
    return StoreyDraft(shell, tuple(rooms))


def draw_split(rng: np.random.Generator, types: Sequence[str], stairs: bool) -> StoreyDraft | None:
    """Try to draw a U- or T-shaped ground floor: halls, rooms of `types` and stairs; None if the attempt fails."""
    across = snap_to_grid(rng.uniform(1.3, 1.7) if not stairs else rng.uniform(1.4, 2.0))
    deep, shallow = snap_to_grid(rng.uniform(*DEEP_DEPTH_RANGE)), snap_to_grid(rng.uniform(*SHALLOW_DEPTH_RANGE))
    depths = (deep, shallow, deep) if rng.random() < U_SHAPE_PROBABILITY else (shallow, deep, shallow)
    behind = snap_to_grid(rng.uniform(3.0, 3.8) if stairs else rng.uniform(2.6, 4.2))
    halves = distribute_cells(rng, [draw_cell(rng, kind) for kind in types], (sum(depths) / 3, behind))
    if halves is None or len(halves[0]) < 3 or not halves[1]:
        return None
    front, back = halves
    cuts = sorted(rng.choice(np.arange(1, len(front)), size=2, replace=False).tolist())
    parts = [front[: cuts[0]], front[cuts[0] : cuts[1]], front[cuts[1] :]]
    ends = np.cumsum(
        [0.0, *(snap_to_grid(sum(compute_widths(part, d)[0])) for part, d in zip(parts, depths, strict=True))]
    )
    wanted = sum(compute_widths(back, behind)[0]) + STAIRS_WIDTH * stairs
    if not 0.8 < ends[-1] / wanted < 1.25:
        return None
    if stairs:
        back.insert(int(rng.integers(len(back) + 1)), RowCell(STAIRS, STAIRS_WIDTH * behind))
    if rng.random() < 0.5:
        back.insert(int(rng.integers(min(2, len(back)) + 1)), RowCell(FOYER, rng.uniform(1.6, 2.2) * behind))
    rows = [
        (RoomRow(0, 1, across, snap_to_grid(low), snap_to_grid(high), depth), part)
        for low, high, depth, part in zip(ends, ends[1:], depths, parts, strict=False)
    ]
    rows.append((RoomRow(0, -1, 0.0, 0.0, snap_to_grid(ends[-1]), behind), back))
    laid = place_rows(rows)
    return None if laid is None else complete_storey(rng, laid, across, snap_to_grid(ends[-1]), None)
