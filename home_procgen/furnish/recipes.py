"""Recipes and essential objects of each room type."""

from collections.abc import Callable, Mapping

from home_procgen.furnish.rooms.bath import bathroom, toilet
from home_procgen.furnish.rooms.bedroom import bedroom, guest_room
from home_procgen.furnish.rooms.child import child_room
from home_procgen.furnish.rooms.desks import office
from home_procgen.furnish.rooms.dining import dining_room
from home_procgen.furnish.rooms.halls import dressing_room, entryway, hallway, lounge_hall
from home_procgen.furnish.rooms.kitchen import kitchen
from home_procgen.furnish.rooms.living import living_room
from home_procgen.furnish.rooms.outdoors import balcony, terrace
from home_procgen.furnish.rooms.utility import boiler_room, garage, gym, storage
from home_procgen.furnish.space.room import Room

RECIPES: Mapping[str, Callable[[Room], None]] = {
    "Living_Room": living_room,
    "Kitchen": kitchen,
    "Dining_Room": dining_room,
    "Bedroom": bedroom,
    "Child_Room": child_room,
    "Guest_Room": guest_room,
    "Office": office,
    "Bathroom": bathroom,
    "Toilet": toilet,
    "Hallway": hallway,
    "Hall": lounge_hall,
    "Lobby": lounge_hall,
    "Entryway": entryway,
    "Wardrobe": dressing_room,
    "Storage": storage,
    "Boiler_room": boiler_room,
    "Garage": garage,
    "Gym": gym,
    "Balcony": balcony,
    "Loggia": balcony,
    "Terrace": terrace,
}
# Fine classes of each room type, one of which the room must contain.
ESSENTIALS: Mapping[str, tuple[str, ...]] = {
    "Living_Room": ("sofa",),
    "Kitchen": ("sink",),
    "Dining_Room": ("dining_table", "table"),
    "Bedroom": ("double_bed", "single_bed"),
    "Child_Room": ("single_bed", "bunker_bed"),
    "Office": ("desk",),
    "Bathroom": ("toilet",),
    "Toilet": ("toilet",),
}
