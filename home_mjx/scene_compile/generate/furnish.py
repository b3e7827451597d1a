"""What goes into each type of room, and in which order."""

from collections.abc import Callable, Iterator, Sequence

from home_mjx.scene_compile.generate.layout import GAP, RoomLayout, zone_before
from home_mjx.scene_compile.generate.openings import HousePlan
from home_mjx.scene_compile.generate.placed import Placed
from home_mjx.scene_compile.generate.style import Style
from home_mjx.scene_compile.generate.walls import FLOOR_TOP, HALF

HANGING_Y = 1.5  # [m], bottom of wall cabinets
RADIO_STANDS = ("tv_stand", "dresser", "nightstand", "desk", "side_table", "shoes_cabinet", "coffee_table")


def furnish(plan: HousePlan, style: Style) -> list[list[Placed]] | None:
    """The furniture of every room; None if no room had a place for the radio."""
    layouts = [RoomLayout(plan, index, style) for index in range(len(plan.rooms))]
    for layout in layouts:
        RECIPES[layout.room.type](layout)
        _lamp(layout)
        for _ in range(int(style.rng.integers(0, 3))):
            layout.hang(style.object("picture"), float(style.rng.uniform(1.25, 1.45)))
    return [layout.items for layout in layouts] if _radio(layouts, style) else None


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


def _chance(room: RoomLayout, probability: float) -> bool:
    return bool(room.rng.random() < probability)


def _add(room: RoomLayout, family: str, front: float = 0.0, probability: float = 1.0, top: str | None = None) -> None:
    """Maybe an object against a wall, and one on top of it."""
    if _chance(room, probability):
        options = (room.against_wall(option, front) for option in room.style.choices(family))
        placed = next((option for option in options if option), None)
        if placed and top:
            room.on_top(placed, room.style.object(top))


def living_room(room: RoomLayout) -> None:
    """A sofa group that looks at the television; books; a place to eat if there is space."""
    options = (room.against_wall(option, companions=_table_before(room)) for option in room.style.choices("sofa"))
    sofa = next((option for option in options if option), None)
    if sofa:
        _sofa_group(room, sofa, room.items[-1])
    _television(room, sofa)
    if room.room.area > 22:
        dining_set(room, 4)
    for probability in (0.9, 0.5):
        _add(room, "bookshelf", 0.5, probability)
    _add(room, "floor_lamp", probability=0.6)
    _add(room, "speaker", 0.3, 0.3)
    _add(room, "ottoman", probability=0.3)


def _table_before(room: RoomLayout) -> Callable[[Placed], Iterator[Placed]]:
    """A coffee table in front of a sofa."""
    table = room.style.object(str(room.rng.choice(["coffee_table", "coffee_table", "glass_table"])))

    def companions(sofa: Placed) -> Iterator[Placed]:
        x, z = sofa.beside(0.0, float(sofa.size[2] + table.size[2]) / 2 + 0.35)
        yield table.at(x, FLOOR_TOP, z, sofa.quarter)

    return companions


def _television(room: RoomLayout, sofa: Placed | None) -> None:
    """A television on its stand, where the sofa faces if possible."""
    screen = room.style.object("television")

    def companions(stand: Placed) -> Iterator[Placed]:
        yield screen.at(stand.position[0], float(stand.box[1, 1]), stand.position[2], stand.quarter)

    for stand in room.style.choices("tv_stand"):
        if sofa and room.opposite(sofa, stand, 0.4, companions):
            return
        if room.against_wall(stand, 0.5, companions):
            return


def _sofa_group(room: RoomLayout, sofa: Placed, table: Placed) -> None:
    """A rug under the coffee table, armchairs beside it, a lamp and a side table beside the sofa."""
    style = room.style
    x, _, z = table.position
    room.place(style.object("rug").at(x, FLOOR_TOP, z, sofa.quarter))
    for side in (-1, 1):
        if _chance(room, 0.6):
            chair = style.object("armchair")
            x, z = table.beside(side * float(table.size[0] / 2 + chair.size[2] / 2 + 0.3), 0.15)
            room.place(chair.at(x, FLOOR_TOP, z, table.quarter - side))
    for side, family in zip(room.rng.permutation([-1, 1]).tolist(), ("floor_lamp", "side_table"), strict=True):
        placed = _next_to(room, sofa, style.object(family), side)
        if placed and family == "side_table":
            room.on_top(placed, style.object("table_lamp"))
    if _chance(room, 0.6):
        room.on_top(table, style.object("vase"))
    room.reserve(zone_before(table, 0.5))


def _next_to(room: RoomLayout, anchor: Placed, item: Placed, side: int) -> Placed | None:
    """Stands an object beside another, their backs in line."""
    x, z = anchor.beside(
        side * float(anchor.size[0] / 2 + item.size[0] / 2 + 0.04), float(item.size[2] - anchor.size[2]) / 2
    )
    return room.place(item.at(x, FLOOR_TOP, z, anchor.quarter))


def dining_set(room: RoomLayout, seats: int) -> None:
    """A table with chairs all round, or a smaller one if that does not fit."""
    chair = room.style.object("chair")
    for family, number in (("dining_table", seats), ("round_table", 4), ("round_table", 2)):
        table = room.freely(room.style.object(family), lambda anchor, n=number: _chairs(anchor, chair, n))
        if table:
            room.on_top(table, room.style.object("vase"))
            return


def _chairs(table: Placed, chair: Placed, seats: int) -> Iterator[Placed]:
    """Chairs that face a table from its long sides (right and left of a round one too)."""
    wide, deep = float(table.size[0]), float(table.size[2])
    away = deep / 2 + float(chair.size[2]) / 2 + 0.04
    per_side = 1 if table.model.family == "round_table" else max(1, min(seats // 2, int(wide / 0.62)))
    for side in (-1, 1):
        for i in range(per_side):
            x, z = table.beside((i - (per_side - 1) / 2) * wide / per_side, side * away)
            yield chair.at(x, FLOOR_TOP, z, table.quarter + (2 if side > 0 else 0))
    if seats > 2 * per_side:
        for side in (-1, 1):
            x, z = table.beside(side * (wide / 2 + float(chair.size[2]) / 2 + 0.04), 0.0)
            yield chair.at(x, FLOOR_TOP, z, table.quarter - side)


def dining_room(room: RoomLayout) -> None:
    """A table for six, a sideboard, a rug."""
    dining_set(room, 6)
    _add(room, "dresser", 0.5, top="vase")
    _add(room, "bookshelf", 0.5, 0.4)
    _add(room, "floor_lamp", probability=0.4)


def kitchen(room: RoomLayout) -> None:
    """A row of units along one wall, wall cabinets above, and a place to eat."""
    middle = ["kitchen_cabinet", "kitchen_sink", "kitchen_cabinet", "cooker"]
    for families in (
        ["refrigerator", *middle, "kitchen_cabinet"],
        ["refrigerator", *middle],
        ["refrigerator", "kitchen_sink", "kitchen_cabinet", "cooker"],
        ["refrigerator", "kitchen_sink", "cooker"],
        ["kitchen_sink", "cooker"],
    ):
        if row := _row(room, families):
            _above(room, row)
            break
    else:
        _add(room, "cooker", 0.6)
    cabinets = [item for item in room.items if item.model.family == "kitchen_cabinet"]
    if cabinets:
        room.on_top(cabinets[-1], room.style.object("microwave"))
    _add(
        room, "refrigerator", 0.6, probability=0.0 if any(i.model.family == "refrigerator" for i in room.items) else 1.0
    )
    dining_set(room, 4)
    _add(room, "trash_can", probability=0.8)


def _row(room: RoomLayout, families: Sequence[str]) -> list[Placed] | None:
    """Objects side by side along one wall, in the given or the reverse order, with free floor before them."""
    items = [room.style.object(family) for family in families]
    if _chance(room, 0.5):
        items.reverse()
    total = float(sum(item.size[0] for item in items))
    walls = [wall for wall in room.room.walls if wall.length >= total + 2 * (HALF + GAP)]
    for index in room.rng.permutation(len(walls)):
        wall = walls[index]
        slack = wall.length - total - 2 * (HALF + GAP)
        for share in (0.0, 1.0, 0.5, 0.25, 0.75):
            along = wall.span[0] + HALF + GAP + share * slack
            row = []
            for item in items:
                row.append(room.backed(item, wall, along + float(item.size[0]) / 2))
                along += float(item.size[0])
            if room.put(row, [zone_before(item, 0.7) for item in row]):
                return row
    return None


def _above(room: RoomLayout, row: Sequence[Placed]) -> None:
    """A hood over the cooker and cabinets over the rest, where no window is."""
    for unit in row:
        if unit.model.family == "refrigerator":
            continue
        hood = unit.model.family == "cooker"
        item = room.style.object("range_hood" if hood else "hanging_cabinet")
        if item.size[0] > unit.size[0] + 0.01:
            continue
        x, z = unit.beside(0.0, float(item.size[2] - unit.size[2]) / 2)
        room.place(item.at(x, HANGING_Y + 0.1 * hood, z, unit.quarter))


def bedroom(room: RoomLayout, bed: str = "double_bed") -> None:
    """A bed between nightstands, a wardrobe, and what else fits."""
    _bed(room, bed)
    _add(room, "wardrobe", 0.6)
    _add(room, "dresser", 0.5, 0.6, top="television" if _chance(room, 0.4) else "vase")
    _desk(room, 0.4)
    _add(room, "armchair", 0.3, 0.3)
    _add(room, "bookshelf", 0.4, 0.3)


def _bed(room: RoomLayout, family: str) -> None:
    """A bed with a nightstand on each side, on one, or on none; a rug at its foot."""
    stand = room.style.object("nightstand")
    for sides in ((-1, 1), (-1,), (1,), ()):
        for bed in room.style.choices(family):
            placed = room.against_wall(bed, 0.45, lambda anchor, s=sides: _stands(anchor, stand, s))
            if placed:
                for item in room.items[-len(sides) :] if sides else ():
                    room.on_top(item, room.style.object("table_lamp"))
                x, z = placed.beside(0.0, 0.55 * float(placed.size[2]))
                room.place(room.style.object("rug").at(x, FLOOR_TOP, z, placed.quarter))
                return


def _stands(bed: Placed, stand: Placed, sides: Sequence[int]) -> Iterator[Placed]:
    for side in sides:
        right = side * float(bed.size[0] / 2 + stand.size[0] / 2 + 0.04)
        x, z = bed.beside(right, float(stand.size[2] - bed.size[2]) / 2)
        yield stand.at(x, FLOOR_TOP, z, bed.quarter)


def _desk(room: RoomLayout, probability: float = 1.0) -> None:
    """A desk with a chair before it, a laptop and a lamp on it."""
    if not _chance(room, probability):
        return
    chair = room.style.object("office_chair")

    def companions(desk: Placed) -> Iterator[Placed]:
        x, z = desk.beside(-0.1, float(desk.size[2] + chair.size[2]) / 2 + 0.04)
        yield chair.at(x, FLOOR_TOP, z, desk.quarter + 2)

    options = (room.against_wall(option, companions=companions) for option in room.style.choices("desk"))
    if desk := next((option for option in options if option), None):
        for family in ("laptop", "table_lamp"):
            room.on_top(desk, room.style.object(family))


def child_room(room: RoomLayout) -> None:
    """A small bed, a desk, toys' shelves and a round rug."""
    _bed(room, "single_bed")
    _desk(room, 0.9)
    _add(room, "wardrobe", 0.5)
    _add(room, "shelving", 0.4, 0.8)
    room.freely(room.style.object("round_rug"))


def guest_room(room: RoomLayout) -> None:
    """A bed, a wardrobe and an armchair."""
    _bed(room, str(room.rng.choice(["double_bed", "single_bed"])))
    _add(room, "wardrobe", 0.6)
    _add(room, "armchair", 0.3, 0.7)
    _add(room, "side_table", probability=0.5, top="vase")


def office(room: RoomLayout) -> None:
    """A desk and shelves."""
    _desk(room)
    for probability in (1.0, 0.7):
        _add(room, "bookshelf", 0.5, probability)
    _add(room, "armchair", 0.3, 0.5)
    _add(room, "shelving", 0.4, 0.4)
    _add(room, "trash_can", probability=0.7)
    room.freely(room.style.object("rug"))


def bathroom(room: RoomLayout) -> None:
    """A tub or a shower, a basin under a mirror, a toilet, a washing machine."""
    _add(room, "toilet", 0.4)
    _basin(room, str(room.rng.choice(["basin", "vanity"])))
    for family in room.rng.permutation(["bathtub", "shower"]).tolist():
        if room.against_wall(room.style.object(family), 0.45):
            break
    _add(room, "washer", 0.4, 0.6)
    _add(room, "trash_can", probability=0.5)


def toilet(room: RoomLayout) -> None:
    """A toilet and a basin."""
    _add(room, "toilet", 0.35)
    _basin(room, "basin")


def _basin(room: RoomLayout, family: str) -> None:
    basin = room.against_wall(room.style.object(family), 0.4)
    if basin:
        mirror = room.style.object("mirror")
        x, z = basin.beside(0.0, float(mirror.size[2] - basin.size[2]) / 2)
        room.place(mirror.at(x, 1.2, z, basin.quarter))


def hallway(room: RoomLayout) -> None:
    """Where coats and shoes go."""
    _add(room, "shoes_cabinet", 0.35, top="vase")
    _add(room, "coat_stand", probability=0.8)
    _add(room, "bench", 0.3, 0.5)
    room.hang(room.style.object("mirror"), 0.9)


def storage(room: RoomLayout) -> None:
    """Shelves."""
    for probability in (1.0, 0.8, 0.5):
        _add(room, "shelving", 0.3, probability)
    _add(room, "washer", 0.4, 0.4)
    _add(room, "trash_can", probability=0.4)


def dressing_room(room: RoomLayout) -> None:
    """Wardrobes, a mirror and a stool."""
    for probability in (1.0, 0.8):
        _add(room, "wardrobe", 0.5, probability)
    room.hang(room.style.object("mirror"), 0.6)
    _add(room, "ottoman", probability=0.6)


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
