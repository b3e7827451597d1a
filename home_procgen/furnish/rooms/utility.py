"""Garages, storage rooms, boiler rooms, gyms, balconies, loggias and terraces.

Objects are drawn at random with a probability each, and omitted if they do not fit.
"""

from home_procgen.furnish.rooms.dining import place_dining_set
from home_procgen.furnish.space.floor_placement import add_at_wall, place_freely, scatter
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang, hang_kind, hang_pictures

ON_WASHER = (("cloth", 0.6), ("bottle", 0.5), ("iron", 0.3), ("toiletries", 0.2))

ON_OUTDOOR_TABLE = (("small_plant", 0.5), ("glass", 0.4), ("bottle", 0.3), ("fruit_bowl", 0.3), ("candle", 0.3))


def furnish_garage(room: RoomSpace) -> None:
    """Place a random choice of a car, a bicycle, a motorcycle, racks, tools and garden equipment."""
    if room.draw_chance(0.8):
        place_freely(room, room.draw_object("car"), quarters=range(4))
    add_at_wall(room, "bicycle", 0.0, 0.6)
    add_at_wall(room, "motorcycle", 0.3, 0.2)
    for probability in (0.9, 0.7, 0.4):
        place_several_on_top(
            room, add_at_wall(room, "rack", 0.3, probability), (("tool_box", 0.5), ("helmet", 0.4), ("bottle", 0.3)), 2
        )
    hang_kind(room, "pegboard", 1.1, 0.6)
    hang_kind(room, "wall_lamp", 1.8, 0.3)
    for kind, probability in (("garage_bin", 0.8), ("ladder", 0.4), ("tool_box", 0.4), ("lawn_mower", 0.3)):
        add_at_wall(room, kind, 0.0, probability)
    add_at_wall(room, "barrow", 0.0, 0.15)
    place_several_on_top(room, add_at_wall(room, "washer", 0.5, 0.3), ON_WASHER, 2)
    add_at_wall(room, "dryer", 0.5, 0.1)
    place_several_on_top(
        room, add_at_wall(room, "desk", 0.4, 0.2), (("tool_box", 0.8), ("desk_lamp", 0.5), ("helmet", 0.3)), 2
    )
    if room.draw_chance(0.1):
        scatter(room, "helmet")
    furnish_windows(room, ("",), 0.0)


def furnish_storage(room: RoomSpace) -> None:
    """Place one to three racks, and a random choice of household appliances."""
    for probability in (1.0, 0.8, 0.5):
        place_several_on_top(
            room,
            add_at_wall(room, "rack", 0.3, probability),
            (("tool_box", 0.3), ("cloth", 0.4), ("containers", 0.4)),
            2,
        )
    for kind, probability in (("vacuum_cleaner", 0.6), ("ironing_board", 0.4), ("ladder", 0.35), ("garage_bin", 0.4),
                              ("trolley", 0.3), ("safe", 0.15), ("floor_basket", 0.3), ("tripod", 0.06)):  # fmt: skip
        add_at_wall(room, kind, 0.0, probability)
    place_several_on_top(room, add_at_wall(room, "washer", 0.4, 0.35), ON_WASHER, 2)
    hang_kind(room, "pegboard", 1.1, 0.25)


def furnish_boiler_room(room: RoomSpace) -> None:
    """Place a washing machine; at random a dryer, racks and laundry equipment."""
    place_several_on_top(room, add_at_wall(room, "washer", 0.4), ON_WASHER, 2)
    place_several_on_top(room, add_at_wall(room, "dryer", 0.4, 0.7), ON_WASHER, 1)
    for probability in (0.9, 0.5):
        add_at_wall(room, "rack", 0.3, probability)
    for kind, probability in (("floor_basket", 0.7), ("ironing_board", 0.5), ("vacuum_cleaner", 0.4)):
        add_at_wall(room, kind, 0.0, probability)


def furnish_gym(room: RoomSpace) -> None:
    """Place one to four machines, a mirror and a mat if they fit; at random a pool table and seats."""
    furnish_windows(room, ("short_curtain", ""), 0.4)
    hang(room, room.draw_object("tall_mirror"), 0.4)
    if room.plan.area > 30 and room.draw_chance(0.3):
        place_freely(room, room.draw_object("pool_table"))
    for probability in (1.0, 0.9, 0.7, 0.4):
        if room.draw_chance(probability):
            machine = place_freely(room, room.draw_object("gym"), quarters=range(4))
            add_at_wall(room, "small_gym", 0.2, 0.0 if machine else 1.0)
    for kind, probability in (("bench", 0.5), ("rack", 0.3), ("chair", 0.2), ("table", 0.15), ("water_dispenser", 0.1)):
        add_at_wall(room, kind, 0.3, probability)
    add_at_wall(room, "floor_speaker", 0.0, 0.5)
    add_at_wall(room, "slim_plant", 0.0, 0.4)
    place_freely(room, room.draw_object("runner"))
    hang_kind(room, "wall_television", 1.3, 0.35)
    hang_kind(room, "wall_clock", 1.65, 0.5)
    hang_pictures(room, 1)


def furnish_terrace(room: RoomSpace) -> None:
    """Place a random choice of table, loungers, swing, bench, chair, grill, bicycle, parasol, hot tub and plants."""
    if room.draw_chance(0.3):
        place_several_on_top(
            room, place_freely(room, room.draw_object("picnic_table"), quarters=range(4)), ON_OUTDOOR_TABLE, 2
        )
    elif room.draw_chance(0.6):
        place_dining_set(room, 4)
    for kind, probability in (("lounger", 0.4), ("lounger", 0.25), ("swing", 0.15), ("garden_bench", 0.4)):
        add_at_wall(room, kind, 0.2, probability)
    for kind, probability in (("garden_chair", 0.5), ("grill", 0.45), ("bicycle", 0.1)):
        add_at_wall(room, kind, 0.2, probability)
    if room.plan.area > 14 and room.draw_chance(0.15):
        place_freely(room, room.draw_object("parasol"))
    add_at_wall(room, "hot_tub", 0.4, 0.1)
    _place_outdoor_plants(room, 4)


def furnish_balcony(room: RoomSpace) -> None:
    """Place a random choice of a small table, seats and plants."""
    if room.draw_chance(0.7) and (table := add_at_wall(room, "side_table")):
        place_several_on_top(room, table, ON_OUTDOOR_TABLE, 2)
    for kind, probability in (("garden_chair", 0.7), ("garden_chair", 0.5), ("garden_bench", 0.3), ("chair", 0.3)):
        add_at_wall(room, kind, 0.15, probability)
    _place_outdoor_plants(room, 3)


def _place_outdoor_plants(room: RoomSpace, most: int) -> None:
    for _ in range(most):
        if room.draw_chance(0.5):
            add_at_wall(room, str(room.rng.choice(["slim_plant", "plant", "small_plant"])))
    add_at_wall(room, "garden_lamp", 0.0, 0.35)
    if room.draw_interest("pets", 0.1):
        scatter(room, "pet")
