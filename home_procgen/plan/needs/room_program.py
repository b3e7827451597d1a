"""Requirements of each type of room: size, shape, and its role in the plan."""

from typing import NamedTuple


class Want(NamedTuple):
    """Size and shape that a type of room requires."""

    low: float  # [m^2], range of the area
    high: float
    side: float  # [m], minimum length of the shorter side
    aspect: float  # maximum ratio of the longer to the shorter side
    zone: float  # 0: guest area, 1: sleeping area; neighbouring rooms have similar zones


WANTS = {
    "Living_Room": Want(18, 32, 3.5, 2.0, 0.0),
    "Kitchen": Want(8.5, 15, 2.4, 2.2, 0.15),
    "Dining_Room": Want(10.5, 17, 2.9, 1.9, 0.08),
    "Bedroom": Want(11, 18, 2.8, 1.8, 0.9),
    "Child_Room": Want(9.5, 14, 2.6, 1.8, 0.95),
    "Guest_Room": Want(10, 14, 2.6, 1.8, 0.7),
    "Office": Want(7.5, 13, 2.4, 1.9, 0.5),
    "Bathroom": Want(5, 8.5, 1.9, 2.3, 0.75),
    "Toilet": Want(2.1, 3.6, 1.3, 2.5, 0.4),
    "Storage": Want(2.6, 6, 1.4, 2.5, 0.45),
    "Wardrobe": Want(3.5, 6.5, 1.6, 2.4, 0.85),
    "Garage": Want(17, 34, 3.1, 2.6, -0.1),
    "Gym": Want(11, 19, 2.8, 1.9, 0.6),
    "Boiler_room": Want(3.2, 6.5, 1.6, 2.4, 0.35),
    "Entryway": Want(3.6, 7, 1.7, 2.4, 0.3),
}
SMALL = ("Toilet", "Storage", "Wardrobe", "Boiler_room")  # may have a nook of their neighbour behind them
ROOMY = ("Living_Room", "Kitchen", "Bedroom", "Child_Room", "Guest_Room", "Office", "Dining_Room", "Gym")
OUTDOORS = ("Balcony", "Loggia", "Terrace")
WET = ("Bathroom", "Toilet")
WINDOWLESS = ("Storage", "Wardrobe", "Boiler_room", *OUTDOORS)

# Types that other rooms can be reached through, in order of preference; all others are leaves of the door graph.
LINKS = ("Hallway", "Hall", "Lobby", "Entryway", "Living_Room", "Dining_Room", "Kitchen")
TO_PRIVATE = LINKS[:6]  # a kitchen has no door to a private room
