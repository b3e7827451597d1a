"""U- or T-shaped homes: on one side of the hall, the ends or the middle of the row are deeper."""

from collections.abc import Sequence

import numpy as np

from home_procgen.plan.shape.rows import FOYER, RoomRow, RowCell, compute_widths, snap_to_grid
from home_procgen.plan.shape.shell import (
    STAIRS,
    STAIRS_WIDTH,
    StoreyDraft,
    complete_storey,
    distribute_cells,
    draw_cell,
    place_rows,
)

SHALLOW_DEPTH_RANGE, DEEP_DEPTH_RANGE = (2.9, 3.6), (4.8, 5.8)  # [m], ranges of row depths
U_SHAPE_PROBABILITY = 0.6  # share of U-shaped homes; the others are T-shaped


def draw_split(rng: np.random.Generator, types: Sequence[str], stairs: bool) -> StoreyDraft | None:
    """Try to draw a U- or T-shaped ground floor; None if the attempt fails."""
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
