"""Living rooms."""

from collections.abc import Callable, Iterator

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.v1.furnish.common import add, chance, fit
from home_procgen.v1.furnish.dining import dining_set
from home_procgen.v1.furnish.layout import RoomLayout, zone_before


def living_room(room: RoomLayout) -> None:
    """A sofa group that looks at the television; books; a place to eat if there is space."""
    sofa = fit(room, "sofa", lambda item: room.against_wall(item, companions=_table_before(room)))
    if sofa:
        _sofa_group(room, sofa, room.items[-1])
    _television(room, sofa)
    if room.room.area > 22:
        dining_set(room, 4)
    for probability in (0.9, 0.5):
        add(room, "bookshelf", 0.5, probability)
    add(room, "floor_lamp", probability=0.6)
    add(room, "speaker", 0.3, 0.3)
    add(room, "ottoman", probability=0.3)


def _table_before(room: RoomLayout) -> Callable[[PlacedModel], Iterator[PlacedModel]]:
    """A coffee table in front of a sofa."""
    table = room.style.object(str(room.rng.choice(["coffee_table", "coffee_table", "glass_table"])))

    def companions(sofa: PlacedModel) -> Iterator[PlacedModel]:
        x, z = sofa.local_point(0.0, float(sofa.size[2] + table.size[2]) / 2 + 0.35)
        yield table.moved_to(x, FLOOR_TOP, z, sofa.quarter)

    return companions


def _television(room: RoomLayout, sofa: PlacedModel | None) -> None:
    """A television on its stand, where the sofa faces if possible."""
    screen = room.style.object("television")

    def companions(stand: PlacedModel) -> Iterator[PlacedModel]:
        yield screen.moved_to(stand.position[0], float(stand.box[1, 1]), stand.position[2], stand.quarter)

    def place(stand: PlacedModel) -> PlacedModel | None:
        found = room.opposite(sofa, stand, 0.4, companions) if sofa else None
        return found or room.against_wall(stand, 0.5, companions)

    fit(room, "tv_stand", place)


def _sofa_group(room: RoomLayout, sofa: PlacedModel, table: PlacedModel) -> None:
    """A rug under the coffee table, armchairs beside it, a lamp and a side table beside the sofa."""
    style = room.style
    x, _, z = table.position
    room.place(style.object("rug").moved_to(x, FLOOR_TOP, z, sofa.quarter))
    for side in (-1, 1):
        if chance(room, 0.6):
            chair = style.object("armchair")
            x, z = table.local_point(side * float(table.size[0] / 2 + chair.size[2] / 2 + 0.3), 0.15)
            room.place(chair.moved_to(x, FLOOR_TOP, z, table.quarter - side))
    for side, family in zip(room.rng.permutation([-1, 1]).tolist(), ("floor_lamp", "side_table"), strict=True):
        placed = _next_to(room, sofa, style.object(family), side)
        if placed and family == "side_table":
            room.on_top(placed, style.object("table_lamp"))
    if chance(room, 0.6):
        room.on_top(table, style.object("vase"))
    room.reserve(zone_before(table, 0.5))


def _next_to(room: RoomLayout, anchor: PlacedModel, item: PlacedModel, side: int) -> PlacedModel | None:
    """Stands an object beside another, their backs in line."""
    x, z = anchor.local_point(
        side * float(anchor.size[0] / 2 + item.size[0] / 2 + 0.04), float(item.size[2] - anchor.size[2]) / 2
    )
    return room.place(item.moved_to(x, FLOOR_TOP, z, anchor.quarter))
