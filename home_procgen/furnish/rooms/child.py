"""Children's rooms."""

from home_procgen.furnish.rooms.bedroom import place_bed, place_wardrobe
from home_procgen.furnish.rooms.desks import place_desk
from home_procgen.furnish.space.hung import furnish_windows, hang_kind, hang_pictures
from home_procgen.furnish.space.on_top import place_several_on_top
from home_procgen.furnish.space.room import RoomSpace
from home_procgen.furnish.space.spots import add_at_wall, place_freely, scatter

ON_SHELF = (("toy", 0.6), ("toy_animal", 0.5), ("books", 0.5), ("ornament", 0.2), ("table_clock", 0.2), ("photo", 0.2))


def furnish_child_room(room: RoomSpace) -> None:
    """Place a bed, a desk, shelves with toys, and toys on the floor."""
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
