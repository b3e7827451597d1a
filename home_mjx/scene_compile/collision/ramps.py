"""Colliders of stairs: slopes to walk on, a floor piece at the head, guards beside and below."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.boxes import BoxSet, concat_boxes, make_boxes
from home_mjx.scene_compile.collision.drop_barriers import BARRIER_HEIGHT, BARRIER_THICKNESS
from home_mjx.scene_compile.collision.floors import FLOOR_THICKNESS
from home_mjx.scene_compile.objects.slopes import Slope
from home_mjx.scene_compile.objects.stairs import Staircase
from home_mjx.schema.compiled import Colliders, Ramps

RAMP_THICKNESS = 0.2  # [m], thickness of a slope
BACK_WALL_THICKNESS = 0.05  # [m], thickness of the wall below the head of a slope
BACK_WALL_CLEARANCE = 0.4  # [m], from the head down to the top of that wall; clear of agents on slopes up to 60 degrees
HEAD_FLOOR_DEPTH = 0.12  # [m], depth of the floor piece at the head of a slope
MAX_EDGE_DISTANCE = 0.3  # [m], maximum distance between a landing's edge and the end of an adjoining slope
MIN_GUARD_GAP = 0.05  # [m], gaps up to this width get no guard


def make_ramps(stairs: Sequence[Staircase], first_row: int) -> Ramps:
    """Return the slopes of stairs as tilted boxes whose upper sides join the floors at both ends; empty without stairs.

    Rows are by stairs, from foot to head. `first_row` is the row of the first slope in the house's colliders.
    """
    slopes = [slope for one in stairs for slope in one.slopes]
    if not slopes:
        return Ramps.empty()
    angle, yaw = (np.array([getattr(s, name) for s in slopes]) for name in ("angle", "yaw"))
    up = np.array([s.up for s in slopes])
    length = np.array([np.hypot(s.run, s.high - s.low) for s in slopes])
    width = np.array([s.width for s in slopes])
    middle = np.array([[*(s.foot + s.up * s.run / 2), (s.low + s.high) / 2] for s in slopes])
    normal = np.c_[-np.sin(angle)[:, None] * up, np.cos(angle)]
    cy, sy, cp, sp = np.cos(yaw / 2), np.sin(yaw / 2), np.cos(angle / 2), -np.sin(angle / 2)
    return Ramps(
        object_id=np.array([one.object_id for one in stairs for _ in one.slopes], np.int32),
        pos=middle - normal * RAMP_THICKNESS / 2,
        quat=np.stack([cy * cp, -sy * sp, cy * sp, sy * cp], axis=-1),  # rotation about z after a tilt about y
        size=np.stack([length / 2, width / 2, np.full(len(slopes), RAMP_THICKNESS / 2)], axis=-1),
        slope=angle,
        up=up,
        collider=np.arange(first_row, first_row + len(slopes), dtype=np.int32),
    )


def append_ramps(colliders: Colliders, ramps: Ramps) -> Colliders:
    """Return the colliders with the boxes of ramps as their last rows."""
    return Colliders(
        *(np.concatenate([getattr(colliders, n), getattr(ramps, n)]) for n in ("pos", "quat", "size", "object_id"))
    )


def build_guards(stairs: Sequence[Staircase]) -> BoxSet:
    """Return guards beside slopes and landings, see `_guards`, and walls against entering below stairs."""
    walls = (_guards, _wall_below_head, _wall_below_open_slopes)
    return concat_boxes(box for one in stairs for wall in walls for box in wall(one))


def build_sills(stairs: Sequence[Staircase]) -> BoxSet:
    """Return one floor piece beyond the head of each staircase, which closes the gap left by a slanted floor edge."""
    heads = [one.slopes[-1] for one in stairs]
    return concat_boxes(
        _between(s, (s.run, s.run + HEAD_FLOOR_DEPTH), (-s.width / 2, s.width / 2), s.high - FLOOR_THICKNESS, s.high)
        for s in heads
    )


def _guards(stairs: Staircase) -> Iterator[BoxSet]:
    """Yield guards beside slopes and landings, on both sides, up to `BARRIER_HEIGHT` above their higher end.

    They reach down to the floor at the foot of the stairs or, where agents can walk below, to the slope's underside.
    """
    for i, slope in enumerate(stairs.slopes):
        high, half = slope.high + BARRIER_HEIGHT, slope.width / 2
        low = stairs.low if i < stairs.first_open_slope else slope.low - RAMP_THICKNESS
        if slope.high > slope.low:
            for side in ((-half - BARRIER_THICKNESS, -half), (half, half + BARRIER_THICKNESS)):
                yield _between(slope, (0.0, slope.run), side, low, high)
        else:
            before, after = stairs.slopes[i - 1].outline, stairs.slopes[i + 1].outline
            yield from _around(slope, [before[[1, 2]], after[[3, 0]]], low, high)


def _wall_below_head(stairs: Staircase) -> Iterator[BoxSet]:
    """Yield a wall that keeps agents from entering below the last slope from behind, unless other stairs exit there."""
    head = stairs.slopes[-1]
    half = head.width / 2
    if not stairs.stacked:
        yield _between(
            head, (head.run - BACK_WALL_THICKNESS, head.run), (-half, half), stairs.low, head.high - BACK_WALL_CLEARANCE
        )


def _wall_below_open_slopes(stairs: Staircase) -> Iterator[BoxSet]:
    """Yield a wall below the foot of the first slope that agents can walk under, if any, so that they stop there."""
    for slope in stairs.slopes[stairs.first_open_slope :][:1]:
        half = slope.width / 2
        yield _between(slope, (0.0, BACK_WALL_THICKNESS), (-half, half), stairs.low, slope.low - BACK_WALL_CLEARANCE)


def _around(landing: Slope, ways: Sequence[Float[np.ndarray, "2 2"]], low: float, high: float) -> Iterator[BoxSet]:
    """Yield boxes beyond a landing's sides, between two heights [m], except at `ways`.

    `ways` are the ends of adjoining edges; those farther than `MAX_EDGE_DISTANCE` from a side do not open it.
    """
    for a, b in zip(landing.outline, np.roll(landing.outline, -1, axis=0), strict=True):
        length = float(np.linalg.norm(b - a))
        along, out = (b - a) / length, np.array([(b - a)[1], -(b - a)[0]]) / length
        stops = [0.0, length]
        for way in ways:
            if (abs((way - a) @ out) < MAX_EDGE_DISTANCE).all():
                stops += np.clip(np.sort((way - a) @ along), 0, length).tolist()
        for start, end in _outside(stops):
            middle = a + (start + end) / 2 * along + BARRIER_THICKNESS / 2 * out
            half = [(end - start) / 2, BARRIER_THICKNESS / 2, (high - low) / 2]
            yield make_boxes([*middle, (low + high) / 2], half, float(np.arctan2(along[1], along[0])))


def _outside(stops: Sequence[float]) -> list[tuple[float, float]]:
    """Return the parts of a range that are outside others and wider than `MIN_GUARD_GAP` [m], in order.

    `stops` has the start and end of the range, then those of each other one; these are inside it and not nested.
    """
    taken = sorted(zip(stops[2::2], stops[3::2], strict=True))
    edges = [stops[0], *(value for pair in taken for value in pair), stops[1]]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > MIN_GUARD_GAP]


def _between(slope: Slope, along: tuple[float, float], across: tuple[float, float], low: float, high: float) -> BoxSet:
    """Return an upright box between distances from the foot, uphill and to the left, and between two heights [m]."""
    left = np.array([-slope.up[1], slope.up[0]])
    middle = slope.foot + np.mean(along) * slope.up + np.mean(across) * left
    half = [np.ptp(along) / 2, np.ptp(across) / 2, (high - low) / 2]
    return make_boxes([*middle, (low + high) / 2], half, slope.yaw)
