"""Objects on walls and ceilings, and fittings of doors and windows."""

import numpy as np

from home_procgen.floor_plan.placed import FACING, PlacedFurniture
from home_procgen.floor_plan.rooms import Wall
from home_procgen.floor_plan.walls import CEILING_LOW, FLOOR_TOP, HALF
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import GAP, HUNG, along_walls, at_wall, backed, first, place
from home_procgen.style.kinds import models_of

BESIDE_DOOR = 0.12  # [m], from the frame to a switch
SWITCH = 1.05  # [m], height of switches above the floor
ROD = 0.12  # [m], from the top of a window to the top of its curtain
NEAR = 0.003  # [m], maximum deviation of a hanging object from its distance to the wall
OVERHANG = 0.3  # [m], width of curtains beyond the window, both sides together


def hang(room: Room, item: PlacedFurniture, y: float) -> PlacedFurniture | None:
    """Hang an object on a random wall, its bottom at a height above the floor [m]; None if it does not fit."""
    spots, _ = along_walls(room, item, FLOOR_TOP + y, HUNG, 0.4)
    return first(room, item, [spots[i] for i in room.rng.permutation(len(spots)).tolist()])


def hang_kind(room: Room, kind: str, y: float, probability: float = 1.0) -> PlacedFurniture | None:
    """Hang an object of a kind on a wall with a probability; None if it is not placed."""
    return hang(room, room.object(kind), y) if room.chance(probability) else None


def above(room: Room, anchor: PlacedFurniture, item: PlacedFurniture, y: float, shift: float = 0.0) -> bool:
    """Hang an object on the wall behind another; return whether it fits.

    Args:
        room: The room.
        anchor: The object at the wall.
        item: The object to hang.
        y: Height of its bottom above the floor [m].
        shift: Offset of its middle to the right of the anchor's middle [m].
    """
    back = (float(item.size[2] - anchor.size[2])) / 2 - GAP + HUNG
    x, z = anchor.beside(shift, back)
    spot = item.at(x, FLOOR_TOP + y, z, anchor.quarter)
    return any(_at(wall, spot) for wall in room.plan.walls) and place(room, spot) is not None


def _at(wall: Wall, item: PlacedFurniture) -> bool:
    """Return whether the whole back of an object is at a wall."""
    if tuple(wall.normal) != FACING[item.quarter]:
        return False
    along, half = item.position[2 * wall.axis], float(item.size[0]) / 2
    off = (item.position[2 * (1 - wall.axis)] - wall.line) * float(wall.normal[1 - wall.axis])
    near = abs(off - float(item.size[2]) / 2 - HALF - HUNG) < NEAR
    return near and wall.span[0] <= along - half and along + half <= wall.span[1]


def under_ceiling(room: Room, item: PlacedFurniture, x: float, z: float) -> PlacedFurniture | None:
    """Hang an object from the ceiling; None if it does not fit."""
    return place(room, item.at(x, room.height - CEILING_LOW - float(item.size[1]), z))


def wall_behind(room: Room, opening: PlacedFurniture) -> Wall | None:
    """Return the wall of a room that contains an opening; None if it is not an axis-aligned wall of the room."""
    x, z = opening.position[0], opening.position[2]
    for wall in room.plan.walls:
        off, along = abs((x, z)[1 - wall.axis] - wall.line), (x, z)[wall.axis]
        if opening.quarter % 2 == wall.axis and off < HALF and wall.span[0] < along < wall.span[1]:
            return wall
    return None


def switches(room: Room) -> None:
    """Place a switch beside each door, on its handle's side if possible; if none fits, place one at any wall."""
    hung = [_switch(room, door) for door in room.doors]
    if not any(hung):
        hang_kind(room, "switch", SWITCH)


def _switch(room: Room, door: PlacedFurniture) -> PlacedFurniture | None:
    wall = wall_behind(room, door)
    if wall is None:
        return None
    item = room.object("switch")
    latch = float(FACING[door.quarter][1 - wall.axis]) * (-1 if door.mirrored else 1)
    away = float(door.model.size[0]) / 2 + BESIDE_DOOR + float(item.size[0]) / 2
    low, high = wall.span[0] + HALF + float(item.size[0]), wall.span[1] - HALF - float(item.size[0])
    places = [door.position[2 * wall.axis] + side * away for side in (latch, -latch)]
    spots = at_wall(item, wall, [at for at in places if low < at < high], FLOOR_TOP + SWITCH, HUNG)
    return first(room, item, spots)  # rejects places in front of a window


def sockets(room: Room) -> None:
    """Place up to two sockets near the floor."""
    for _ in range(int(room.rng.integers(0, 3))):
        hang(room, room.object("socket"), 0.28)


def curtain(room: Room, window: PlacedFurniture, kind: str) -> bool:
    """Place a curtain or blind at a window, a little wider than the window; return whether it fits."""
    wall = wall_behind(room, window)
    if wall is None:
        return False
    width = float(window.size[0]) + OVERHANG
    top = min(float(window.box[1, 1]) + ROD, room.height - CEILING_LOW - 0.01)
    options = [m for m in models_of(kind) if 0.72 < width / m.size[0] < 1.35 and m.size[1] < top - FLOOR_TOP - 0.01]
    for index in room.rng.permutation(len(options)).tolist():
        plain = room.style.instance(options[index], room.look)
        stretched = PlacedFurniture(
            plain.model,
            plain.position,
            scale=(round(width / float(plain.size[0]), 4), 1.0, 1.0),
            materials=plain.materials,
        )
        y = top - float(plain.size[1])
        spot = backed(stretched, wall, window.position[2 * wall.axis], y, HUNG)
        if spot.box[1, 1] < room.height - CEILING_LOW and place(room, spot, views=False):
            return True
    return False


def radiator(room: Room, window: PlacedFurniture) -> bool:
    """Place a radiator below a window; return whether it fits."""
    wall = wall_behind(room, window)
    spot = None
    if wall is not None:
        spot = backed(room.object("radiator"), wall, window.position[2 * wall.axis], FLOOR_TOP, HUNG)
    return spot is not None and bool(place(room, spot))


def windows(room: Room, kinds: tuple[str, ...], heated: float) -> None:
    """Place curtains or blinds of one kind at all windows of a room, and radiators below some.

    Args:
        room: The room.
        kinds: Kinds of curtains to choose from; "" for none.
        heated: Probability of a radiator below a window.
    """
    if not kinds:
        return
    kind = str(room.rng.choice(kinds))
    for window in room.windows:
        if window.model.fine != "window":
            continue
        if room.chance(heated):
            radiator(room, window)
        if kind and not curtain(room, window, kind):
            curtain(room, window, "short_curtain")


def pictures(room: Room, most: int) -> None:
    """Place pictures and other ornaments on the walls at eye height."""
    for _ in range(int(room.rng.integers(0, most + 1))):
        item = room.object("picture" if room.chance(0.88) else "wall_ornament")
        hang(room, item, float(np.clip(1.6 - float(item.size[1]) / 2, 0.9, 1.5)))
