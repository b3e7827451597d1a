"""Random design of one home from its seed: storeys, openings, stairs, railings, furniture and surfaces."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from home_mjx.errors import ConfigError
from home_mjx.schema.house import Material
from home_procgen.fittings import OwnedObject, place_fittings
from home_procgen.floor_plan.openings import LevelPlan
from home_procgen.floor_plan.walls import RoomSurfaces
from home_procgen.furnish import furnish_home
from home_procgen.plan.home import HomePlan, draw_home
from home_procgen.plan.shape.program import RoomProgram, draw_program
from home_procgen.presets import PRESETS, Preset
from home_procgen.primitives.palette import FACADES, choose_random
from home_procgen.style import HomeStyle
from home_procgen.style.room_surfaces import HomeSurfaces

FAILURES_PER_PROGRAM = 40  # failed furnishings before another program is drawn; only if the caller passed none


@dataclass(frozen=True)
class HomeDesign:
    """A complete home, before it has meshes and a file format.

    Attributes:
        plan: Storeys with their rooms and openings.
        surfaces: Materials of every room of every storey.
        objects: Objects of every storey, openings first; heights are relative to the storey's base.
    """

    plan: HomePlan
    surfaces: tuple[tuple[RoomSurfaces, ...], ...]
    objects: tuple[tuple[OwnedObject, ...], ...]


def draw_design(seed: int, program: RoomProgram | None = None, preset: Preset = PRESETS["home"]) -> HomeDesign:
    """Return the design of a seed.

    Args:
        seed: Any non-negative integer.
        program: Room program to build; None draws one of the preset.
        preset: Size and equipment of the home.

    Raises:
        ConfigError: No plan was found for the program.

    Example:
        >>> {room.type for room in draw_design(7).plan.levels[0].rooms} >= {"Kitchen", "Bathroom"}
        True
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 2]))
    wanted = draw_program(rng, preset.room_counts) if program is None else program
    failed = 0
    while True:
        try:
            plan, style = draw_home(rng, wanted, preset.is_plain), HomeStyle.draw(rng, preset.equipment)
        except ConfigError:
            if program is not None:
                raise
            wanted = draw_program(rng, preset.room_counts)  # for some programs no plan exists
            continue
        furniture = furnish_home(plan, style)
        if furniture is not None:
            looks: dict[str, tuple[Material, ...]] = {}
            objects = []
            for level, rooms in enumerate(furniture):
                inside = [(placed, room) for room, items in enumerate(rooms) for placed in items]
                own = _assign_materials(
                    [*_opening_objects(plan.levels[level]), *place_fittings(plan, level, style)], style, looks
                )
                objects.append((*own, *inside))
            cladding = HomeSurfaces(rng, choose_random(FACADES, rng))
            surfaces = tuple(
                tuple(cladding.draw_room_surfaces(room.type) for room in level.rooms) for level in plan.levels
            )
            return HomeDesign(plan, surfaces, tuple(objects))
        failed += 1
        if program is None and failed % FAILURES_PER_PROGRAM == 0:
            wanted = draw_program(rng, preset.room_counts)


def _opening_objects(plan: LevelPlan) -> Iterator[OwnedObject]:
    for opening in plan.openings:
        yield opening.object, opening.rooms[0]


def _assign_materials(
    objects: list[OwnedObject], style: HomeStyle, looks: dict[str, tuple[Material, ...]]
) -> Iterator[OwnedObject]:
    """Generate the objects with materials for their slots; a model has the same all over the home, kept in `looks`."""
    for placed, room in objects:
        if placed.model.id not in looks:
            looks[placed.model.id] = style.draw_materials(placed.model)
        yield replace(placed, materials=looks[placed.model.id]), room
