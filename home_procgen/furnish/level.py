"""Furnishing of a home, storey by storey."""

from collections.abc import Sequence

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.furnish.recipes import ESSENTIALS, RECIPES
from home_procgen.furnish.space.hung import sockets, switches, under_ceiling
from home_procgen.furnish.space.on_top import on_top
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add
from home_procgen.plan.home import HomePlan
from home_procgen.plan.needs.room_program import OUTDOORS
from home_procgen.style import Style

TRIES = 3  # maximum attempts to furnish one room
WASHING = ("bathtub", "shower")
LAMPS = ((0.0, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5))  # [m], offsets from the middle of a room
LONG = ("Hallway", "Hall", "Lobby")
GRAND = ("Living_Room", "Bedroom", "Dining_Room", "Hall", "Lobby", "Guest_Room")  # may have chandeliers and fans
RADIO_STANDS = ("tv_stand", "dresser", "nightstand", "desk", "side_table", "shoes_cabinet", "coffee_table")

Furnished = tuple[tuple[tuple[PlacedFurniture, ...], ...], ...]  # by storey and room


def furnish_home(home: HomePlan, style: Style) -> Furnished | None:
    """Return the furniture of every room of every storey; None if the plan cannot be furnished.

    Every room needs its essential objects. The home needs a tub or a shower, and a radio or a loudspeaker.
    """
    levels: list[list[Room]] = []
    for number in range(len(home.levels)):
        rooms = []
        for index in range(len(home.levels[number].rooms)):
            room = _furnished(home, number, index, style)
            if room is None:
                return None
            rooms.append(room)
        levels.append(rooms)
    everywhere = [room for rooms in levels for room in rooms]
    if not _washes(everywhere) or not _radio(everywhere, style):
        return None
    return tuple(tuple(tuple(room.items) for room in rooms) for rooms in levels)


def _empty(home: HomePlan, level: int, index: int, style: Style) -> Room:
    return Room(home.levels[level], index, style, home.stairwell(level) if index == 0 else None)


def _furnished(home: HomePlan, level: int, index: int, style: Style) -> Room | None:
    """Return a furnished room; None if its essential objects do not fit."""
    for _ in range(TRIES):
        room = _empty(home, level, index, style)
        outdoors = room.kind in OUTDOORS
        if not outdoors:
            switches(room)
        RECIPES[room.kind](room)
        needed = ESSENTIALS.get(room.kind)
        if needed is None or any(item.model.fine in needed for item in room.items):
            if not outdoors:
                _lamp(room)
                sockets(room)
            return room
    return None


def _lamp(room: Room) -> None:
    """Place a lamp in the middle of the room, or low above a dining table; in long halls, one in each part."""
    tables = [item for item in room.items if item.model.fine == "dining_table"]
    if tables and under_ceiling(room, room.object("pendant"), tables[0].position[0], tables[0].position[2]):
        return
    kind = "ceiling_lamp"
    if room.kind in GRAND and room.height > 2.55:
        kind = str(room.rng.choice(["ceiling_lamp", "ceiling_lamp", "pendant", "chandelier", "ceiling_fan"]))
    for rect in room.plan.rects[: 2 if room.kind in LONG else 1]:
        x, z = (rect.x0 + rect.x1) / 2, (rect.z0 + rect.z1) / 2
        any(under_ceiling(room, room.object(kind), x + dx, z + dz) for dx, dz in LAMPS)


def _washes(rooms: Sequence[Room]) -> bool:
    """Return whether the home has a tub or a shower."""
    return any(item.model.fine in WASHING for room in rooms for item in room.items)


def _radio(rooms: Sequence[Room], style: Style) -> bool:
    """Ensure one audio device in the home: a radio on a piece of furniture, else a loudspeaker on the floor."""
    if any(item.model.fine == "loudspeaker" for room in rooms for item in room.items):
        return True
    order = [rooms[i] for i in style.rng.permutation(len(rooms)) if rooms[i].kind not in OUTDOORS]
    for room in order:
        for anchor in [item for item in room.items if item.model.family in RADIO_STANDS]:
            if on_top(room, anchor, "radio"):
                return True
    return any(add(room, "floor_speaker") for room in order)
