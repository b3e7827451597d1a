"""Dining sets and dining rooms."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.floor_placement import add_at_wall, place_freely, place_object
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.seats import chairs_around, seat_places
from home_procgen.furnish.space.top_placement import place_on_top, place_on_top_at, place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_kind, hang_pictures

CHAIR_MARGIN = 0.3  # [m], width around a table that its chairs need
PLATE_INSET = 0.22  # [m], from the edge of a table to the middle of a plate
CENTREPIECES = ("table_vase", "fruit_bowl", "candle", "small_plant", "cake", "jug", "teapot", "food", "bread")
LEFTOVERS = (
    *(("cup", 0.35), ("magazine", 0.2), ("plates", 0.25), ("glass", 0.3), ("bottle", 0.25), ("book", 0.15)),
    *(("laptop", 0.1), ("cellphone", 0.15), ("bread", 0.1), ("jug", 0.15), ("candle", 0.15), ("books", 0.1)),
)
ON_SIDEBOARD = (
    *(("table_vase", 0.45), ("candle", 0.4), ("photo", 0.35), ("plates", 0.3), ("teapot", 0.3), ("figure", 0.3)),
    *(("bottle", 0.3), ("glass", 0.3), ("fruit_bowl", 0.25), ("bedside_lamp", 0.3), ("radio", 0.3), ("jug", 0.2)),
)


def place_dining_set(room: RoomSpace, seats: int) -> PlacedModel | None:
    """Place a table with chairs around it, or a smaller one if it does not fit; None if none fits."""
    chair = room.draw_object("chair")
    for kind, number in (("dining_table", seats), ("dining_table", 4), ("table", 4), ("table", 2)):
        for item in room.object_candidates(kind):
            if item.size[1] > 0.85:
                continue
            if table := place_freely(
                room, item, lambda anchor, n=number: chairs_around(room, anchor, chair, n), around=CHAIR_MARGIN
            ):
                if room.draw_chance(0.3):
                    place_object(
                        room, room.draw_object("large_rug").moved_to(table.position[0], FLOOR_TOP, table.position[2])
                    )
                _set_table(room, table, number)
                return table
    return None


def _set_table(room: RoomSpace, table: PlacedModel, seats: int) -> None:
    """Place objects on a table: settings for a meal, or leftover objects."""
    if room.draw_chance(0.75):
        kind = str(room.rng.choice(CENTREPIECES, p=_normalize_weights((4, 3, 2, 2, 0.5, 0.7, 0.7, 0.6, 0.6))))
        place_on_top(room, table, kind, middle=True)
    if room.draw_chance(0.35):
        item = room.draw_object(str(room.rng.choice(["place_setting", "place_setting", "plates"])))
        for x, z, way in seat_places(table, seats):
            ix, iz = x - PLATE_INSET * np.sin(way), z - PLATE_INSET * np.cos(way)
            place_on_top_at(room, table, item, float(ix), float(iz), way)
    else:
        place_several_on_top(room, table, LEFTOVERS, 3)


def _normalize_weights(weights: Sequence[float]) -> list[float]:
    return (np.array(weights) / np.sum(weights)).tolist()


def furnish_dining_room(room: RoomSpace) -> None:
    """Place a table for four to eight; at random a sideboard, cabinets, seats, plants, lamps and pictures."""
    furnish_windows(room, ("long_curtain", "short_curtain", ""), 0.5)
    place_dining_set(room, int(room.rng.choice([4, 6, 6, 8])))
    place_several_on_top(room, add_at_wall(room, "dresser", 0.5, 0.85), ON_SIDEBOARD, 4)
    add_at_wall(room, "glass_cabinet", 0.5, 0.45)
    add_at_wall(room, "bookshelf", 0.5, 0.25)
    add_at_wall(room, "bar_cart", 0.3, 0.2)
    for kind, probability in (("wine_rack", 0.12), ("two_seater", 0.15), ("small_fridge", 0.08), ("armchair", 0.1)):
        add_at_wall(room, kind, 0.3, probability)
    for kind, probability in (("slim_plant", 0.5), ("floor_lamp", 0.25), ("tall_clock", 0.1)):
        add_at_wall(room, kind, 0.0, probability)
    hang_kind(room, "wall_clock", 1.65, 0.3)
    for _ in range(2):
        hang_kind(room, "indoor_wall_lamp", 1.65, 0.3)
    hang_pictures(room, 4)
