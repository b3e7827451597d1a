"""What goes into each type of room, and in which order."""

from collections.abc import Callable, Sequence

from home_procgen.floor_plan.openings import LevelPlan
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.v1.furnish.dining import dining_room
from home_procgen.v1.furnish.kitchen import kitchen
from home_procgen.v1.furnish.layout import RoomLayout
from home_procgen.v1.furnish.living import living_room
from home_procgen.v1.furnish.private import bedroom, child_room, guest_room, office
from home_procgen.v1.furnish.small import bathroom, dressing_room, hallway, storage, toilet
from home_procgen.v1.furnish.style import Style

__all__ = ["RECIPES", "furnish"]

RECIPES: dict[str, Callable[[RoomLayout], None]] = {
    "Living_Room": living_room,
    "Kitchen": kitchen,
    "Dining_Room": dining_room,
    "Bedroom": bedroom,
    "Child_Room": child_room,
    "Guest_Room": guest_room,
    "Office": office,
    "Bathroom": bathroom,
    "Toilet": toilet,
    "Hallway": hallway,
    "Storage": storage,
    "Wardrobe": dressing_room,
}
ESSENTIALS = {
    "Living_Room": "sofa",
    "Kitchen": "sink",
    "Dining_Room": "dining_table",
    "Bedroom": "double_bed",
    "Child_Room": "single_bed",
    "Office": "desk",
    "Bathroom": "toilet",
    "Toilet": "toilet",
}
RADIO_STANDS = ("tv_stand", "dresser", "nightstand", "desk", "side_table", "shoes_cabinet", "coffee_table")


def furnish(plan: LevelPlan, style: Style) -> list[list[PlacedModel]] | None:
    """The furniture of every room, or None if the plan does not serve.

    That is if open doors block one another, or a room has no place for what it is for, or none has for the radio.
    """
    layouts = [RoomLayout(plan, index, style) for index in range(len(plan.rooms))]
    for layout in layouts:
        if not layout.passable:
            return None
        RECIPES[layout.room.type](layout)
        if not _serves(layout):
            return None
        _lamp(layout)
        for _ in range(int(style.rng.integers(0, 3))):
            layout.hang(style.object("picture"), float(style.rng.uniform(1.25, 1.45)))
    return [layout.items for layout in layouts] if _radio(layouts, style) else None


def _serves(room: RoomLayout) -> bool:
    needed = ESSENTIALS.get(room.room.type)
    return needed is None or any(item.model.fine == needed for item in room.items)


def _radio(layouts: Sequence[RoomLayout], style: Style) -> bool:
    """One radio in the house: on a piece of furniture, or else a loudspeaker on the floor."""
    order = [layouts[i] for i in style.rng.permutation(len(layouts))]
    for layout in order:
        for anchor in [item for item in layout.items if item.model.family in RADIO_STANDS]:
            if layout.on_top(anchor, style.object("radio")):
                return True
    return any(layout.against_wall(style.object("speaker")) for layout in order)


def _lamp(room: RoomLayout) -> None:
    """A lamp in the middle of the room, low above a dining table."""
    tables = [item for item in room.items if item.model.fine == "dining_table"]
    rect = room.room.rects[0]
    x, z = (rect.x0 + rect.x1) / 2, (rect.z0 + rect.z1) / 2
    if tables and room.under_ceiling(room.style.object("pendant"), tables[0].position[0], tables[0].position[2]):
        return
    for dx, dz in ((0.0, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)):
        if room.under_ceiling(room.style.object("ceiling_lamp"), x + dx, z + dz):
            return
