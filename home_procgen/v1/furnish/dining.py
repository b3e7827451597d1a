"""Tables with chairs, and the rooms made for them."""

from collections.abc import Iterator

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.v1.furnish.common import add
from home_procgen.v1.furnish.layout import RoomLayout


def dining_set(room: RoomLayout, seats: int) -> None:
    """A table with chairs all round, or a smaller one if that does not fit."""
    chair = room.style.object("chair")
    for family, number in (("dining_table", seats), ("round_table", 4), ("round_table", 2)):
        table = room.freely(room.style.object(family), lambda anchor, n=number: _chairs(anchor, chair, n))
        if table:
            room.on_top(table, room.style.object("vase"))
            return


def _chairs(table: PlacedModel, chair: PlacedModel, seats: int) -> Iterator[PlacedModel]:
    """Chairs that face a table from its long sides (right and left of a round one too)."""
    wide, deep = float(table.size[0]), float(table.size[2])
    away = deep / 2 + float(chair.size[2]) / 2 + 0.04
    per_side = 1 if table.model.family == "round_table" else max(1, min(seats // 2, int(wide / 0.62)))
    for side in (-1, 1):
        for i in range(per_side):
            x, z = table.local_point((i - (per_side - 1) / 2) * wide / per_side, side * away)
            yield chair.moved_to(x, FLOOR_TOP, z, table.quarter + (2 if side > 0 else 0))
    if seats > 2 * per_side:
        for side in (-1, 1):
            x, z = table.local_point(side * (wide / 2 + float(chair.size[2]) / 2 + 0.04), 0.0)
            yield chair.moved_to(x, FLOOR_TOP, z, table.quarter - side)


def dining_room(room: RoomLayout) -> None:
    """A table for six, a sideboard, books."""
    dining_set(room, 6)
    add(room, "dresser", 0.5, top="vase")
    add(room, "bookshelf", 0.5, 0.4)
    add(room, "floor_lamp", probability=0.4)
