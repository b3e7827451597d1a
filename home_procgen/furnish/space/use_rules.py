"""Rules of use of a room's objects: one television, seats and beds that face it, one clock, no ornament twice."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed_model import PlacedModel

SINGLE_FAMILIES = (("television", "wall_television"), ("wall_clock", "tall_clock"))  # of each at most one in a room
SEAT_FAMILIES = ("sofa", "armchair")
BED_FAMILIES = ("double_bed", "single_bed")
MIN_FACING = 0.5  # minimum cosine between the front of a seat and the direction to the television
MIN_SCREEN_FACING = 0.25  # minimum cosine between the front of a television and the direction to its seat or bed
UNREPEATED_FAMILIES = ("wall_ornament", "helmet", "pet")  # of each model at most one in a room
RULED_FAMILIES = {
    *UNREPEATED_FAMILIES,
    *SEAT_FAMILIES,
    *BED_FAMILIES,
    *(name for names in SINGLE_FAMILIES for name in names),
}


def keeps_rules(present: Sequence[PlacedModel], added: Sequence[PlacedModel]) -> bool:
    """Return whether a room keeps the rules of use when objects are added.

    The nearest seat faces the television and the television faces it, or the beds of a room without seats.
    """
    if not any(item.model.family in RULED_FAMILIES for item in added):
        return True
    items = [item for item in (*present, *added) if item.model.family in RULED_FAMILIES]
    if any(sum(item.model.family in names for item in items) > 1 for names in SINGLE_FAMILIES):
        return False
    single = [item.model.id for item in items if item.model.family in UNREPEATED_FAMILIES]
    if len(set(single)) < len(single):
        return False
    return all(_is_watched(screen, items) for screen in items if screen.model.fine == "television")


def _is_watched(screen: PlacedModel, items: Sequence[PlacedModel]) -> bool:
    seats = [item for item in items if item.model.family in SEAT_FAMILIES]
    beds = [item for item in items if item.model.family in BED_FAMILIES]
    if beds:
        return all(_facing(screen, bed) > MIN_SCREEN_FACING and _facing(bed, screen) > 0 for bed in beds)
    if not seats:
        return True
    nearest = min(seats, key=lambda seat: float(np.hypot(*_between(screen, seat))))
    return _facing(nearest, screen) > MIN_FACING and _facing(screen, nearest) > MIN_SCREEN_FACING


def _between(item: PlacedModel, other: PlacedModel) -> Float[np.ndarray, " 2"]:
    return np.subtract(other.position, item.position)[[0, 2]]


def _facing(item: PlacedModel, other: PlacedModel) -> float:
    """Return the cosine, in the plan, between an object's front and the direction to another."""
    front, away = item.linear[[0, 2], 2], _between(item, other)
    return float(front @ away / (np.linalg.norm(front) * np.linalg.norm(away)))
