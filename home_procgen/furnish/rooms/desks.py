"""Desks, and offices."""

from collections.abc import Iterator

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_to
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.corner_placement import place_in_corner
from home_procgen.furnish.space.floor_placement import (
    add_at_wall,
    is_clear_of,
    place_against_wall,
    place_first_fitting,
    place_freely,
    place_object,
    scatter,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.seats import chairs_around
from home_procgen.furnish.space.top_placement import place_on_top, place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_kind, hang_pictures

ON_DESK = (
    *(("desk_lamp", 0.75), ("books", 0.4), ("cup", 0.45), ("book", 0.4), ("photo", 0.3), ("small_plant", 0.3)),
    *(("telephone", 0.2), ("headphones", 0.25), ("cellphone", 0.25), ("ipad", 0.15), ("table_clock", 0.2)),
    *(("box_speaker", 0.15), ("figure", 0.15), ("glass", 0.2), ("table_fan", 0.06), ("magazine", 0.15)),
)


def place_desk(room: RoomSpace, kind: str = "plain_desk") -> PlacedModel | None:
    """Place a desk at a wall with a chair, a computer and small objects; None if it does not fit."""
    chair = room.draw_object("office_chair" if room.draw_chance(0.8) else "chair")

    def companions(placed: PlacedModel) -> Iterator[PlacedModel]:
        yield from list(chairs_around(room, placed, chair, 2))[:1]

    placed = place_first_fitting(room, kind, lambda item: place_against_wall(room, item, companions=companions))
    return None if placed is None else _place_on_desk(room, placed)


def place_corner_desk(room: RoomSpace) -> PlacedModel | None:
    """Place a desk along two walls, with a chair between its wings that faces the corner; None if it does not fit."""
    chair = room.draw_object("office_chair")

    def companions(placed: PlacedModel) -> Iterator[PlacedModel]:
        hand = -1.0 if placed.mirrored else 1.0
        for away in (0.2, 0.28, 0.36, 0.44, 0.52, 0.6):
            x, z = placed.local_point(hand * away, away)
            turn = placed.quarter * np.pi / 2 + float(np.arctan2(-hand, -1.0))
            spot = yaw_to(chair, x, FLOOR_TOP, z, turn)
            if is_clear_of(spot, (placed,)):
                yield spot
                return

    placed = place_first_fitting(room, "corner_desk", lambda item: place_in_corner(room, item, 0.0, companions))
    return None if placed is None else _place_on_desk(room, placed)


def _place_on_desk(room: RoomSpace, placed: PlacedModel) -> PlacedModel:
    """Place a computer and random small objects on a desk, and at random a paper bin beside it; return the desk."""
    machine = "computer" if room.draw_chance(0.4) else "laptop"
    if place_on_top(room, placed, machine, straight=machine == "computer", middle=True) and machine == "computer":
        _place_computer_tower(room, placed)
    place_several_on_top(room, placed, ON_DESK, 1 + int(room.rng.integers(4)))
    if room.draw_chance(0.5):
        place_paper_bin(room, placed)
    return placed


def _place_computer_tower(room: RoomSpace, placed: PlacedModel) -> None:
    """Place a computer tower below or beside the desk, at random."""
    if room.draw_chance(0.6):
        tower = room.draw_object("computer_tower")
        for right in (0.35, -0.35, 0.9, -0.9):
            x, z = placed.local_point(right * float(placed.size[0]), 0.0)
            if place_object(room, tower.moved_to(x, FLOOR_TOP, z, placed.quarter)):
                return


def place_paper_bin(room: RoomSpace, placed: PlacedModel) -> None:
    """Place a paper bin on the left or else the right of a desk, if it fits."""
    item = room.draw_object("paper_bin")
    for side in (-1, 1):
        x, z = placed.local_point(side * float(placed.size[0] / 2 + item.size[0] / 2 + 0.05), 0.0)
        if place_object(room, item.moved_to(x, FLOOR_TOP, z)):
            return


def furnish_office(room: RoomSpace) -> None:
    """Place a desk and, only if it fits, shelves; sometimes a second desk, an armchair and a whiteboard."""
    furnish_windows(room, ("short_curtain", "short_curtain", "long_curtain", ""), 0.5)
    if not (room.draw_chance(0.35) and place_corner_desk(room)) and not place_desk(room):
        return
    if room.plan.area > 11 and room.draw_chance(0.25):
        place_desk(room, "small_desk")
    for probability in (0.95, 0.6):
        add_at_wall(room, "bookshelf", 0.5, probability)
    add_at_wall(room, "armchair", 0.3, 0.35)
    for kind, probability in (("dresser", 0.25), ("open_shelf", 0.25)):
        place_several_on_top(
            room, add_at_wall(room, kind, 0.35, probability), (("books", 0.5), ("figure", 0.5), ("photo", 0.4)), 2
        )
    if room.draw_interest("music", 0.3):
        add_at_wall(room, str(room.rng.choice(["keyboard", "guitar", "microphone"])), 0.4)
    for kind, probability in (("slim_plant", 0.5), ("safe", 0.1), ("tripod", 0.08), ("floor_lamp", 0.2)):
        add_at_wall(room, kind, 0.0, probability)
    if room.draw_chance(0.3):
        place_freely(room, room.draw_object("large_rug"))
    if room.draw_chance(0.3):
        scatter(room, "paper_bin")
    hang_kind(room, "wall_whiteboard", 0.95, 0.25)
    hang_kind(room, "wall_clock", 1.65, 0.4)
    hang_kind(room, "wall_shelf", 1.4, 0.4)
    hang_kind(room, "wall_cooler", 2.05, 0.2)
    hang_pictures(room, 2)
