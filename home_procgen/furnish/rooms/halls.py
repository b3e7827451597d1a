"""Halls, entrances and dressing rooms."""

from collections.abc import Iterable

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.rooms.living import ON_CHEST, place_plants
from home_procgen.furnish.space.corner_placement import add_in_corner
from home_procgen.furnish.space.floor_placement import (
    HANGING_GAP,
    WALL_GAP,
    add_at_wall,
    place_at_first,
    place_object,
    random_point,
    room_wall_spots,
    scatter,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_on_top, place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_above, hang_kind, hang_pictures

MIN_LONG_HALL, MAX_BARE_STRETCH = 6.0, 2.5  # [m], lengths of halls, and of their parts without objects
MIN_SEEN_EDGE, MAX_SEEN_HEIGHT = 0.25, 1.9  # [m], longest edge of an object that counts, and height of its underside
# Kinds for bare stretches; those at walls have a height of their underside above the floor [m].
LOW_BARE_KINDS = ("slim_plant", "side_table", "ottoman", "floor_vase")
BARE_KINDS = ("picture", "picture", "picture", "wall_mirror", "wall_ornament", "console", "slim_plant", "bench")
WALL_HEIGHTS = {"picture": 1.25, "wall_mirror": 1.0, "wall_ornament": 1.35}


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
        place_several_on_top(room, cabinet, (("helmet", 0.6),), 1)
        add_at_wall(room, "bicycle", 0.2, 0.3)
    hang_kind(room, "tall_mirror", 0.45, 0.3)
    place_runner(room)
    for _ in range(2):
        hang_kind(room, "indoor_wall_lamp", 1.65, 0.3)
    hang_pictures(room, 3)
    furnish_bare_stretches(room)


def furnish_bare_stretches(room: RoomSpace) -> None:
    """Place objects at the walls of long halls, if they fit, until no stretch of `MAX_BARE_STRETCH` is bare."""
    for rect in room.plan.rects:
        axis = int(rect.extents[0] < rect.extents[1])
        low, high = rect[axis], rect[axis + 2]
        if high - low < MIN_LONG_HALL:
            continue
        for kinds in (BARE_KINDS, BARE_KINDS, LOW_BARE_KINDS):
            for start, end in bare_stretches(room.items, axis, low, high):
                for at in np.arange(start + MAX_BARE_STRETCH / 2, end, MAX_BARE_STRETCH / 2).tolist():
                    _place_beside(room, kinds[int(room.rng.integers(len(kinds)))], axis, at)


def bare_stretches(items: Iterable[PlacedModel], axis: int, low: float, high: float) -> list[tuple[float, float]]:
    """Return the stretches (start, end) of a hall along x (0) or z (1) that have no larger object at a wall [m].

    Lamps at the ceiling, switches, sockets and objects below `MIN_SEEN_EDGE` do not count.
    """
    seen = [i.box[:, 2 * axis] for i in items if max(i.size) > MIN_SEEN_EDGE and i.box[0, 1] < MAX_SEEN_HEIGHT]
    spans = sorted((max(low, float(a)), min(high, float(b))) for a, b in seen if b > low and a < high)
    found, last = [], low
    for start, end in [*spans, (high, high)]:
        if start - last > MAX_BARE_STRETCH:
            found.append((last, start))
        last = max(last, end)
    return found


def _place_beside(room: RoomSpace, kind: str, axis: int, at: float) -> None:
    """Place an object at a wall along a hall, at most `MAX_BARE_STRETCH` / 4 from a coordinate along it, if it fits."""
    item, y = room.draw_object(kind), WALL_HEIGHTS.get(kind)
    spots, _ = room_wall_spots(room, item, FLOOR_TOP + (y or 0.0), WALL_GAP if y is None else HANGING_GAP)
    near = [s for s in spots if s[3] % 2 == axis and abs(s[2 * axis] - at) < MAX_BARE_STRETCH / 4]
    place_at_first(room, item, [near[i] for i in room.rng.permutation(len(near)).tolist()])


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
