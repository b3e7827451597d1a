"""Furnishing of a home, storey by storey."""

import math
from collections.abc import Iterator, Sequence

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.furnish.recipes import ESSENTIAL_CLASSES, RECIPES
from home_procgen.furnish.rooms.kitchen import MIN_WORKTOP, worktop_length
from home_procgen.furnish.small_objects import add_small_objects
from home_procgen.furnish.space.floor_placement import add_at_wall
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_on_top
from home_procgen.furnish.space.wall_placement import hang_from_ceiling, hang_kind, place_sockets, place_switches
from home_procgen.plan.home import HomePlan
from home_procgen.plan.openings.passage import landing_points
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.style import HomeStyle

MAX_ROOM_ATTEMPTS = 3  # maximum attempts to furnish one room
BATHING_CLASSES = ("bathtub", "shower")
LAMP_OFFSETS = ((0.0, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5))  # [m], offsets from the middle of a room
FIXED_LAMPS = ("chandelier", "wall_lamp")  # fine classes of lamps at ceilings and walls
WALL_LAMP_HEIGHT = 1.75  # [m], underside of a lamp on the wall of a room without another lamp
LONG_ROOM_TYPES = ("Hallway", "Hall", "Lobby")
LAMP_SPACING = 4.5  # [m], maximum distance between lamps along a hall
GRAND_ROOM_TYPES = (
    "Living_Room",
    "Bedroom",
    "Dining_Room",
    "Hall",
    "Lobby",
    "Guest_Room",
)  # may have chandeliers and fans
MIN_CHANDELIER_AREA = 22.0  # [m^2]
RADIO_STANDS = ("tv_stand", "dresser", "nightstand", "desk", "side_table", "shoes_cabinet", "coffee_table")

HomeFurniture = tuple[tuple[tuple[PlacedModel, ...], ...], ...]  # by storey and room


def furnish_home(home: HomePlan, style: HomeStyle) -> HomeFurniture | None:
    """Return the furniture of every room of every storey; None if the plan cannot be furnished.

    Every room needs its essential objects. The home needs a tub or a shower, and a radio or a loudspeaker.
    """
    levels: list[list[RoomSpace]] = []
    for number in range(len(home.levels)):
        rooms = []
        for index in range(len(home.levels[number].rooms)):
            room = _furnish_room(home, number, index, style)
            if room is None:
                return None
            rooms.append(room)
        levels.append(rooms)
    everywhere = [room for rooms in levels for room in rooms]
    if not _has_bath(everywhere) or not _ensure_radio(everywhere, style):
        return None
    return tuple(tuple(tuple(room.items) for room in rooms) for rooms in levels)


def _empty_room(home: HomePlan, level: int, index: int, style: HomeStyle) -> RoomSpace:
    return RoomSpace(home.levels[level], index, style, home.stairwell(level) if index == 0 else None)


def _furnish_room(home: HomePlan, level: int, index: int, style: HomeStyle) -> RoomSpace | None:
    """Return a furnished room; None if its essential objects do not fit."""
    for _ in range(MAX_ROOM_ATTEMPTS):
        room = _empty_room(home, level, index, style)
        outdoors = room.kind in OUTDOOR_TYPES
        fitted = not outdoors and style.equipment.has_fittings
        if fitted:
            place_switches(room)
        RECIPES[room.kind](room)
        if _is_usable(room) and (outdoors or _place_lamps(room)):
            if fitted:
                place_sockets(room)
            if not outdoors:
                add_small_objects(room)
            return room
    return None


def _is_usable(room: RoomSpace) -> bool:
    """Return whether a room has its essential objects, and a kitchen enough worktop."""
    if room.kind == "Kitchen" and worktop_length(room.items) < MIN_WORKTOP:
        return False
    needed = ESSENTIAL_CLASSES.get(room.kind)
    return needed is None or any(item.model.fine in needed for item in room.items)


def _place_lamps(room: RoomSpace) -> bool:
    """Place lamps in the middle of the room, above a dining table, before stairs, and in each part of long halls.

    Return whether the room has a lamp. One is on a wall if nothing fits at the ceiling, or a fan is there.
    """
    if room.stairs is not None:
        any(hang_from_ceiling(room, room.draw_object("ceiling_lamp"), x, z) for x, z in landing_points(room.stairs))
    tables = [item for item in room.items if item.model.fine == "dining_table"]
    over = tables and hang_from_ceiling(room, room.draw_object("pendant"), tables[0].position[0], tables[0].position[2])
    if over and room.kind != "Living_Room":
        return True
    kind = "ceiling_lamp"
    if room.kind in GRAND_ROOM_TYPES and room.height > 2.55:
        options = ["ceiling_lamp", "ceiling_lamp", "pendant"]
        options += ["ceiling_fan"] * (room.kind not in LONG_ROOM_TYPES)
        kind = str(room.rng.choice([*options, "chandelier"] if room.plan.area > MIN_CHANDELIER_AREA else options))
    for x, z in _lamp_places(room):
        any(
            hang_from_ceiling(room, room.draw_object(k), x + dx, z + dz)
            for k in (kind, "ceiling_lamp")
            for dx, dz in LAMP_OFFSETS
        )
    fixed = any(item.model.fine in FIXED_LAMPS for item in room.items)
    return fixed or hang_kind(room, "indoor_wall_lamp", WALL_LAMP_HEIGHT) is not None


def _lamp_places(room: RoomSpace) -> Iterator[tuple[float, float]]:
    """Generate the places (x, z) of lamps at the ceiling [m]: one, or several in each part of a hall."""
    for rect in room.plan.rects[: 2 if room.kind in LONG_ROOM_TYPES else 1]:
        wide, deep = rect.extents
        count = math.ceil(max(wide, deep) / LAMP_SPACING) if room.kind in LONG_ROOM_TYPES else 1
        for i in range(count):
            share = (i + 0.5) / count
            yield rect.x0 + wide * (share if wide > deep else 0.5), rect.z0 + deep * (0.5 if wide > deep else share)


def _has_bath(rooms: Sequence[RoomSpace]) -> bool:
    """Return whether the home has a tub or a shower."""
    return any(item.model.fine in BATHING_CLASSES for room in rooms for item in room.items)


def _ensure_radio(rooms: Sequence[RoomSpace], style: HomeStyle) -> bool:
    """Ensure an audio device, by a radio on furniture or else a loudspeaker; return whether the home has one."""
    if any(item.model.fine == "loudspeaker" for room in rooms for item in room.items):
        return True
    order = [rooms[i] for i in style.rng.permutation(len(rooms)) if rooms[i].kind not in OUTDOOR_TYPES]
    for room in order:
        for anchor in [item for item in room.items if item.model.family in RADIO_STANDS]:
            if place_on_top(room, anchor, "radio"):
                return True
    return any(add_at_wall(room, "floor_speaker") for room in order)
