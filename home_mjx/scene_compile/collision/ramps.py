"""Stairs as collision boxes: a slope to walk on, a piece of floor at its head, guards beside and below it."""

from collections.abc import Sequence

import numpy as np

from home_mjx.scene_compile.collision.edges import RAIL, THICKNESS
from home_mjx.scene_compile.collision.floors import SLAB
from home_mjx.scene_compile.geometry.boxes import BoxSet, box_set, join
from home_mjx.scene_compile.objects.stairs import Flight
from home_mjx.schema.compiled import Colliders, Ramps

DEPTH = 0.2  # [m], thickness of a slope
BACK = 0.05  # [m], thickness of the wall below its head
BELOW_HEAD = 0.4  # [m], from there to the top of that wall: nobody on a slope of up to 60 degrees meets it
SILL = 0.12  # [m], depth of the piece of floor at its head


def make_ramps(flights: Sequence[Flight], first_row: int) -> Ramps:
    """The slopes of flights: boxes whose upper side joins the floors at both ends.

    Args:
        flights: Stairs of the house.
        first_row: Row of the first of them in the house's colliders.
    """
    if not flights:
        return Ramps.none()
    slope, yaw = (np.array([getattr(f, name) for f in flights]) for name in ("slope", "yaw"))
    up = np.array([f.up for f in flights])
    length = np.array([np.hypot(f.run, f.high - f.low) for f in flights])
    width = np.array([f.width for f in flights])
    middle = np.array([[*(f.foot + f.up * f.run / 2), (f.low + f.high) / 2] for f in flights])
    normal = np.c_[-np.sin(slope)[:, None] * up, np.cos(slope)]
    cy, sy, cp, sp = np.cos(yaw / 2), np.sin(yaw / 2), np.cos(slope / 2), -np.sin(slope / 2)
    return Ramps(
        object_id=np.array([f.object_id for f in flights], np.int32),
        pos=middle - normal * DEPTH / 2,
        quat=np.stack([cy * cp, -sy * sp, cy * sp, sy * cp], axis=-1),  # turned about z, after being tilted about y
        size=np.stack([length / 2, width / 2, np.full(len(flights), DEPTH / 2)], axis=-1),
        slope=slope,
        up=up,
        collider=np.arange(first_row, first_row + len(flights), dtype=np.int32),
    )


def with_ramps(colliders: Colliders, ramps: Ramps) -> Colliders:
    """The boxes and, as the last ones, those of ramps."""
    return Colliders(
        *(np.concatenate([getattr(colliders, n), getattr(ramps, n)]) for n in ("pos", "quat", "size", "object_id"))
    )


def guards(flights: Sequence[Flight]) -> BoxSet:
    """Boxes along both sides of flights, up to a railing over the upper floor, and walls below their heads."""
    return join(box for flight in flights for box in _guards(flight))


def sills(flights: Sequence[Flight]) -> BoxSet:
    """Pieces of the upper floors at the heads of flights, to which floors beside slanted edges reach inexactly."""
    return join(_between(f, (f.run, f.run + SILL), (-f.width / 2, f.width / 2), f.high - SLAB, f.high) for f in flights)


def _guards(flight: Flight) -> list[BoxSet]:
    half = flight.width / 2
    sides = [(-half - THICKNESS, -half), (half, half + THICKNESS)]
    beside = [_between(flight, (0.0, flight.run), side, flight.low, flight.high + RAIL) for side in sides]
    back = _between(flight, (flight.run - BACK, flight.run), (-half, half), flight.low, flight.high - BELOW_HEAD)
    return [*beside, back]


def _between(
    flight: Flight, along: tuple[float, float], across: tuple[float, float], low: float, high: float
) -> BoxSet:
    """An upright box between distances from the foot, along the way up and to its left, and between heights [m]."""
    left = np.array([-flight.up[1], flight.up[0]])
    middle = flight.foot + np.mean(along) * flight.up + np.mean(across) * left
    half = [np.ptp(along) / 2, np.ptp(across) / 2, (high - low) / 2]
    return box_set([*middle, (low + high) / 2], half, flight.yaw)
