"""Halls, entrances and dressing rooms."""

from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.rooms.living import ON_CHEST, greenery
from home_procgen.furnish.space.corners import add_corner
from home_procgen.furnish.space.hung import above, hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import on_top, some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, place, scattered, somewhere


def hallway(room: Room) -> None:
    """Place a shoe cabinet, coat hooks or a coat stand, shoes, mirrors and a runner."""
    windows(room, ("short_curtain", "long_curtain", ""), 0.4)
    cabinet = add(room, "shoes_cabinet", 0.35)
    some(room, cabinet, (("table_vase", 0.4), ("telephone", 0.3), ("ornament", 0.3), ("photo", 0.3)), 2)
    if cabinet and cabinet.size[1] < 1.2 and room.chance(0.4):
        above(room, cabinet, room.object("wall_mirror"), max(float(cabinet.size[1]) + 0.15, 0.95))
    if not room.chance(0.5) or not hang_kind(room, "coat_hooks", 1.2):
        add(room, "coat_stand", 0.0, 0.8)
    table = add(room, "console", 0.35, 0.3)
    some(room, table, ON_CHEST, 3)
    if table and room.chance(0.5):
        above(room, table, room.object("wall_mirror"), 0.98)
    add(room, str(room.rng.choice(["bench", "storage_bench"])), 0.3, 0.35)
    for _ in range(1 + int(room.rng.integers(3))):
        _shoes(room)
    add(room, "umbrella_stand", 0.0, 0.25)
    add_corner(room, "corner_shelf", 0.12)
    if room.likes("sport", 0.3):
        add(room, "helmet")
        add(room, "bicycle", 0.2, 0.3)
    hang_kind(room, "tall_mirror", 0.45, 0.3)
    runner(room)
    for _ in range(2):
        hang_kind(room, "wall_lamp", 1.65, 0.3)
    pictures(room, 3)


def _shoes(room: Room) -> None:
    """Place a pair of shoes at a wall, at random."""
    item = room.object("shoes")
    if item and room.clutter(0.7):
        add(room, "shoes")


def runner(room: Room) -> None:
    """Place a rug along a part of a hall, at random."""
    if not room.chance(0.45):
        return
    for _ in range(4):
        x, z, rect = somewhere(room, 0.6)
        wide, deep = rect.sides
        rug = room.object("runner")
        if place(room, rug.at(x, FLOOR_TOP, z, 0 if wide > deep else 1)):
            return


def lounge_hall(room: Room) -> None:
    """Place the objects of a hallway, and more furniture as space allows."""
    hallway(room)
    add(room, "bookshelf", 0.5, 0.3)
    some(room, add(room, "dresser", 0.5, 0.3), ON_CHEST, 4)
    add(room, "armchair", 0.3, 0.25)
    add(room, "tall_clock", 0.2, 0.1)
    add(room, "column", 0.2, 0.04)
    greenery(room, 0.7, 2)
    if room.plan.area > 20:
        some(room, add(room, "side_table", 0.2, 0.3), (("table_vase", 0.8), ("telephone", 0.4)), 1)
        add(room, "vacuum_cleaner", 0.0, 0.15)


def dressing_room(room: Room) -> None:
    """Place wardrobes, rails, a mirror, shoes and a stool."""
    for probability in (1.0, 0.8, 0.4):
        add(room, "plain_wardrobe", 0.5, probability)
    add(room, "clothes_rail", 0.4, 0.5)
    some(room, add(room, "dresser", 0.4, 0.4), (("cloth", 0.7), ("ornament", 0.4), ("set_toiletries", 0.3)), 2)
    hang_kind(room, "tall_mirror", 0.4, 0.6)
    add(room, "standing_mirror", 0.0, 0.3)
    add(room, "ottoman", 0.0, 0.6)
    for _ in range(3):
        add(room, "shoes", 0.0, 0.6)
    add(room, "floor_basket", 0.0, 0.4)
    add(room, "ironing_board", 0.0, 0.15)
    if room.clutter(0.4):
        scattered(room, "cloth")


def entryway(room: Room) -> None:
    """Place the objects of a hallway, and sometimes a side table."""
    hallway(room)
    if stand := add(room, "side_table", 0.0, 0.15):
        on_top(room, stand, "small_plant")
