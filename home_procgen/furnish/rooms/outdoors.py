"""Balconies, loggias and terraces."""

from home_procgen.furnish.rooms.dining import place_dining_set
from home_procgen.furnish.space.on_top import place_several_on_top
from home_procgen.furnish.space.room import RoomSpace
from home_procgen.furnish.space.spots import add_at_wall, place_freely, scatter

ON_OUTDOOR_TABLE = (("small_plant", 0.5), ("glass", 0.4), ("bottle", 0.3), ("fruit_bowl", 0.3), ("candle", 0.3))


def furnish_terrace(room: RoomSpace) -> None:
    """Place a table, loungers, a grill, plants and a parasol."""
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
    """Place seats, a small table and plants."""
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
