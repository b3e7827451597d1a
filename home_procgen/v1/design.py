"""Draws one house from its seed: rooms, openings, furniture, surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from home_procgen.floor_plan.openings import WET, HousePlan, draw_plan
from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import Surfaces
from home_procgen.primitives.palette import (
    CEILINGS,
    DRY_WALLS,
    FACADES,
    SOFT_FLOORS,
    WET_FLOORS,
    WET_WALLS,
    WOODEN_FLOORS,
    choose,
)
from home_procgen.v1.furnish import furnish
from home_procgen.v1.furnish.style import Style

_FLOORS = {"Bathroom": WET_FLOORS, "Toilet": WET_FLOORS, "Kitchen": WET_FLOORS, "Living_Room": WOODEN_FLOORS}


@dataclass(frozen=True)
class Design:
    """All that a house is made of, before it has meshes and a file format."""

    plan: HousePlan
    surfaces: tuple[Surfaces, ...]  # per room
    objects: tuple[
        tuple[PlacedFurniture, int], ...
    ]  # with the index of the room that owns each; doors and windows first


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


def _openings(plan: HousePlan, style: Style) -> Iterator[tuple[PlacedFurniture, int]]:
    """Doors and windows, each kind in one look."""
    looks = {}
    for opening in plan.openings:
        model = opening.placed.model
        if model.fine not in looks:
            looks[model.fine] = style.dress(model)
        yield replace(opening.placed, materials=looks[model.fine]), opening.rooms[0]


def _surfaces(plan: HousePlan, rng: np.random.Generator) -> Iterator[Surfaces]:
    facade, ceiling = choose(FACADES, rng), choose(CEILINGS, rng)
    for room in plan.rooms:
        floors, walls = _FLOORS.get(room.type, SOFT_FLOORS), WET_WALLS if room.type in WET else DRY_WALLS
        yield Surfaces(choose(floors, rng), ceiling, choose(walls, rng), facade)
