"""Placement of stairs and railings in the plan of a home."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, quarter_towards
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan, outer_spans
from home_procgen.floor_plan.structure import RAILING_DEPTH, STAIR_LENGTH, STAIR_RISE, STAIR_WIDTH, structure_models
from home_procgen.floor_plan.walls import FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.space.floor_placement import HANGING_GAP
from home_procgen.plan.home import HomePlan
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.plan.shape.storeys import Stairwell
from home_procgen.primitives.family import FurnitureModel
from home_procgen.style import HomeStyle

# [m], height of a lamp's underside, and distance from the front edge: beside the hall's floor, since the middle one of
# three storeys has none in the stairwell
STAIR_LAMP_HEIGHT, STAIR_LAMP_INSET = 2.05, 0.16
STAIR_CLEARANCE = 0.01  # [m], clearance between stairs and walls
RAIL_INSET = 0.03  # [m], inset of railings from the outline towards the room
# [m], from an outline's corners to the ends of railings; railings along z end behind those along x
RAIL_END_INSET_X, RAIL_END_INSET_Z = RAIL_INSET - RAILING_DEPTH / 2, RAIL_INSET + RAILING_DEPTH / 2 + 0.001

OwnedObject = tuple[PlacedModel, int | None]  # an object on a level, and the index of its room; None if it has no room


def place_fittings(home: HomePlan, level: int, style: HomeStyle) -> Iterator[OwnedObject]:
    """Generate the stairs that begin on a level with their rails and lamp, and railings, each with its room's index.

    Stairwells with stairs that end on the level have railings, and so have its open rooms.
    """
    storey = home.storeys[level]
    models = structure_models()
    rails = models["railing"][5:] if style.has_board_railings else models["railing"][:5]
    if storey.stairs_up is not None:
        steps = models["stairs"][int(style.rng.integers(2)) + 2 * storey.stairs_up.ascends_left]
        stairs = _stairs(storey.stairs_up, steps, home.height)
        yield stairs, 0
        yield replace(stairs, model=models["stair_rails"][int(storey.stairs_up.ascends_left)]), 0
        yield _stair_lamp(storey.stairs_up, stairs, style), 0
    if storey.stairs_down is not None and storey.stairs_up is None:
        yield _stairhead_railing(storey.stairs_down, rails), 0
    rooms = home.levels[level].rooms
    for index, room in enumerate(rooms):
        if room.type in OUTDOOR_TYPES:
            for rail in _outdoor_railings(
                room, [w for k, other in enumerate(rooms) if k != index for w in other.walls], rails
            ):
                yield rail, index


def _stairs(place: Stairwell, model: FurnitureModel, height: float) -> PlacedModel:
    """Return stairs stretched to their place, with their front edge at the edge of the hall."""
    x, z = _front_middle(place)
    wide, deep = _size(place)
    scale = (
        (wide - 2 * (PRISM_THICKNESS + STAIR_CLEARANCE)) / STAIR_WIDTH,
        height / STAIR_RISE,
        (deep - PRISM_THICKNESS - STAIR_CLEARANCE) / STAIR_LENGTH,
    )
    quarter = quarter_towards(-place.direction[0], -place.direction[1])
    scale = (round(scale[0], 4), round(scale[1], 4), round(scale[2], 4))
    return PlacedModel(model, (x, FLOOR_TOP, z), quarter, scale)


def _stair_lamp(place: Stairwell, stairs: PlacedModel, style: HomeStyle) -> PlacedModel:
    """Return a lamp on the wall beside the foot of stairs, above the heads of those who climb them."""
    lamp = style.draw_object("round_lamp")
    side = -1.0 if place.ascends_left else 1.0
    right = side * (_size(place)[0] / 2 - PRISM_THICKNESS - HANGING_GAP - float(lamp.size[2]) / 2)
    x, z = stairs.local_point(right, -STAIR_LAMP_INSET)
    return lamp.moved_to(x, FLOOR_TOP + STAIR_LAMP_HEIGHT, z, stairs.quarter - round(side))


def _stairhead_railing(place: Stairwell, models: Sequence[FurnitureModel]) -> PlacedModel:
    """Return the railing beside the head of the stairs, above their foot, along half of the front edge."""
    x, z = _front_middle(place)
    wide = _size(place)[0] - 2 * PRISM_THICKNESS
    middle = (
        np.array([x, z]) + np.array(_foot_direction(place)) * wide / 4 + np.array(place.direction) * RAILING_DEPTH / 2
    )
    return _railing((float(middle[0]), float(middle[1])), wide / 2 - 0.02, place.direction, models)


def _foot_direction(place: Stairwell) -> tuple[float, float]:
    """Return the unit direction (x, z) from the middle of the stairs to their foot: the model's +x or -x."""
    model = structure_models()["stairs"][0]
    return PlacedModel(model, (0.0, 0.0, 0.0), quarter_towards(-place.direction[0], -place.direction[1])).local_point(
        -1.0 if place.ascends_left else 1.0, 0.0
    )


def _front_middle(place: Stairwell) -> tuple[float, float]:
    """Return the middle (x, z) of the stairwell's edge towards the hall [m]."""
    x0, z0, x1, z1 = place.rect
    dx, dz = place.direction
    x, z = (x0 + x1) / 2 - dx * (x1 - x0) / 2, (z0 + z1) / 2 - dz * (z1 - z0) / 2
    return round(x, 6), round(z, 6)


def _size(place: Stairwell) -> tuple[float, float]:
    """Return the stairwell's extents across and along its direction [m]."""
    width, depth = place.rect.extents
    return (width, depth) if place.direction[0] == 0 else (depth, width)


def _outdoor_railings(
    room: RoomPlan, others: Sequence[PlanWall], models: Sequence[FurnitureModel]
) -> Iterator[PlacedModel]:
    """Generate railings along the sides of an open room that no other room shares."""
    for wall in room.walls:
        start, end = (room.rects[0][wall.axis + k] for k in (0, 2))
        inset = RAIL_END_INSET_Z if wall.axis else RAIL_END_INSET_X
        for low, high in outer_spans(wall, others):
            low, high = max(low, start + inset), min(high, end - inset)
            normal = wall.normal
            x, z = wall.point((low + high) / 2, RAIL_INSET)
            yield _railing((x, z), high - low, (round(float(normal[0])), round(float(normal[1]))), models)


def _railing(
    at: tuple[float, float], length: float, facing: tuple[int, int], models: Sequence[FurnitureModel]
) -> PlacedModel:
    """Return a railing with its middle at (x, z) and a length [m], from the model that needs the least stretch."""
    model = min(models, key=lambda m: abs(np.log(length / m.size[0])))
    placed = PlacedModel(model, (0.0, 0.0, 0.0), 0, (round(length / float(model.size[0]), 4), 1.0, 1.0))
    return placed.moved_to(at[0], FLOOR_TOP, at[1], quarter_towards(*facing))
