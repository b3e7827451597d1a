"""Garages, storage rooms, boiler rooms and gyms."""

from home_procgen.furnish.space.hung import hang, hang_kind, pictures, windows
from home_procgen.furnish.space.on_top import some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, freely, scattered

ON_WASHER = (("cloth", 0.6), ("bottle", 0.5), ("iron", 0.3), ("toiletries", 0.2))


def garage(room: Room) -> None:
    """Place a car if it fits, bicycles, tools, and shelves along the walls."""
    if room.chance(0.8):
        freely(room, room.object("car"), quarters=range(4))
    add(room, "bicycle", 0.0, 0.6)
    add(room, "motorcycle", 0.3, 0.2)
    for probability in (0.9, 0.7, 0.4):
        some(room, add(room, "rack", 0.3, probability), (("tool_box", 0.5), ("helmet", 0.4), ("bottle", 0.3)), 2)
    hang_kind(room, "pegboard", 1.1, 0.6)
    hang_kind(room, "wall_lamp", 1.8, 0.3)
    for kind, probability in (("garage_bin", 0.8), ("ladder", 0.4), ("tool_box", 0.4), ("lawn_mower", 0.3)):
        add(room, kind, 0.0, probability)
    add(room, "barrow", 0.0, 0.15)
    some(room, add(room, "washer", 0.5, 0.3), ON_WASHER, 2)
    add(room, "dryer", 0.5, 0.1)
    some(room, add(room, "desk", 0.4, 0.2), (("tool_box", 0.8), ("desk_lamp", 0.5), ("helmet", 0.3)), 2)
    if room.chance(0.1):
        scattered(room, "helmet")
    windows(room, ("",), 0.0)


def storage(room: Room) -> None:
    """Place racks and household appliances."""
    for probability in (1.0, 0.8, 0.5):
        some(room, add(room, "rack", 0.3, probability), (("tool_box", 0.3), ("cloth", 0.4), ("containers", 0.4)), 2)
    for kind, probability in (("vacuum_cleaner", 0.6), ("ironing_board", 0.4), ("ladder", 0.35), ("garage_bin", 0.4),
                              ("trolley", 0.3), ("safe", 0.15), ("floor_basket", 0.3), ("tripod", 0.06)):  # fmt: skip
        add(room, kind, 0.0, probability)
    some(room, add(room, "washer", 0.4, 0.35), ON_WASHER, 2)
    hang_kind(room, "pegboard", 1.1, 0.25)


def boiler_room(room: Room) -> None:
    """Place a washing machine, a dryer, and laundry equipment."""
    some(room, add(room, "washer", 0.4), ON_WASHER, 2)
    some(room, add(room, "dryer", 0.4, 0.7), ON_WASHER, 1)
    for probability in (0.9, 0.5):
        add(room, "rack", 0.3, probability)
    for kind, probability in (("floor_basket", 0.7), ("ironing_board", 0.5), ("vacuum_cleaner", 0.4)):
        add(room, kind, 0.0, probability)


def gym(room: Room) -> None:
    """Place machines, a mirror and a mat; sometimes a pool table."""
    windows(room, ("short_curtain", ""), 0.4)
    hang(room, room.object("tall_mirror"), 0.4)
    if room.chance(0.2):
        freely(room, room.object("pool_table"))
    for probability in (1.0, 0.9, 0.7, 0.4):
        if room.chance(probability):
            machine = freely(room, room.object("gym"), quarters=range(4))
            add(room, "small_gym", 0.2, 0.0 if machine else 1.0)
    for kind, probability in (("bench", 0.5), ("rack", 0.3), ("chair", 0.2), ("table", 0.15), ("water_dispenser", 0.1)):
        add(room, kind, 0.3, probability)
    add(room, "floor_speaker", 0.0, 0.5)
    add(room, "slim_plant", 0.0, 0.4)
    freely(room, room.object("runner"))
    hang_kind(room, "wall_television", 1.3, 0.35)
    hang_kind(room, "wall_clock", 1.65, 0.5)
    pictures(room, 1)
