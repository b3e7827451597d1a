"""Draws one house from its seed: rooms, openings, furniture, surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from home_procgen.floor_plan.openings import LevelPlan
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import RoomSurfaces
from home_procgen.primitives.palette import (
    CEILINGS,
    DRY_WALLS,
    FACADES,
    SOFT_FLOORS,
    WET_FLOORS,
    WET_WALLS,
    WOODEN_FLOORS,
    choose_random,
)
from home_procgen.v1.furnish import furnish
from home_procgen.v1.furnish.style import Style
from home_procgen.v1.openings import WET, draw_plan

_FLOORS = {"Bathroom": WET_FLOORS, "Toilet": WET_FLOORS, "Kitchen": WET_FLOORS, "Living_Room": WOODEN_FLOORS}


@dataclass(frozen=True)
class Design:
    """All that a house is made of, before it has meshes and a file format."""

    plan: LevelPlan
    surfaces: tuple[RoomSurfaces, ...]  # per room
    objects: tuple[tuple[PlacedModel, int], ...]  # with the index of the room that owns each; doors and windows first


def draw_design(seed: int) -> Design:
    """The design of a seed.

    Example:
        >>> [room.type for room in draw_design(7).plan.rooms][:2]
        ['Living_Room', 'Bathroom']
    """
    rng = np.random.default_rng(seed)
    while True:
        plan, style = draw_plan(rng), Style.draw(rng)
        furniture = furnish(plan, style)
        if furniture is not None:
            inside = [(placed, room) for room, items in enumerate(furniture) for placed in items]
            objects = (*_openings(plan, style), *inside)
            return Design(plan, tuple(_surfaces(plan, rng)), objects)


def _openings(plan: LevelPlan, style: Style) -> Iterator[tuple[PlacedModel, int]]:
    """Doors and windows, each kind in one look."""
    looks = {}
    for opening in plan.openings:
        model = opening.object.model
        if model.fine not in looks:
            looks[model.fine] = style.dress(model)
        yield replace(opening.object, materials=looks[model.fine]), opening.rooms[0]


def _surfaces(plan: LevelPlan, rng: np.random.Generator) -> Iterator[RoomSurfaces]:
    facade, ceiling = choose_random(FACADES, rng), choose_random(CEILINGS, rng)
    for room in plan.rooms:
        floors, walls = _FLOORS.get(room.type, SOFT_FLOORS), WET_WALLS if room.type in WET else DRY_WALLS
        yield RoomSurfaces(choose_random(floors, rng), ceiling, choose_random(walls, rng), facade)
