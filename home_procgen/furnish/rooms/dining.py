"""Dining sets and dining rooms."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.hung import hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import at, on_top, some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.seats import seated, sides
from home_procgen.furnish.space.spots import add, freely, place

AROUND = 0.3  # [m], width around a table that its chairs need
INWARD = 0.22  # [m], from the edge of a table to the middle of a plate
MIDDLE = ("table_vase", "fruit_bowl", "candle", "small_plant", "cake", "jug", "teapot", "food", "bread")
LEFT_OVER = (
    *(("cup", 0.35), ("magazine", 0.2), ("plates", 0.25), ("glass", 0.3), ("bottle", 0.25), ("book", 0.15)),
    *(("laptop", 0.1), ("cellphone", 0.15), ("bread", 0.1), ("jug", 0.15), ("candle", 0.15), ("books", 0.1)),
)
SIDEBOARD = (
    *(("table_vase", 0.45), ("candle", 0.4), ("photo", 0.35), ("plates", 0.3), ("teapot", 0.3), ("figure", 0.3)),
    *(("bottle", 0.3), ("glass", 0.3), ("fruit_bowl", 0.25), ("bedside_lamp", 0.3), ("radio", 0.3), ("jug", 0.2)),
)


def dining_set(room: Room, seats: int) -> PlacedFurniture | None:
    """Place a table with chairs around it, or a smaller one if it does not fit; None if none fits."""
    chair = room.object("chair")
    for kind, number in (("dining_table", seats), ("dining_table", 4), ("table", 4), ("table", 2)):
        for item in room.options(kind):
            if item.size[1] > 0.85:
                continue
            if table := freely(room, item, lambda anchor, n=number: seated(room, anchor, chair, n), around=AROUND):
                if room.chance(0.3):
                    place(room, room.object("large_rug").at(table.position[0], FLOOR_TOP, table.position[2]))
                _laid(room, table, number)
                return table
    return None


def _laid(room: Room, table: PlacedFurniture, seats: int) -> None:
    """Place objects on a table: settings for a meal, or leftover objects."""
    if room.chance(0.75):
        kind = str(room.rng.choice(MIDDLE, p=_odds((4, 3, 2, 2, 0.5, 0.7, 0.7, 0.6, 0.6))))
        on_top(room, table, kind, middle=True)
    if room.chance(0.35):
        item = room.object(str(room.rng.choice(["place_setting", "place_setting", "plates"])))
        for x, z, way in sides(table, seats):
            ix, iz = x - INWARD * np.sin(way), z - INWARD * np.cos(way)
            at(room, table, item, float(ix), float(iz), way)
    else:
        some(room, table, LEFT_OVER, 3)


def _odds(weights: Sequence[float]) -> list[float]:
    return (np.array(weights) / np.sum(weights)).tolist()


def dining_room(room: Room) -> None:
    """Place a table for four to eight, a sideboard, a glass cabinet and pictures."""
    windows(room, ("long_curtain", "short_curtain", ""), 0.5)
    dining_set(room, int(room.rng.choice([4, 6, 6, 8])))
    some(room, add(room, "dresser", 0.5, 0.85), SIDEBOARD, 4)
    add(room, "glass_cabinet", 0.5, 0.45)
    add(room, "bookshelf", 0.5, 0.25)
    add(room, "bar_cart", 0.3, 0.2)
    for kind, probability in (("wine_rack", 0.12), ("two_seater", 0.15), ("small_fridge", 0.08), ("armchair", 0.1)):
        add(room, kind, 0.3, probability)
    for kind, probability in (("slim_plant", 0.5), ("floor_lamp", 0.25), ("tall_clock", 0.1)):
        add(room, kind, 0.0, probability)
    hang_kind(room, "wall_clock", 1.65, 0.3)
    for _ in range(2):
        hang_kind(room, "wall_lamp", 1.65, 0.3)
    pictures(room, 4)
