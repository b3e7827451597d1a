"""Bedrooms and children's rooms: a bed with nightstands, a wardrobe, a desk or a dressing table, toys."""

from collections.abc import Iterator, Sequence
from functools import partial

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.rooms.desks import place_desk
from home_procgen.furnish.rooms.living import place_television_stand
from home_procgen.furnish.space.corner_placement import add_in_corner, place_across_corner, place_in_corner
from home_procgen.furnish.space.floor_placement import (
    add_at_wall,
    place_against_wall,
    place_first_fitting,
    place_freely,
    place_object,
    scatter,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_on_top, place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_above, hang_kind, hang_pictures

ON_NIGHTSTAND = (
    *(("book", 0.4), ("books", 0.15), ("cup", 0.3), ("table_clock", 0.4), ("cellphone", 0.35), ("glass", 0.3)),
    *(("photo", 0.25), ("candle", 0.15), ("small_plant", 0.12), ("headphones", 0.06), ("toiletries", 0.05)),
)
ON_DRESSER = (
    *(("table_vase", 0.4), ("photo", 0.5), ("set_toiletries", 0.35), ("ornament", 0.4), ("candle", 0.3)),
    *(("figure", 0.35), ("small_plant", 0.3), ("radio", 0.3), ("cloth", 0.3), ("books", 0.25), ("table_clock", 0.2)),
    *(("hair_dryer", 0.12), ("telephone", 0.08)),
)

SMALL_FURNITURE = (
    *(("floor_basket", 0.3), ("standing_mirror", 0.2), ("floor_lamp", 0.2), ("slim_plant", 0.35), ("safe", 0.04)),
    *(("ottoman", 0.2), ("coat_stand", 0.1), ("oil_heater", 0.05), ("floor_fan", 0.06), ("guitar", 0.04)),
)

ON_SHELF = (("toy", 0.6), ("toy_animal", 0.5), ("books", 0.5), ("ornament", 0.2), ("table_clock", 0.2), ("photo", 0.2))


def furnish_bedroom(room: RoomSpace) -> None:
    """Place a double bed, a wardrobe, and optional furniture as space allows."""
    furnish_windows(room, ("long_curtain", "long_curtain", "short_curtain"), 0.5)
    place_bed(room, "double_bed")
    place_wardrobe(room)
    place_dresser(room, 0.6)
    if room.draw_chance(0.4):
        place_dressing_table(room)
    if room.draw_chance(0.33):
        place_desk(room, "small_desk")
    place_television(room)
    if room.style.interests & {"children"} and room.draw_chance(0.12):
        add_at_wall(room, "baby_bed", 0.4)
    if room.draw_interest("sport", 0.2):
        add_at_wall(room, "small_gym", 0.2)
    place_bedroom_extras(room)


def place_wardrobe(room: RoomSpace) -> PlacedModel | None:
    """Place a wardrobe at a wall, sometimes in a corner; None if it does not fit."""
    if room.draw_chance(0.1) and (
        placed := place_first_fitting(room, "corner_wardrobe", lambda item: place_in_corner(room, item, 0.4))
    ):
        return placed
    return add_at_wall(room, "plain_wardrobe", 0.55)


def place_television(room: RoomSpace) -> None:
    """Place a television on a stand, a television on a wall, or none, at random."""
    if room.draw_chance(0.25):
        place_first_fitting(room, "low_tv_stand", lambda item: place_television_stand(room, item))
    elif room.draw_chance(0.25):
        hang_kind(room, "wall_television", 1.05)


def place_bedroom_extras(room: RoomSpace) -> None:
    """Place small furniture, clothes on the floor, wall objects and pictures, each at random and if it fits."""
    odds = (
        ("armchair", 0.25),
        ("bookshelf", 0.2),
        ("storage_bench", 0.12),
        ("clothes_rail", 0.1),
        ("two_seater", 0.12),
        ("side_table", 0.12),
    )
    for kind, probability in odds:
        add_at_wall(room, kind, 0.3, probability)
    add_in_corner(room, "corner_shelf", 0.1)
    add_in_corner(room, "armchair", 0.12, place_across_corner)
    for kind, probability in SMALL_FURNITURE:
        add_at_wall(room, kind, 0.0, probability)
    for kind, probability in (("shoes", 0.35), ("cloth", 0.2), ("book", 0.08)):
        if room.draw_clutter(probability):
            scatter(room, kind)
    hang_kind(room, "wall_cooler", 2.05, 0.22)
    hang_kind(room, "wall_mirror", 0.9, 0.3)
    hang_kind(room, "wall_shelf", 1.4, 0.2)
    hang_kind(room, "wall_clock", 1.65, 0.12)
    hang_pictures(room, 3)


def place_bed(room: RoomSpace, kind: str) -> PlacedModel | None:
    """Place a bed with up to two nightstands, at random a rug and a picture; else a single bed; None if none fits."""
    stand = room.draw_object("nightstand")
    for sides in ((-1, 1), (-1,), (1,), ()):
        companions = partial(_nightstand_places, stand=stand, sides=sides)
        placed = place_first_fitting(
            room, kind, lambda item, c=companions: place_against_wall(room, item, 0.45, c, corners=1.3)
        )
        if placed:
            _place_beside_bed(room, placed, [item for item in room.items if item.model is stand.model])
            return placed
    return (
        place_first_fitting(room, "single_bed", lambda item: place_against_wall(room, item))
        if kind != "single_bed"
        else None
    )


def _nightstand_places(bed: PlacedModel, stand: PlacedModel, sides: Sequence[int]) -> Iterator[PlacedModel]:
    for side in sides:
        right = side * float(bed.size[0] / 2 + stand.size[0] / 2 + 0.04)
        x, z = bed.local_point(right, float(stand.size[2] - bed.size[2]) / 2)
        yield stand.moved_to(x, FLOOR_TOP, z, bed.quarter)


def _place_beside_bed(room: RoomSpace, placed: PlacedModel, stands: Sequence[PlacedModel]) -> None:
    """Place lamps and objects on nightstands; at random a rug at the foot of the bed and a picture above its head."""
    lamp, on_wall = room.draw_object("bedside_lamp"), room.draw_chance(0.15)
    for item in stands:
        if on_wall:
            hang_above(room, item, room.draw_object("round_lamp"), 1.15)
        else:
            any(place_on_top(room, item, kind, straight=True) for kind in (lamp, "bedside_lamp"))
        place_several_on_top(room, item, ON_NIGHTSTAND, 2)
    if room.draw_chance(0.55):
        x, z = placed.local_point(0.0, 0.55 * float(placed.size[2]))
        place_object(room, room.draw_object("large_rug").moved_to(x, FLOOR_TOP, z, placed.quarter))
    if placed.size[1] < 1.25 and room.draw_chance(0.55):
        hang_above(room, placed, room.draw_object("picture"), 1.35)


def place_dresser(room: RoomSpace, probability: float) -> None:
    """Place, with a probability, a chest of drawers with a television on it, or with objects and perhaps a mirror."""
    placed = add_at_wall(room, "dresser", 0.5, probability)
    if placed is None:
        return
    if room.draw_chance(0.25) and place_on_top(room, placed, "flat_screen", straight=True, middle=True):
        return
    if room.draw_chance(0.5):
        hang_above(room, placed, room.draw_object("wall_mirror"), float(placed.size[1]) + 0.12)
    place_several_on_top(room, placed, ON_DRESSER, 4)


def place_dressing_table(room: RoomSpace) -> None:
    """Place a dressing table with a stool and objects, if both fit."""
    stool = room.draw_object(str(room.rng.choice(["ottoman", "low_stool"])))

    def companions(table: PlacedModel) -> Iterator[PlacedModel]:
        x, z = table.local_point(0.0, float(table.size[2] + stool.size[2]) / 2 + 0.06)
        yield stool.moved_to(x, FLOOR_TOP, z, table.quarter + 2)

    placed = place_first_fitting(
        room, "dressing_table", lambda item: place_against_wall(room, item, companions=companions)
    )
    place_several_on_top(
        room, placed, (("set_toiletries", 0.8), ("hair_dryer", 0.3), ("candle", 0.2), ("ornament", 0.3)), 2
    )


def furnish_guest_room(room: RoomSpace) -> None:
    """Place a bed, a wardrobe and an armchair; at random a chest of drawers, a desk and small furniture."""
    furnish_windows(room, ("long_curtain", "short_curtain"), 0.5)
    place_bed(room, str(room.rng.choice(["double_bed", "single_bed"])))
    place_wardrobe(room)
    if not add_in_corner(room, "armchair", 0.3, place_across_corner):
        add_at_wall(room, "armchair", 0.3, 0.4)
    place_dresser(room, 0.4)
    if room.draw_chance(0.3):
        place_desk(room, "small_desk")
    for kind, probability in (("slim_plant", 0.4), ("ironing_board", 0.12), ("bookshelf", 0.2), ("keyboard", 0.04)):
        add_at_wall(room, kind, 0.2, probability)
    hang_pictures(room, 3)


def furnish_child_room(room: RoomSpace) -> None:
    """Place a bed (or bunk) and a wardrobe; at random a baby bed, a desk, shelves with toys, and toys on the floor."""
    furnish_windows(room, ("long_curtain", "short_curtain"), 0.5)
    baby = room.draw_chance(0.2)
    if not baby and room.draw_chance(0.25):
        bed_placed = add_at_wall(room, "bunk", 0.5) or place_bed(room, "single_bed")
    else:
        bed_placed = place_bed(room, "single_bed")
    if baby and bed_placed:
        add_at_wall(room, "baby_bed", 0.4)
    place_wardrobe(room)
    if not baby and room.draw_chance(0.8):
        place_desk(room, "small_desk")
    for kind, probability in (("toy_shelf", 0.8), ("dresser", 0.4), ("open_shelf", 0.25)):
        place_several_on_top(room, add_at_wall(room, kind, 0.4, probability), ON_SHELF, 3)
    if room.draw_chance(0.6):
        add_at_wall(room, "large_toy", 0.3)
    if room.draw_chance(0.6):
        place_freely(room, room.draw_object("round_rug" if room.draw_chance(0.6) else "large_rug"))
    for _ in range(2 + int(room.rng.integers(4))):
        if room.draw_clutter(0.9):
            scatter(room, "floor_toy")
    for kind, probability in (("tricycle", 0.15), ("shoes", 0.4), ("floor_basket", 0.35), ("ottoman", 0.15)):
        if room.draw_chance(probability):
            scatter(room, kind)
    hang_kind(room, "wall_shelf", 1.3, 0.4)
    hang_kind(room, "wall_clock", 1.65, 0.2)
    hang_pictures(room, 3)
