"""Requirements of each type of room: size, shape, and its role in the plan."""

from typing import NamedTuple


class RoomRequirements(NamedTuple):
    """Size and shape that a type of room requires."""

    min_area: float  # [m^2], range of the area
    max_area: float
    min_side: float  # [m], minimum length of the shorter side
    max_aspect: float  # maximum ratio of the longer to the shorter side
    zone: float  # 0: guest area, 1: sleeping area; neighbouring rooms have similar zones


ROOM_REQUIREMENTS = {
    "Living_Room": RoomRequirements(18, 32, 3.5, 2.0, 0.0),
    "Kitchen": RoomRequirements(8.5, 15, 2.4, 2.2, 0.15),
    "Dining_Room": RoomRequirements(10.5, 17, 2.9, 1.9, 0.08),
    "Bedroom": RoomRequirements(11, 18, 2.8, 1.8, 0.9),
    "Child_Room": RoomRequirements(9.5, 14, 2.6, 1.8, 0.95),
    "Guest_Room": RoomRequirements(10, 14, 2.6, 1.8, 0.7),
    "Office": RoomRequirements(7.5, 13, 2.4, 1.9, 0.5),
    "Bathroom": RoomRequirements(5, 8.5, 1.9, 2.3, 0.75),
    "Toilet": RoomRequirements(2.1, 3.6, 1.3, 2.5, 0.4),
    "Storage": RoomRequirements(2.6, 6, 1.4, 2.5, 0.45),
    "Wardrobe": RoomRequirements(3.5, 6.5, 1.6, 2.4, 0.85),
    "Garage": RoomRequirements(17, 34, 3.1, 2.6, -0.1),
    "Gym": RoomRequirements(11, 19, 2.8, 1.9, 0.6),
    "Boiler_room": RoomRequirements(3.2, 6.5, 1.6, 2.4, 0.35),
    "Entryway": RoomRequirements(3.6, 7, 1.7, 2.4, 0.3),
}
SMALL_TYPES = ("Toilet", "Storage", "Wardrobe", "Boiler_room")  # may have a nook of their neighbour behind them
ROOMY_TYPES = ("Living_Room", "Kitchen", "Bedroom", "Child_Room", "Guest_Room", "Office", "Dining_Room", "Gym")
OUTDOOR_TYPES = ("Balcony", "Loggia", "Terrace")
WET_TYPES = ("Bathroom", "Toilet")
WINDOWLESS_TYPES = ("Storage", "Wardrobe", "Boiler_room", *OUTDOOR_TYPES)

# Types that other rooms can be reached through, in order of preference; all others are leaves of the door graph.
CONNECTING_TYPES = ("Hallway", "Hall", "Lobby", "Entryway", "Living_Room", "Dining_Room", "Kitchen")
PRIVATE_ACCESS_TYPES = CONNECTING_TYPES[:6]  # a kitchen has no door to a private room
