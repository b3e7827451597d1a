"""Roofs: gables over the largest rectangles of a home's top storey; gables of adjacent rectangles intersect."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float, Int

from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside.models import EAVES_OVERHANG, MODEL_PITCH, ROOF_SIZES, outside_models

ROOF_OFFSET = 0.05  # [m], above the nominal wall height; ceilings and walls end lower
MAX_UNCOVERED_AREA = 0.3  # [m^2], maximum area without a roof
MAX_GABLES = 8  # maximum number of gables

Spans = tuple[Int[np.ndarray, "_"], Int[np.ndarray, "_"]]  # indices of the lines at which the spans begin and end


def build_roofs(
    rects: Sequence[Rect], height: float, pitch: float, materials: tuple[Material, ...]
) -> Iterator[PlacedModel]:
    """Generate gables over rooms.

    Args:
        rects: Rectangles of the rooms [m]; joined to fewer, larger ones.
        height: Height of the walls [m].
        pitch: Rise per run.
        materials: Materials by slot of the models.
    """
    for rect in cover_with_rects(rects):
        yield build_gable(
            (rect.x0 + rect.x1) / 2, (rect.z0 + rect.z1) / 2, rect.extents, height + ROOF_OFFSET, pitch, materials
        )


def build_gable(
    x: float, z: float, sides: tuple[float, float], y: float, pitch: float, materials: tuple[Material, ...]
) -> PlacedModel:
    """Return a gable at height `y` over a rectangle at (x, z) of extents `sides` [m], its ridge along the longer."""
    long, short = max(sides), min(sides)
    fit = [abs(np.log(long / a)) + abs(np.log(short / b)) for a, b in ROOF_SIZES]
    number = int(np.argmin(fit))
    length, across = ROOF_SIZES[number]
    stretch = (
        (long + 2 * EAVES_OVERHANG) / (length + 2 * EAVES_OVERHANG),
        (short + 2 * EAVES_OVERHANG) / (across + 2 * EAVES_OVERHANG),
    )
    scale = (round(stretch[0], 4), round(stretch[1] * pitch / MODEL_PITCH, 4), round(stretch[1], 4))
    placed = PlacedModel(outside_models()["roof"][number], (0.0, 0.0, 0.0), 0, scale, materials=materials)
    return placed.moved_to(x, y, z, 0 if sides[0] >= sides[1] else 1)


def cover_with_rects(rects: Sequence[Rect]) -> list[Rect]:
    """Return rectangles that cover nearly all of a union of rectangles, each within the union, the largest gain first.

    Example:
        >>> cover_with_rects([Rect(0.0, 0.0, 2.0, 1.0), Rect(2.0, 0.0, 3.0, 1.0)])
        [Rect(x0=0.0, z0=0.0, x1=3.0, z1=1.0)]
    """
    xs, zs = (np.unique(np.round([v for r in rects for v in (r[k], r[k + 2])], 6)) for k in (0, 1))
    x, z = (xs[1:] + xs[:-1]) / 2, (zs[1:] + zs[:-1]) / 2
    within = np.zeros((len(x), len(z)), bool)
    for r in rects:
        within |= ((x > r.x0) & (x < r.x1))[:, None] & ((z > r.z0) & (z < r.z1))[None, :]
    area, left, found = np.outer(np.diff(xs), np.diff(zs)), within.copy(), []
    spans = [np.triu_indices(len(lines), 1) for lines in (xs, zs)]
    full = _span_sums(~within, *spans) == 0
    while (left * area).sum() > MAX_UNCOVERED_AREA and len(found) < MAX_GABLES:
        gain = np.where(full, _span_sums(left * area, *spans), -1.0)
        i, j = np.unravel_index(np.argmax(gain), gain.shape)
        (a, b), (c, d) = ((int(low[k]), int(high[k])) for (low, high), k in zip(spans, (i, j), strict=True))
        found.append(Rect(*(float(v) for v in (xs[a], zs[c], xs[b], zs[d]))))
        left[a:b, c:d] = False
    return found


def _span_sums(cells: np.ndarray, x: Spans, z: Spans) -> Float[np.ndarray, "i j"]:
    """Return the sum of the cells between each pair of lines along x and each pair along z."""
    total = np.zeros(np.add(cells.shape, 1))
    total[1:, 1:] = cells.cumsum(0).cumsum(1)
    across = total[x[1]] - total[x[0]]
    return across[:, z[1]] - across[:, z[0]]
