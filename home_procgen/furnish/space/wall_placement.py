"""Objects on walls and ceilings, and fittings of doors and windows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from home_procgen.floor_plan.placed_model import FRONT_DIRECTIONS, PlacedModel
from home_procgen.floor_plan.rooms import PlanWall
from home_procgen.floor_plan.walls import CEILING_DROP, FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.space.floor_placement import (
    HANGING_GAP,
    WALL_GAP,
    back_against,
    place_at_first,
    place_object,
    room_wall_spots,
    wall_spots,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.primitives.family import FurnitureModel
from home_procgen.style.object_kinds import list_models

SWITCH_DOOR_GAP = 0.12  # [m], from the frame to a switch
SWITCH_HEIGHT = 1.05  # [m], height of switches above the floor
CURTAIN_RISE = 0.12  # [m], from the top of a window to the top of its curtain
MAX_WALL_DEVIATION = 0.003  # [m], maximum deviation of a hanging object from its distance to the wall
CAFE_SHARE = 0.48  # height of a café curtain's rod above the sill, as a share of the window's height
CAFE_DROP = 0.05  # [m], from the sill to the lower edge of a café curtain
RADIATOR_DEPTH = 0.45  # [m], depth of the floor before a radiator that stays free
CURTAIN_OVERHANG = 0.3  # [m], width of curtains beyond the window, both sides together


def hang(room: RoomSpace, item: PlacedModel, y: float) -> PlacedModel | None:
    """Hang an object on a random wall, its bottom at a height above the floor [m]; None if it does not fit."""
    spots, _ = room_wall_spots(room, item, FLOOR_TOP + y, HANGING_GAP, 0.4)
    return place_at_first(room, item, [spots[i] for i in room.rng.permutation(len(spots)).tolist()])


def hang_kind(room: RoomSpace, kind: str, y: float, probability: float = 1.0) -> PlacedModel | None:
    """Hang an object of a kind, its bottom at `y` above the floor [m], with a probability; None if it is not placed."""
    return hang(room, room.draw_object(kind), y) if room.draw_chance(probability) else None


def hang_above(
    room: RoomSpace, anchor: PlacedModel, item: PlacedModel, y: float, shift: float = 0.0, gap: float = HANGING_GAP
) -> bool:
    """Hang an object on the wall behind another; return whether it fits.

    Args:
        room: The room.
        anchor: The object at the wall.
        item: The object to hang.
        y: Height of its bottom above the floor [m].
        shift: Offset of its middle to the right of the anchor's middle [m].
        gap: Distance of its back from the wall [m].
    """
    back = (float(item.size[2] - anchor.size[2])) / 2 - WALL_GAP + gap
    x, z = anchor.local_point(shift, back)
    spot = item.moved_to(x, FLOOR_TOP + y, z, anchor.quarter)
    return any(_is_backed_by(wall, spot, gap) for wall in room.plan.walls) and place_object(room, spot) is not None


def _is_backed_by(wall: PlanWall, item: PlacedModel, gap: float) -> bool:
    """Return whether the whole back of an object is at a distance from a wall [m]."""
    if tuple(wall.normal) != FRONT_DIRECTIONS[item.quarter]:
        return False
    along, half = item.position[2 * wall.axis], float(item.size[0]) / 2
    off = (item.position[2 * (1 - wall.axis)] - wall.line) * float(wall.normal[1 - wall.axis])
    near = abs(off - float(item.size[2]) / 2 - PRISM_THICKNESS - gap) < MAX_WALL_DEVIATION
    return near and wall.span[0] <= along - half and along + half <= wall.span[1]


def ceiling_height(room: RoomSpace) -> float:
    """Return the height of the ceiling above the floor, less a gap of 1 mm [m]."""
    return room.height - CEILING_DROP - FLOOR_TOP - 0.001


def hang_from_ceiling(room: RoomSpace, item: PlacedModel, x: float, z: float) -> PlacedModel | None:
    """Hang an object from the ceiling at (x, z) [m]; None if it does not fit."""
    return place_object(room, item.moved_to(x, room.height - CEILING_DROP - float(item.size[1]), z))


def find_wall(room: RoomSpace, opening: PlacedModel) -> PlanWall | None:
    """Return the wall of a room that contains an opening; None if it is not an axis-aligned wall of the room."""
    x, z = opening.position[0], opening.position[2]
    for wall in room.plan.walls:
        off, along = abs((x, z)[1 - wall.axis] - wall.line), (x, z)[wall.axis]
        if opening.quarter % 2 == wall.axis and off < PRISM_THICKNESS and wall.span[0] < along < wall.span[1]:
            return wall
    return None


def place_switches(room: RoomSpace) -> None:
    """Place a switch beside each door, on its handle's side if possible; if none fits, place one at any wall."""
    hung = [_place_switch(room, door) for door in room.doors]
    if not any(hung):
        hang_kind(room, "switch", SWITCH_HEIGHT)


def _place_switch(room: RoomSpace, door: PlacedModel) -> PlacedModel | None:
    wall = find_wall(room, door)
    if wall is None:
        return None
    item = room.draw_object("switch")
    latch = float(FRONT_DIRECTIONS[door.quarter][1 - wall.axis]) * (-1 if door.mirrored else 1)
    away = float(door.model.size[0]) / 2 + SWITCH_DOOR_GAP + float(item.size[0]) / 2
    low, high = (
        wall.span[0] + PRISM_THICKNESS + float(item.size[0]),
        wall.span[1] - PRISM_THICKNESS - float(item.size[0]),
    )
    places = [door.position[2 * wall.axis] + side * away for side in (latch, -latch)]
    spots = wall_spots(item, wall, [at for at in places if low < at < high], FLOOR_TOP + SWITCH_HEIGHT, HANGING_GAP)
    return place_at_first(room, item, spots)  # rejects places in front of a window


def place_sockets(room: RoomSpace) -> None:
    """Place a random number of sockets, at most two, on walls near the floor."""
    for _ in range(int(room.rng.integers(0, 3))):
        hang(room, room.draw_object("socket"), 0.28)


def place_curtain(room: RoomSpace, window: PlacedModel, options: Sequence[FurnitureModel]) -> bool:
    """Place the first curtain or blind that fits a window, a little wider than it; return whether one fits."""
    wall = find_wall(room, window)
    if wall is None:
        return False
    for model in options:
        if not _suits_width(model, window):
            continue
        plain = room.style.make_object(model, room.look)
        low, high = _curtain_span(room, model, window)
        scale = (round(_curtain_width(window) / float(plain.size[0]), 4), round((high - low) / float(plain.size[1]), 4))
        stretched = replace(plain, scale=(*scale, 1.0))
        spot = back_against(stretched, wall, window.position[2 * wall.axis], low, HANGING_GAP)
        if low > FLOOR_TOP + 0.01 and place_object(room, spot, views=False):
            return True
    return False


def _curtain_width(window: PlacedModel) -> float:
    return float(window.size[0]) + CURTAIN_OVERHANG


def _suits_width(model: FurnitureModel, window: PlacedModel) -> bool:
    """Return whether the curtain needs a stretch between 0.72 and 1.35 in width for the window."""
    return 0.72 < _curtain_width(window) / float(model.size[0]) < 1.35


def _curtain_span(room: RoomSpace, model: FurnitureModel, window: PlacedModel) -> tuple[float, float]:
    """Return the heights of a curtain's lower and upper edge [m]; a café curtain's rod is below half the window."""
    sill, head = window.box[:, 1].tolist()
    if model in list_models("cafe_curtain"):
        return sill - CAFE_DROP, sill + CAFE_SHARE * (head - sill)
    top = min(head + CURTAIN_RISE, room.height - CEILING_DROP - 0.01)
    return top - float(model.size[1]), top


def place_radiator(room: RoomSpace, window: PlacedModel) -> bool:
    """Place a radiator below a window; return whether it fits."""
    wall = find_wall(room, window)
    spot = None
    if wall is not None:
        spot = back_against(room.draw_object("radiator"), wall, window.position[2 * wall.axis], FLOOR_TOP, HANGING_GAP)
    return spot is not None and bool(place_object(room, spot, RADIATOR_DEPTH))


def furnish_windows(room: RoomSpace, kinds: tuple[str, ...], heated: float) -> None:
    """Place curtains or blinds of one kind, or short curtains where it does not fit, and radiators below some windows.

    Args:
        room: The room.
        kinds: Kinds of curtains to choose from, "" for none; without kinds there are no radiators either.
        heated: Probability of a radiator below a window.
    """
    if not kinds or not room.style.equipment.has_fittings:
        return
    windows = [window for window in room.windows if window.model.fine == "window"]
    options = _curtain_options(room, str(room.rng.choice(kinds)), windows)
    for window in windows:
        if room.draw_chance(heated):
            place_radiator(room, window)
        place_curtain(room, window, options)


def _curtain_options(room: RoomSpace, kind: str, windows: Sequence[PlacedModel]) -> list[FurnitureModel]:
    """Return curtains of a kind, then short ones, those first that suit most windows, else at random; none for ""."""
    found: list[FurnitureModel] = []
    for one in (kind, "short_curtain") if kind else ():
        models = list_models(one)
        order = [models[i] for i in room.rng.permutation(len(models)).tolist()]
        found += sorted(order, key=lambda model: -sum(_suits_width(model, window) for window in windows))
    return found


def hang_pictures(room: RoomSpace, max_pictures: int) -> None:
    """Hang a random number, at most `max_pictures`, of pictures and other ornaments on walls at eye height."""
    for _ in range(int(room.style.equipment.extras * int(room.rng.integers(0, max_pictures + 1)))):
        item = room.draw_object("picture" if room.rng.random() < 0.88 else "wall_ornament")
        hang(room, item, float(np.clip(1.6 - float(item.size[1]) / 2, 0.9, 1.5)))
