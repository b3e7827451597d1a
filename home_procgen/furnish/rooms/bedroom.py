"""Bedrooms: a bed with nightstands, a wardrobe, a desk or a dressing table."""

from collections.abc import Iterator, Sequence
from functools import partial

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.rooms.desks import desk
from home_procgen.furnish.rooms.living import screened
from home_procgen.furnish.space.corners import across_corner, add_corner, in_corner
from home_procgen.furnish.space.hung import above, hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import on_top, some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, against_wall, fit, place, scattered

BESIDE = (
    *(("book", 0.4), ("books", 0.15), ("cup", 0.3), ("table_clock", 0.4), ("cellphone", 0.35), ("glass", 0.3)),
    *(("photo", 0.25), ("candle", 0.15), ("small_plant", 0.12), ("headphones", 0.06), ("toiletries", 0.05)),
)
CHEST = (
    *(("table_vase", 0.4), ("photo", 0.5), ("set_toiletries", 0.35), ("ornament", 0.4), ("candle", 0.3)),
    *(("figure", 0.35), ("small_plant", 0.3), ("radio", 0.3), ("cloth", 0.3), ("books", 0.25), ("table_clock", 0.2)),
    *(("hair_dryer", 0.12), ("telephone", 0.08)),
)

CORNERS = (
    *(("floor_basket", 0.3), ("standing_mirror", 0.2), ("floor_lamp", 0.2), ("slim_plant", 0.35), ("safe", 0.04)),
    *(("ottoman", 0.2), ("coat_stand", 0.1), ("oil_heater", 0.05), ("floor_fan", 0.06), ("guitar", 0.04)),
)


def bedroom(room: Room) -> None:
    """Place a double bed, a wardrobe, and optional furniture as space allows."""
    windows(room, ("long_curtain", "long_curtain", "short_curtain"), 0.5)
    bed(room, "double_bed")
    wardrobe(room)
    chest(room, 0.6)
    if room.chance(0.4):
        dressing_table(room)
    if room.chance(0.33):
        desk(room, "small_desk")
    television(room)
    if room.style.interests & {"children"} and room.chance(0.12):
        add(room, "baby_bed", 0.4)
    if room.likes("sport", 0.2):
        add(room, "small_gym", 0.2)
    rest(room)


def wardrobe(room: Room) -> PlacedFurniture | None:
    """Place a wardrobe at a wall, sometimes in a corner."""
    if room.chance(0.1) and (placed := fit(room, "corner_wardrobe", lambda item: in_corner(room, item, 0.4))):
        return placed
    return add(room, "plain_wardrobe", 0.55)


def television(room: Room) -> None:
    """Place a television at random, on a stand or on a wall."""
    if room.chance(0.25):
        fit(room, "low_tv_stand", lambda item: screened(room, item))
    elif room.chance(0.25):
        hang_kind(room, "wall_television", 1.05)


def rest(room: Room) -> None:
    """Place small furniture, baskets and pictures."""
    odds = (
        ("armchair", 0.25),
        ("bookshelf", 0.2),
        ("storage_bench", 0.12),
        ("clothes_rail", 0.1),
        ("two_seater", 0.12),
        ("side_table", 0.12),
    )
    for kind, probability in odds:
        add(room, kind, 0.3, probability)
    add_corner(room, "corner_shelf", 0.1)
    add_corner(room, "armchair", 0.12, across_corner)
    for kind, probability in CORNERS:
        add(room, kind, 0.0, probability)
    for kind, probability in (("shoes", 0.35), ("cloth", 0.2), ("book", 0.08)):
        if room.clutter(probability):
            scattered(room, kind)
    hang_kind(room, "wall_cooler", 2.05, 0.22)
    hang_kind(room, "wall_mirror", 0.9, 0.3)
    hang_kind(room, "wall_shelf", 1.4, 0.2)
    hang_kind(room, "wall_clock", 1.65, 0.12)
    pictures(room, 3)


def bed(room: Room, kind: str) -> PlacedFurniture | None:
    """Place a bed with a nightstand on both sides, on one, or on none; a rug, and a picture above."""
    stand = room.object("nightstand")
    for sides in ((-1, 1), (-1,), (1,), ()):
        companions = partial(_stands, stand=stand, sides=sides)
        placed = fit(room, kind, lambda item, c=companions: against_wall(room, item, 0.45, c, corners=1.3))
        if placed:
            _beside(room, placed, [item for item in room.items if item.model is stand.model])
            return placed
    return fit(room, "single_bed", lambda item: against_wall(room, item)) if kind != "single_bed" else None


def _stands(bed: PlacedFurniture, stand: PlacedFurniture, sides: Sequence[int]) -> Iterator[PlacedFurniture]:
    for side in sides:
        right = side * float(bed.size[0] / 2 + stand.size[0] / 2 + 0.04)
        x, z = bed.beside(right, float(stand.size[2] - bed.size[2]) / 2)
        yield stand.at(x, FLOOR_TOP, z, bed.quarter)


def _beside(room: Room, placed: PlacedFurniture, stands: Sequence[PlacedFurniture]) -> None:
    """Place lamps and objects on nightstands, a rug at the foot of the bed, and a picture above its head."""
    lamp, on_wall = room.object("bedside_lamp"), room.chance(0.15)
    for item in stands:
        if on_wall:
            above(room, item, room.object("round_lamp"), 1.15)
        else:
            any(on_top(room, item, kind, straight=True) for kind in (lamp, "bedside_lamp"))
        some(room, item, BESIDE, 2)
    if room.chance(0.55):
        x, z = placed.beside(0.0, 0.55 * float(placed.size[2]))
        place(room, room.object("large_rug").at(x, FLOOR_TOP, z, placed.quarter))
    if placed.size[1] < 1.25 and room.chance(0.55):
        above(room, placed, room.object("picture"), 1.35)


def chest(room: Room, probability: float) -> None:
    """Place a chest of drawers with objects on it and a mirror above, or with a television."""
    placed = add(room, "dresser", 0.5, probability)
    if placed is None:
        return
    if room.chance(0.25) and on_top(room, placed, "flat_screen", straight=True, middle=True):
        return
    if room.chance(0.5):
        above(room, placed, room.object("wall_mirror"), float(placed.size[1]) + 0.12)
    some(room, placed, CHEST, 4)


def dressing_table(room: Room) -> None:
    """Place a dressing table with a stool."""
    stool = room.object(str(room.rng.choice(["ottoman", "low_stool"])))

    def companions(table: PlacedFurniture) -> Iterator[PlacedFurniture]:
        x, z = table.beside(0.0, float(table.size[2] + stool.size[2]) / 2 + 0.06)
        yield stool.at(x, FLOOR_TOP, z, table.quarter + 2)

    placed = fit(room, "dressing_table", lambda item: against_wall(room, item, companions=companions))
    some(room, placed, (("set_toiletries", 0.8), ("hair_dryer", 0.3), ("candle", 0.2), ("ornament", 0.3)), 2)


def guest_room(room: Room) -> None:
    """Place a bed, a wardrobe and an armchair."""
    windows(room, ("long_curtain", "short_curtain"), 0.5)
    bed(room, str(room.rng.choice(["double_bed", "single_bed"])))
    wardrobe(room)
    if not add_corner(room, "armchair", 0.3, across_corner):
        add(room, "armchair", 0.3, 0.4)
    chest(room, 0.4)
    if room.chance(0.3):
        desk(room, "small_desk")
    for kind, probability in (("slim_plant", 0.4), ("ironing_board", 0.12), ("bookshelf", 0.2), ("keyboard", 0.04)):
        add(room, kind, 0.2, probability)
    pictures(room, 3)
