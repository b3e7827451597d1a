"""What goes into the types of rooms that the first generator does not know, from its models."""

from collections.abc import Callable, Mapping

from home_mjx.datasets.procedural.furnish import RECIPES as KNOWN
from home_mjx.datasets.procedural.furnish.common import add, chance, fit
from home_mjx.datasets.procedural.furnish.layout import RoomLayout
from home_mjx.datasets.procedural.furnish.small import hallway


def bathroom(room: RoomLayout) -> None:
    """A tub or a shower first, then a toilet, a basin under a mirror, a washing machine."""
    for family in room.rng.permutation(["bathtub", "shower"]).tolist():
        if fit(room, family, lambda item: room.against_wall(item, 0.45)):
            break
    add(room, "toilet", 0.4)
    basin = fit(room, str(room.rng.choice(["basin", "vanity"])), lambda item: room.against_wall(item, 0.4))
    if basin:
        mirror = room.style.object("mirror")
        x, z = basin.beside(0.0, float(mirror.size[2] - basin.size[2]) / 2)
        room.place(mirror.at(x, 1.2, z, basin.quarter))
    add(room, "washer", 0.4, 0.5)
    add(room, "trash_can", probability=0.5)


def garage(room: RoomLayout) -> None:
    """Shelves along the walls, a washing machine, a bin: the middle is for the car."""
    for probability in (1.0, 1.0, 0.7, 0.5):
        add(room, "shelving", 0.4, probability)
    add(room, "washer", 0.5, 0.5)
    add(room, "trash_can", probability=0.8)


def gym(room: RoomLayout) -> None:
    """A mirror, a bench, a mat, music."""
    room.hang(room.style.object("mirror"), 0.5)
    add(room, "bench", 0.5)
    add(room, "ottoman", probability=0.6)
    add(room, "shelving", 0.5, 0.6)
    add(room, "speaker", 0.4, 0.7)
    for family in ("rug", "round_rug"):
        room.freely(room.style.object(family))


def boiler_room(room: RoomLayout) -> None:
    """A washing machine, shelves."""
    add(room, "washer", 0.4)
    add(room, "washer", 0.4, 0.4)
    for probability in (1.0, 0.6):
        add(room, "shelving", 0.3, probability)


def outdoors(room: RoomLayout) -> None:
    """Seats and a small table."""
    if chance(room, 0.7) and (table := room.freely(room.style.object("round_table"))):
        room.on_top(table, room.style.object("vase"))
    for probability in (0.8, 0.5):
        add(room, "armchair", 0.2, probability)
    add(room, "bench", 0.2, 0.4)


def lounge(room: RoomLayout) -> None:
    """A hall: where coats and shoes go."""
    hallway(room)
    add(room, "bookshelf", 0.5, 0.3)


RECIPES: Mapping[str, Callable[[RoomLayout], None]] = {
    **KNOWN,
    "Bathroom": bathroom,
    "Garage": garage,
    "Gym": gym,
    "Boiler_room": boiler_room,
    "Balcony": outdoors,
    "Loggia": outdoors,
    "Terrace": outdoors,
    "Hall": lounge,
    "Lobby": lounge,
    "Entryway": hallway,
}
