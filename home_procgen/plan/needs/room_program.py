"""The size and shape that each type of room needs, and what it is for the plan."""

from typing import NamedTuple


class Want(NamedTuple):
    """The size and shape that a type of room needs."""

    low: float  # [m^2]
    high: float
    side: float  # [m], shortest side
    aspect: float  # longest side over shortest
    zone: float  # 0: where guests go, 1: where the family sleeps; neighbours have similar ones


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
SMALL = ("Toilet", "Storage", "Wardrobe", "Boiler_room")  # may stand before a nook of their neighbour
ROOMY = ("Living_Room", "Kitchen", "Bedroom", "Child_Room", "Guest_Room", "Office", "Dining_Room", "Gym")
OUTDOORS = ("Balcony", "Loggia", "Terrace")
WET = ("Bathroom", "Toilet")
WINDOWLESS = ("Storage", "Wardrobe", "Boiler_room", *OUTDOORS)

# Rooms through which others are reached, the best for that first; all others are ends of the graph of doors.
LINKS = ("Hallway", "Hall", "Lobby", "Entryway", "Living_Room", "Dining_Room", "Kitchen")
TO_PRIVATE = LINKS[:6]  # from a kitchen no door leads to a private room
