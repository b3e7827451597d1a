"""Furnishes a home storey by storey."""

from collections.abc import Sequence

from home_mjx.datasets.homes.furnish.layout import HomeLayout
from home_mjx.datasets.homes.furnish.recipes import RECIPES
from home_mjx.datasets.homes.plan.home import HomePlan
from home_mjx.datasets.homes.plan.needs.wants import OUTDOORS
from home_mjx.datasets.procedural.floor_plan.placed import PlacedFurniture
from home_mjx.datasets.procedural.furnish import ESSENTIALS, RADIO_STANDS
from home_mjx.datasets.procedural.furnish.layout import RoomLayout
from home_mjx.datasets.procedural.furnish.style import Style

TRIES = 3  # of furnishing one room
WASHING = ("bathtub", "shower")
LAMPS = ((0.0, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5))  # [m], from the middle of a room

Furnished = tuple[tuple[tuple[PlacedFurniture, ...], ...], ...]  # of every storey, of every room


def furnish_home(home: HomePlan, style: Style) -> Furnished | None:
    """The furniture of every room of every storey; None if the plan does not serve.

    That is if open doors block one another, a room has no place for what it is for, or no bathroom has a tub or a
    shower.
    """
    levels: list[list[HomeLayout]] = []
    for number in range(len(home.levels)):
        layouts = []
        for index in range(len(home.levels[number].rooms)):
            layout = _furnished(home, number, index, style)
            if layout is None:
                return None
            layouts.append(layout)
        levels.append(layouts)
    rooms = [layout for layouts in levels for layout in layouts]
    if not _washes(rooms) or not _radio(rooms, style):
        return None
    return tuple(tuple(tuple(layout.items) for layout in layouts) for layouts in levels)


def _furnished(home: HomePlan, level: int, index: int, style: Style) -> HomeLayout | None:
    """A furnished room; None if it cannot serve."""
    for _ in range(TRIES):
        stairs = home.stairwell(level) if index == 0 else None
        layout = HomeLayout(home.levels[level], index, style, stairs)
        if not layout.passable:
            return None
        RECIPES[layout.room.type](layout)
        needed = ESSENTIALS.get(layout.room.type)
        if needed is None or any(item.model.fine == needed for item in layout.items):
            _finish(layout, style)
            return layout
    return None


def _finish(room: RoomLayout, style: Style) -> None:
    """A lamp and pictures; neither outdoors."""
    if room.room.type in OUTDOORS:
        return
    _lamp(room)
    for _ in range(int(style.rng.integers(0, 3))):
        room.hang(style.object("picture"), float(style.rng.uniform(1.25, 1.45)))


def _lamp(room: RoomLayout) -> None:
    """A lamp in the middle of the room, low above a dining table; in long halls one in each part."""
    tables = [item for item in room.items if item.model.fine == "dining_table"]
    if tables and room.under_ceiling(room.style.object("pendant"), tables[0].position[0], tables[0].position[2]):
        return
    for rect in room.room.rects[: 2 if room.room.type in ("Hallway", "Hall", "Lobby") else 1]:
        x, z = (rect.x0 + rect.x1) / 2, (rect.z0 + rect.z1) / 2
        any(room.under_ceiling(room.style.object("ceiling_lamp"), x + dx, z + dz) for dx, dz in LAMPS)


def _washes(rooms: Sequence[RoomLayout]) -> bool:
    """Whether one bathroom of the home has a tub or a shower."""
    return any(item.model.fine in WASHING for room in rooms for item in room.items)


def _radio(rooms: Sequence[RoomLayout], style: Style) -> bool:
    """One radio in the home: on a piece of furniture, or else a loudspeaker on the floor."""
    order = [rooms[i] for i in style.rng.permutation(len(rooms)) if rooms[i].room.type not in OUTDOORS]
    for room in order:
        for anchor in [item for item in room.items if item.model.family in RADIO_STANDS]:
            if room.on_top(anchor, style.object("radio")):
                return True
    return any(room.against_wall(style.object("speaker")) for room in order)
