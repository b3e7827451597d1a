"""Bedrooms and offices."""

from collections.abc import Iterator, Sequence
from functools import partial

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.v1.furnish.common import add, chance, fit
from home_procgen.v1.furnish.layout import RoomLayout


def bedroom(room: RoomLayout, bed: str = "double_bed") -> None:
    """A bed between nightstands, a wardrobe, and what else fits."""
    _bed(room, bed)
    add(room, "wardrobe", 0.6)
    add(room, "dresser", 0.5, 0.6, top="television" if chance(room, 0.4) else "vase")
    _desk(room, 0.4)
    add(room, "armchair", 0.3, 0.3)
    add(room, "bookshelf", 0.4, 0.3)


def _bed(room: RoomLayout, family: str) -> None:
    """A bed with a nightstand on each side, on one, or on none; a rug at its foot."""
    stand = room.style.object("nightstand")
    for sides in ((-1, 1), (-1,), (1,), ()):
        companions = partial(_stands, stand=stand, sides=sides)
        bed = fit(room, family, lambda item, c=companions: room.against_wall(item, 0.45, c))
        if bed:
            for item in [item for item in room.items if item.model is stand.model]:
                room.on_top(item, room.style.object("table_lamp"))
            x, z = bed.local_point(0.0, 0.55 * float(bed.size[2]))
            room.place(room.style.object("rug").moved_to(x, FLOOR_TOP, z, bed.quarter))
            return


def _stands(bed: PlacedModel, stand: PlacedModel, sides: Sequence[int]) -> Iterator[PlacedModel]:
    for side in sides:
        right = side * float(bed.size[0] / 2 + stand.size[0] / 2 + 0.04)
        x, z = bed.local_point(right, float(stand.size[2] - bed.size[2]) / 2)
        yield stand.moved_to(x, FLOOR_TOP, z, bed.quarter)


def _desk(room: RoomLayout, probability: float = 1.0) -> None:
    """A desk with a chair before it, a laptop and a lamp on it."""
    if not chance(room, probability):
        return
    chair = room.style.object("office_chair")

    def companions(desk: PlacedModel) -> Iterator[PlacedModel]:
        x, z = desk.local_point(-0.1, float(desk.size[2] + chair.size[2]) / 2 + 0.04)
        yield chair.moved_to(x, FLOOR_TOP, z, desk.quarter + 2)

    if desk := fit(room, "desk", lambda item: room.against_wall(item, companions=companions)):
        for family in ("laptop", "table_lamp"):
            room.on_top(desk, room.style.object(family))


def child_room(room: RoomLayout) -> None:
    """A small bed, a desk, toys' shelves and a round rug."""
    _bed(room, "single_bed")
    _desk(room, 0.9)
    add(room, "wardrobe", 0.5)
    add(room, "shelving", 0.4, 0.8)
    room.freely(room.style.object("round_rug"))


def guest_room(room: RoomLayout) -> None:
    """A bed, a wardrobe and an armchair."""
    _bed(room, str(room.rng.choice(["double_bed", "single_bed"])))
    add(room, "wardrobe", 0.6)
    add(room, "armchair", 0.3, 0.7)
    add(room, "side_table", probability=0.5, top="vase")


def office(room: RoomLayout) -> None:
    """A desk and shelves."""
    _desk(room)
    for probability in (1.0, 0.7):
        add(room, "bookshelf", 0.5, probability)
    add(room, "armchair", 0.3, 0.5)
    add(room, "shelving", 0.4, 0.4)
    add(room, "trash_can", probability=0.7)
    room.freely(room.style.object("rug"))
