"""Objects on walls and ceilings, and fittings of doors and windows."""

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
from home_procgen.style.object_kinds import list_models

SWITCH_DOOR_GAP = 0.12  # [m], from the frame to a switch
SWITCH_HEIGHT = 1.05  # [m], height of switches above the floor
CURTAIN_RISE = 0.12  # [m], from the top of a window to the top of its curtain
MAX_WALL_DEVIATION = 0.003  # [m], maximum deviation of a hanging object from its distance to the wall
CURTAIN_OVERHANG = 0.3  # [m], width of curtains beyond the window, both sides together


def hang(room: RoomSpace, item: PlacedModel, y: float) -> PlacedModel | None:
    """Hang an object on a random wall, its bottom at a height above the floor [m]; None if it does not fit."""
    spots, _ = room_wall_spots(room, item, FLOOR_TOP + y, HANGING_GAP, 0.4)
    return place_at_first(room, item, [spots[i] for i in room.rng.permutation(len(spots)).tolist()])


def hang_kind(room: RoomSpace, kind: str, y: float, probability: float = 1.0) -> PlacedModel | None:
    """Hang an object of a kind on a wall with a probability; None if it is not placed."""
    return hang(room, room.draw_object(kind), y) if room.draw_chance(probability) else None


def hang_above(room: RoomSpace, anchor: PlacedModel, item: PlacedModel, y: float, shift: float = 0.0) -> bool:
    """Hang an object on the wall behind another; return whether it fits.

    Args:
        room: The room.
        anchor: The object at the wall.
        item: The object to hang.
        y: Height of its bottom above the floor [m].
        shift: Offset of its middle to the right of the anchor's middle [m].
    """
    back = (float(item.size[2] - anchor.size[2])) / 2 - WALL_GAP + HANGING_GAP
    x, z = anchor.local_point(shift, back)
    spot = item.moved_to(x, FLOOR_TOP + y, z, anchor.quarter)
    return any(_is_backed_by(wall, spot) for wall in room.plan.walls) and place_object(room, spot) is not None


def _is_backed_by(wall: PlanWall, item: PlacedModel) -> bool:
    """Return whether the whole back of an object is at a wall."""
    if tuple(wall.normal) != FRONT_DIRECTIONS[item.quarter]:
        return False
    along, half = item.position[2 * wall.axis], float(item.size[0]) / 2
    off = (item.position[2 * (1 - wall.axis)] - wall.line) * float(wall.normal[1 - wall.axis])
    near = abs(off - float(item.size[2]) / 2 - PRISM_THICKNESS - HANGING_GAP) < MAX_WALL_DEVIATION
    return near and wall.span[0] <= along - half and along + half <= wall.span[1]


def ceiling_height(room: RoomSpace) -> float:
    """Return the height of the ceiling above the floor, less a gap of 1 mm [m]."""
    return room.height - CEILING_DROP - FLOOR_TOP - 0.001


def hang_from_ceiling(room: RoomSpace, item: PlacedModel, x: float, z: float) -> PlacedModel | None:
    """Hang an object from the ceiling; None if it does not fit."""
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
    """Place up to two sockets near the floor."""
    for _ in range(int(room.rng.integers(0, 3))):
        hang(room, room.draw_object("socket"), 0.28)


def place_curtain(room: RoomSpace, window: PlacedModel, kind: str) -> bool:
    """Place a curtain or blind at a window, a little wider than the window; return whether it fits."""
    wall = find_wall(room, window)
    if wall is None:
        return False
    width = float(window.size[0]) + CURTAIN_OVERHANG
    top = min(float(window.box[1, 1]) + CURTAIN_RISE, room.height - CEILING_DROP - 0.01)
    options = [m for m in list_models(kind) if 0.72 < width / m.size[0] < 1.35 and m.size[1] < top - FLOOR_TOP - 0.01]
    for index in room.rng.permutation(len(options)).tolist():
        plain = room.style.make_object(options[index], room.look)
        stretched = PlacedModel(
            plain.model,
            plain.position,
            scale=(round(width / float(plain.size[0]), 4), 1.0, 1.0),
            materials=plain.materials,
        )
        y = top - float(plain.size[1])
        spot = back_against(stretched, wall, window.position[2 * wall.axis], y, HANGING_GAP)
        if spot.box[1, 1] < room.height - CEILING_DROP and place_object(room, spot, views=False):
            return True
    return False


def place_radiator(room: RoomSpace, window: PlacedModel) -> bool:
    """Place a radiator below a window; return whether it fits."""
    wall = find_wall(room, window)
    spot = None
    if wall is not None:
        spot = back_against(room.draw_object("radiator"), wall, window.position[2 * wall.axis], FLOOR_TOP, HANGING_GAP)
    return spot is not None and bool(place_object(room, spot))


def furnish_windows(room: RoomSpace, kinds: tuple[str, ...], heated: float) -> None:
    """Place curtains or blinds of one kind, or short curtains where it does not fit, and radiators below some windows.

    Args:
        room: The room.
        kinds: Kinds of curtains to choose from, "" for none; without kinds there are no radiators either.
        heated: Probability of a radiator below a window.
    """
    if not kinds:
        return
    kind = str(room.rng.choice(kinds))
    for window in room.windows:
        if window.model.fine != "window":
            continue
        if room.draw_chance(heated):
            place_radiator(room, window)
        if kind and not place_curtain(room, window, kind):
            place_curtain(room, window, "short_curtain")


def hang_pictures(room: RoomSpace, max_pictures: int) -> None:
    """Place pictures and other ornaments on the walls at eye height."""
    for _ in range(int(room.rng.integers(0, max_pictures + 1))):
        item = room.draw_object("picture" if room.draw_chance(0.88) else "wall_ornament")
        hang(room, item, float(np.clip(1.6 - float(item.size[1]) / 2, 0.9, 1.5)))
