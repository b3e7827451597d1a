"""Halls, entrances and dressing rooms."""

from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.rooms.living import ON_CHEST, place_plants
from home_procgen.furnish.space.corner_placement import add_in_corner
from home_procgen.furnish.space.floor_placement import add_at_wall, place_object, random_point, scatter
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_on_top, place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_above, hang_kind, hang_pictures


def furnish_hallway(room: RoomSpace) -> None:
    """Place a shoe cabinet if it fits; at random coat hooks or a stand, a console, shoes, mirrors and a runner."""
    furnish_windows(room, ("short_curtain", "long_curtain", ""), 0.4)
    cabinet = add_at_wall(room, "shoes_cabinet", 0.35)
    place_several_on_top(room, cabinet, (("table_vase", 0.4), ("telephone", 0.3), ("ornament", 0.3), ("photo", 0.3)), 2)
    if cabinet and cabinet.size[1] < 1.2 and room.draw_chance(0.4):
        hang_above(room, cabinet, room.draw_object("wall_mirror"), max(float(cabinet.size[1]) + 0.15, 0.95))
    if not room.draw_chance(0.5) or not hang_kind(room, "coat_hooks", 1.2):
        add_at_wall(room, "coat_stand", 0.0, 0.8)
    table = add_at_wall(room, "console", 0.35, 0.3)
    place_several_on_top(room, table, ON_CHEST, 3)
    if table and room.draw_chance(0.5):
        hang_above(room, table, room.draw_object("wall_mirror"), 0.98)
    add_at_wall(room, str(room.rng.choice(["bench", "storage_bench"])), 0.3, 0.35)
    for _ in range(1 + int(room.rng.integers(3))):
        _place_shoes(room)
    add_at_wall(room, "umbrella_stand", 0.0, 0.25)
    add_in_corner(room, "corner_shelf", 0.12)
    if room.draw_interest("sport", 0.3):
        add_at_wall(room, "helmet")
        add_at_wall(room, "bicycle", 0.2, 0.3)
    hang_kind(room, "tall_mirror", 0.45, 0.3)
    place_runner(room)
    for _ in range(2):
        hang_kind(room, "wall_lamp", 1.65, 0.3)
    hang_pictures(room, 3)


def _place_shoes(room: RoomSpace) -> None:
    """Place a pair of shoes at a wall, at random by the clutter and if it fits."""
    item = room.draw_object("shoes")
    if item and room.draw_clutter(0.7):
        add_at_wall(room, "shoes")


def place_runner(room: RoomSpace) -> None:
    """Place, with a probability of 0.45, a runner along a part of a hall, if it fits in four attempts."""
    if not room.draw_chance(0.45):
        return
    for _ in range(4):
        x, z, rect = random_point(room, 0.6)
        wide, deep = rect.extents
        rug = room.draw_object("runner")
        if place_object(room, rug.moved_to(x, FLOOR_TOP, z, 0 if wide > deep else 1)):
            return


def furnish_lounge_hall(room: RoomSpace) -> None:
    """Place the objects of a hallway, and at random shelves, a dresser, an armchair, a clock and plants."""
    furnish_hallway(room)
    add_at_wall(room, "bookshelf", 0.5, 0.3)
    place_several_on_top(room, add_at_wall(room, "dresser", 0.5, 0.3), ON_CHEST, 4)
    add_at_wall(room, "armchair", 0.3, 0.25)
    add_at_wall(room, "tall_clock", 0.2, 0.1)
    add_at_wall(room, "column", 0.2, 0.04)
    place_plants(room, 0.7, 2)
    if room.plan.area > 20:
        place_several_on_top(
            room, add_at_wall(room, "side_table", 0.2, 0.3), (("table_vase", 0.8), ("telephone", 0.4)), 1
        )
        add_at_wall(room, "vacuum_cleaner", 0.0, 0.15)


def furnish_dressing_room(room: RoomSpace) -> None:
    """Place up to three wardrobes; at random a rail, a dresser, mirrors, shoes and a stool."""
    for probability in (1.0, 0.8, 0.4):
        add_at_wall(room, "plain_wardrobe", 0.5, probability)
    add_at_wall(room, "clothes_rail", 0.4, 0.5)
    place_several_on_top(
        room, add_at_wall(room, "dresser", 0.4, 0.4), (("cloth", 0.7), ("ornament", 0.4), ("set_toiletries", 0.3)), 2
    )
    hang_kind(room, "tall_mirror", 0.4, 0.6)
    add_at_wall(room, "standing_mirror", 0.0, 0.3)
    add_at_wall(room, "ottoman", 0.0, 0.6)
    for _ in range(3):
        add_at_wall(room, "shoes", 0.0, 0.6)
    add_at_wall(room, "floor_basket", 0.0, 0.4)
    add_at_wall(room, "ironing_board", 0.0, 0.15)
    if room.draw_clutter(0.4):
        scatter(room, "cloth")


def furnish_entryway(room: RoomSpace) -> None:
    """Place the objects of a hallway, and sometimes a side table."""
    furnish_hallway(room)
    if stand := add_at_wall(room, "side_table", 0.0, 0.15):
        place_on_top(room, stand, "small_plant")
