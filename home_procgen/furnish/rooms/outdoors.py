"""Balconies, loggias and terraces."""

from home_procgen.furnish.rooms.dining import dining_set
from home_procgen.furnish.space.on_top import some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, freely, scattered

ON_TABLE = (("small_plant", 0.5), ("glass", 0.4), ("bottle", 0.3), ("fruit_bowl", 0.3), ("candle", 0.3))


def terrace(room: Room) -> None:
    """Place a table, loungers, a grill, plants and a parasol."""
    if room.chance(0.3):
        some(room, freely(room, room.object("picnic_table"), quarters=range(4)), ON_TABLE, 2)
    elif room.chance(0.6):
        dining_set(room, 4)
    for kind, probability in (("lounger", 0.4), ("lounger", 0.25), ("swing", 0.15), ("garden_bench", 0.4)):
        add(room, kind, 0.2, probability)
    for kind, probability in (("garden_chair", 0.5), ("grill", 0.45), ("bicycle", 0.1)):
        add(room, kind, 0.2, probability)
    if room.plan.area > 14 and room.chance(0.15):
        freely(room, room.object("parasol"))
    add(room, "hot_tub", 0.4, 0.1)
    _plants(room, 4)


def balcony(room: Room) -> None:
    """Place seats, a small table and plants."""
    if room.chance(0.7) and (table := add(room, "side_table")):
        some(room, table, ON_TABLE, 2)
    for kind, probability in (("garden_chair", 0.7), ("garden_chair", 0.5), ("garden_bench", 0.3), ("chair", 0.3)):
        add(room, kind, 0.15, probability)
    _plants(room, 3)


def _plants(room: Room, most: int) -> None:
    for _ in range(most):
        if room.chance(0.5):
            add(room, str(room.rng.choice(["slim_plant", "plant", "small_plant"])))
    add(room, "garden_lamp", 0.0, 0.35)
    if room.likes("pets", 0.1):
        scattered(room, "pet")
