"""Kitchens."""

from collections.abc import Sequence

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import PRISM_THICKNESS
from home_procgen.v1.furnish.common import add, chance
from home_procgen.v1.furnish.dining import dining_set
from home_procgen.v1.furnish.layout import GAP, RoomLayout, zone_before

HANGING_Y = 1.5  # [m], bottom of wall cabinets
ROWS = (
    ("refrigerator", "kitchen_cabinet", "kitchen_sink", "kitchen_cabinet", "cooker", "kitchen_cabinet"),
    ("refrigerator", "kitchen_cabinet", "kitchen_sink", "kitchen_cabinet", "cooker"),
    ("refrigerator", "kitchen_sink", "kitchen_cabinet", "cooker"),
    ("refrigerator", "kitchen_sink", "cooker"),
    ("kitchen_sink", "cooker"),
)


def kitchen(room: RoomLayout) -> None:
    """A row of units along one wall, wall cabinets above, and a place to eat."""
    row = next((row for families in ROWS if (row := _row(room, families))), None)
    if row is None:
        add(room, "cooker", 0.6)
    else:
        _above(room, row)
    families = [item.model.family for item in room.items]
    if "kitchen_cabinet" in families:
        room.on_top(room.items[families.index("kitchen_cabinet")], room.style.object("microwave"))
    if "refrigerator" not in families:
        add(room, "refrigerator", 0.6)
    dining_set(room, 4)
    add(room, "trash_can", probability=0.8)


def _row(room: RoomLayout, families: Sequence[str]) -> list[PlacedModel] | None:
    """Objects side by side along one wall, in the given or the reverse order, with free floor before them."""
    items = [room.style.object(family) for family in families]
    if chance(room, 0.5):
        items.reverse()
    total = float(sum(item.size[0] for item in items))
    walls = [wall for wall in room.room.walls if wall.length >= total + 2 * (PRISM_THICKNESS + GAP)]
    for index in room.rng.permutation(len(walls)):
        wall = walls[index]
        slack = wall.length - total - 2 * (PRISM_THICKNESS + GAP)
        for share in (0.0, 1.0, 0.5, 0.25, 0.75):
            along = wall.span[0] + PRISM_THICKNESS + GAP + share * slack
            row = []
            for item in items:
                row.append(room.backed(item, wall, along + float(item.size[0]) / 2))
                along += float(item.size[0])
            if room.put(row, [zone_before(item, 0.7) for item in row]):
                return row
    return None


def _above(room: RoomLayout, row: Sequence[PlacedModel]) -> None:
    """A hood over the cooker and cabinets over the rest, where no window is."""
    for unit in row:
        if unit.model.family == "refrigerator":
            continue
        hood = unit.model.family == "cooker"
        item = room.style.object("range_hood" if hood else "hanging_cabinet")
        if item.size[0] > unit.size[0] + 0.01:
            continue
        x, z = unit.local_point(0.0, float(item.size[2] - unit.size[2]) / 2)
        room.place(item.moved_to(x, HANGING_Y + 0.1 * hood, z, unit.quarter))
