"""Desks, and offices."""

from collections.abc import Iterator

import numpy as np

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.corners import in_corner
from home_procgen.furnish.space.hung import hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import on_top, some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.seats import seated
from home_procgen.furnish.space.spots import add, against_wall, clear_of, fit, freely, place, scattered
from home_procgen.furnish.space.turned import turned

ON_DESK = (
    *(("desk_lamp", 0.75), ("books", 0.4), ("cup", 0.45), ("book", 0.4), ("photo", 0.3), ("small_plant", 0.3)),
    *(("telephone", 0.2), ("headphones", 0.25), ("cellphone", 0.25), ("ipad", 0.15), ("table_clock", 0.2)),
    *(("box_speaker", 0.15), ("figure", 0.15), ("glass", 0.2), ("table_fan", 0.06), ("magazine", 0.15)),
)


def desk(room: Room, kind: str = "plain_desk") -> PlacedFurniture | None:
    """Place a desk at a wall with a chair, a computer and small objects; None if it does not fit."""
    chair = room.object("office_chair" if room.chance(0.8) else "chair")

    def companions(placed: PlacedFurniture) -> Iterator[PlacedFurniture]:
        yield from list(seated(room, placed, chair, 2))[:1]

    placed = fit(room, kind, lambda item: against_wall(room, item, companions=companions))
    return None if placed is None else _used(room, placed)


def corner_desk(room: Room) -> PlacedFurniture | None:
    """Place a desk along two walls, with a chair between its wings that faces the corner; None if it does not fit."""
    chair = room.object("office_chair")

    def companions(placed: PlacedFurniture) -> Iterator[PlacedFurniture]:
        hand = -1.0 if placed.mirrored else 1.0
        for away in (0.2, 0.28, 0.36, 0.44, 0.52, 0.6):
            x, z = placed.beside(hand * away, away)
            turn = placed.quarter * np.pi / 2 + float(np.arctan2(-hand, -1.0))
            spot = turned(chair, x, FLOOR_TOP, z, turn)
            if clear_of(spot, (placed,)):
                yield spot
                return

    placed = fit(room, "corner_desk", lambda item: in_corner(room, item, 0.0, companions))
    return None if placed is None else _used(room, placed)


def _used(room: Room, placed: PlacedFurniture) -> PlacedFurniture:
    """Place a computer and small objects on a desk."""
    machine = "computer" if room.chance(0.4) else "laptop"
    if on_top(room, placed, machine, straight=machine == "computer", middle=True) and machine == "computer":
        _tower(room, placed)
    some(room, placed, ON_DESK, 1 + int(room.rng.integers(4)))
    if room.chance(0.5):
        scattered_bin(room, placed)
    return placed


def _tower(room: Room, placed: PlacedFurniture) -> None:
    """Place a computer tower below or beside the desk, at random."""
    if room.chance(0.6):
        tower = room.object("computer_tower")
        for right in (0.35, -0.35, 0.9, -0.9):
            x, z = placed.beside(right * float(placed.size[0]), 0.0)
            if place(room, tower.at(x, FLOOR_TOP, z, placed.quarter)):
                return


def scattered_bin(room: Room, placed: PlacedFurniture) -> None:
    """Place a paper bin beside a desk."""
    item = room.object("paper_bin")
    for side in (-1, 1):
        x, z = placed.beside(side * float(placed.size[0] / 2 + item.size[0] / 2 + 0.05), 0.0)
        if place(room, item.at(x, FLOOR_TOP, z)):
            return


def office(room: Room) -> None:
    """Place a desk and shelves; sometimes a second desk, an armchair and a whiteboard."""
    windows(room, ("short_curtain", "short_curtain", "long_curtain", ""), 0.5)
    if not (room.chance(0.35) and corner_desk(room)) and not desk(room):
        return
    if room.plan.area > 11 and room.chance(0.25):
        desk(room, "small_desk")
    for probability in (0.95, 0.6):
        add(room, "bookshelf", 0.5, probability)
    add(room, "armchair", 0.3, 0.35)
    for kind, probability in (("dresser", 0.25), ("open_shelf", 0.25)):
        some(room, add(room, kind, 0.35, probability), (("books", 0.5), ("figure", 0.5), ("photo", 0.4)), 2)
    if room.likes("music", 0.3):
        add(room, str(room.rng.choice(["keyboard", "guitar", "microphone"])), 0.4)
    for kind, probability in (("slim_plant", 0.5), ("safe", 0.1), ("tripod", 0.08), ("floor_lamp", 0.2)):
        add(room, kind, 0.0, probability)
    if room.chance(0.3):
        freely(room, room.object("large_rug"))
    if room.chance(0.3):
        scattered(room, "paper_bin")
    hang_kind(room, "wall_whiteboard", 0.95, 0.25)
    hang_kind(room, "wall_clock", 1.65, 0.4)
    hang_kind(room, "wall_shelf", 1.4, 0.4)
    hang_kind(room, "wall_cooler", 2.05, 0.2)
    pictures(room, 2)
