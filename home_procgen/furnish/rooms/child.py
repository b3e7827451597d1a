"""Children's rooms."""

from home_procgen.furnish.rooms.bedroom import bed, wardrobe
from home_procgen.furnish.rooms.desks import desk
from home_procgen.furnish.space.hung import hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, freely, scattered

ON_SHELF = (("toy", 0.6), ("toy_animal", 0.5), ("books", 0.5), ("ornament", 0.2), ("table_clock", 0.2), ("photo", 0.2))


def child_room(room: Room) -> None:
    """Place a bed, a desk, shelves with toys, and toys on the floor."""
    windows(room, ("long_curtain", "short_curtain"), 0.5)
    baby = room.chance(0.2)
    if not baby and room.chance(0.25):
        bed_placed = add(room, "bunk", 0.5) or bed(room, "single_bed")
    else:
        bed_placed = bed(room, "single_bed")
    if baby and bed_placed:
        add(room, "baby_bed", 0.4)
    wardrobe(room)
    if not baby and room.chance(0.8):
        desk(room, "small_desk")
    for kind, probability in (("toy_shelf", 0.8), ("dresser", 0.4), ("open_shelf", 0.25)):
        some(room, add(room, kind, 0.4, probability), ON_SHELF, 3)
    if room.chance(0.6):
        add(room, "large_toy", 0.3)
    if room.chance(0.6):
        freely(room, room.object("round_rug" if room.chance(0.6) else "large_rug"))
    for _ in range(2 + int(room.rng.integers(4))):
        if room.clutter(0.9):
            scattered(room, "floor_toy")
    for kind, probability in (("tricycle", 0.15), ("shoes", 0.4), ("floor_basket", 0.35), ("ottoman", 0.15)):
        if room.chance(probability):
            scattered(room, kind)
    hang_kind(room, "wall_shelf", 1.3, 0.4)
    hang_kind(room, "wall_clock", 1.65, 0.2)
    pictures(room, 3)
