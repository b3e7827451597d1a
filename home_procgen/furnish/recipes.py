"""Recipes and essential objects of each room type."""

from collections.abc import Callable, Mapping

from home_procgen.furnish.rooms.bath import furnish_bathroom, furnish_toilet
from home_procgen.furnish.rooms.bedroom import furnish_bedroom, furnish_child_room, furnish_guest_room
from home_procgen.furnish.rooms.desks import furnish_office
from home_procgen.furnish.rooms.dining import furnish_dining_room
from home_procgen.furnish.rooms.halls import (
    furnish_dressing_room,
    furnish_entryway,
    furnish_hallway,
    furnish_lounge_hall,
)
from home_procgen.furnish.rooms.kitchen import furnish_kitchen
from home_procgen.furnish.rooms.living import furnish_living_room
from home_procgen.furnish.rooms.utility import (
    furnish_balcony,
    furnish_boiler_room,
    furnish_garage,
    furnish_gym,
    furnish_storage,
    furnish_terrace,
)
from home_procgen.furnish.space.room_space import RoomSpace

RECIPES: Mapping[str, Callable[[RoomSpace], None]] = {
    "Living_Room": furnish_living_room,
    "Kitchen": furnish_kitchen,
    "Dining_Room": furnish_dining_room,
    "Bedroom": furnish_bedroom,
    "Child_Room": furnish_child_room,
    "Guest_Room": furnish_guest_room,
    "Office": furnish_office,
    "Bathroom": furnish_bathroom,
    "Toilet": furnish_toilet,
    "Hallway": furnish_hallway,
    "Hall": furnish_lounge_hall,
    "Lobby": furnish_lounge_hall,
    "Entryway": furnish_entryway,
    "Wardrobe": furnish_dressing_room,
    "Storage": furnish_storage,
    "Boiler_room": furnish_boiler_room,
    "Garage": furnish_garage,
    "Gym": furnish_gym,
    "Balcony": furnish_balcony,
    "Loggia": furnish_balcony,
    "Terrace": furnish_terrace,
}
# Fine classes of each room type, one of which the room must contain.
ESSENTIAL_CLASSES: Mapping[str, tuple[str, ...]] = {
    "Living_Room": ("sofa",),
    "Kitchen": ("sink",),
    "Dining_Room": ("dining_table", "table"),
    "Bedroom": ("double_bed", "single_bed"),
    "Child_Room": ("single_bed", "bunker_bed"),
    "Office": ("desk",),
    "Bathroom": ("toilet",),
    "Toilet": ("toilet",),
}
