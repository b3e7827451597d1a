"""Bathrooms, hallways and closets."""

from home_procgen.v1.furnish.common import add, fit
from home_procgen.v1.furnish.layout import RoomLayout


def bathroom(room: RoomLayout) -> None:
    """A tub or a shower, a basin under a mirror, a toilet, a washing machine."""
    add(room, "toilet", 0.4)
    _basin(room, str(room.rng.choice(["basin", "vanity"])))
    for family in room.rng.permutation(["bathtub", "shower"]).tolist():
        if fit(room, family, lambda item: room.against_wall(item, 0.45)):
            break
    add(room, "washer", 0.4, 0.6)
    add(room, "trash_can", probability=0.5)


def toilet(room: RoomLayout) -> None:
    """A toilet and a basin."""
    add(room, "toilet", 0.35)
    _basin(room, "basin")


def _basin(room: RoomLayout, family: str) -> None:
    basin = fit(room, family, lambda item: room.against_wall(item, 0.4))
    if basin:
        mirror = room.style.object("mirror")
        x, z = basin.local_point(0.0, float(mirror.size[2] - basin.size[2]) / 2)
        room.place(mirror.moved_to(x, 1.2, z, basin.quarter))


def hallway(room: RoomLayout) -> None:
    """Where coats and shoes go."""
    add(room, "shoes_cabinet", 0.35, top="vase")
    add(room, "coat_stand", probability=0.8)
    add(room, "bench", 0.3, 0.5)
    room.hang(room.style.object("mirror"), 0.9)


def storage(room: RoomLayout) -> None:
    """Shelves."""
    for probability in (1.0, 0.8, 0.5):
        add(room, "shelving", 0.3, probability)
    add(room, "washer", 0.4, 0.4)
    add(room, "trash_can", probability=0.4)


def dressing_room(room: RoomLayout) -> None:
    """Wardrobes, a mirror and a stool."""
    for probability in (1.0, 0.8):
        add(room, "wardrobe", 0.5, probability)
    room.hang(room.style.object("mirror"), 0.6)
    add(room, "ottoman", probability=0.6)
