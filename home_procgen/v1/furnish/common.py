"""Steps that the recipes of several rooms share."""

from collections.abc import Callable

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.v1.furnish.layout import RoomLayout


def chance(room: RoomLayout, probability: float) -> bool:
    """A biased coin."""
    return bool(room.rng.random() < probability)


def fit(room: RoomLayout, family: str, place: Callable[[PlacedModel], PlacedModel | None]) -> PlacedModel | None:
    """Places the favourite model of a family, or else the first other one that fits."""
    return next((placed for item in room.style.choices(family) if (placed := place(item))), None)


def add(room: RoomLayout, family: str, front: float = 0.0, probability: float = 1.0, top: str | None = None) -> None:
    """Maybe an object against a wall, and one on top of it.

    Args:
        room: Where.
        family: What.
        front: Depth of the floor in front of it that stays free [m].
        probability: Of trying at all.
        top: Family of what stands on it.
    """
    placed = fit(room, family, lambda item: room.against_wall(item, front)) if chance(room, probability) else None
    if placed and top:
        room.on_top(placed, room.style.object(top))
