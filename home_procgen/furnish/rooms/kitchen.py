"""Kitchens: rows of units along a wall, cabinets and a hood above, and objects on the counters."""

from collections.abc import Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.rooms import Wall
from home_procgen.floor_plan.walls import FLOOR_TOP, HALF
from home_procgen.furnish.rooms.dining import dining_set
from home_procgen.furnish.space.corners import corner_spots
from home_procgen.furnish.space.hung import above, hang_kind, pictures, windows
from home_procgen.furnish.space.occupied import hull
from home_procgen.furnish.space.on_top import on_burner, on_top
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import GAP, HUNG, add, backed, clear_of, freely, place, zone_before
from home_procgen.furnish.space.turned import turned
from home_procgen.style.kinds import models_of

UNDER, RAIL = 1.45, 1.2  # [m], undersides of wall cabinets, and height of rails between them and the counter
ENDS = 0.25  # [m], maximum distance between the sides of a corner cabinet and of the unit below it
HOOD_ROOM = 2.44  # [m], height of the tops of hoods
# Kinds of units of a row, in order from one end; longer rows first.
ROWS = (
    ("fridge", "pantry", "base_cabinet", "kitchen_sink", "dishwasher", "base_cabinet", "stove", "base_cabinet"),
    ("fridge", "base_cabinet", "kitchen_sink", "dishwasher", "base_cabinet", "stove", "base_cabinet"),
    ("fridge", "base_cabinet", "kitchen_sink", "base_cabinet", "stove", "base_cabinet"),
    ("fridge", "base_cabinet", "kitchen_sink", "base_cabinet", "stove"),
    ("slim_fridge", "kitchen_sink", "base_cabinet", "stove", "base_cabinet"),
    ("slim_fridge", "kitchen_sink", "base_cabinet", "stove"),
    ("slim_fridge", "kitchen_sink", "stove"),
    ("kitchen_sink", "base_cabinet", "stove"),
    ("kitchen_sink", "stove"),
)
# Objects on the counters: the most common ones first.
COUNTER = (
    *(("microwave", 0.9), ("kettle", 0.9), ("coffee_machine", 0.9), ("knife_block", 0.7), ("cutting_board", 0.75)),
    *(
        ("toaster", 0.6),
        ("food_processor", 0.6),
        ("utensil_jar", 0.6),
        ("containers", 0.45),
        ("fruit_bowl", 0.4),
        ("plates", 0.4),
    ),
    *(("bottle", 0.4), ("cup", 0.55), ("jug", 0.25), ("bread", 0.3), ("glass", 0.3)),
    *(("mortar", 0.12), ("small_plant", 0.25), ("radio", 0.2), ("cake", 0.08), ("food", 0.15), ("teapot", 0.2)),
)


def kitchen(room: Room) -> None:
    """Place a row of units along one wall, sometimes a second row, an island, and a dining set."""
    row = next((row for kinds in ROWS if (row := _row(room, kinds))), [])
    bases = [unit for unit in row if unit.model.family == "kitchen_cabinet" and unit.size[1] < 1.0]
    if row:
        _above(room, row)
    else:
        add(room, "stove", 0.6)
    if not any(unit.model.family == "refrigerator" for unit in row):
        add(room, "slim_fridge", 0.6)
    if room.plan.area > 9.5:
        dining_set(room, 4 if room.plan.area > 11.5 else 2)
    if room.chance(0.85) and (more := _row(room, ("base_cabinet",) * int(room.rng.integers(1, 4)))):
        bases += more
    if room.plan.area > 12.5 and room.chance(0.35):
        _island(room, bases)
    _counters(room, row, bases)
    add(room, "kitchen_bin", probability=0.8)
    if room.plan.area > 14:
        add(room, "two_seater", 0.4, 0.2)
    for kind, probability in (("wine_rack", 0.1), ("trolley", 0.1), ("water_dispenser", 0.08), ("slim_plant", 0.3)):
        add(room, kind, 0.2, probability)
    windows(room, ("short_curtain", "short_curtain", ""), 0.2)
    for kind, y, probability in (
        ("wall_clock", 1.7, 0.4),
        ("wall_shelf", 1.45, 0.3),
        ("end_shelf", 1.45, 0.1),
        ("wall_lamp", 1.7, 0.2),
    ):
        hang_kind(room, kind, y, probability)
    pictures(room, 1)


def _row(room: Room, kinds: Sequence[str]) -> list[PlacedFurniture] | None:
    """Place units side by side along one wall, in the given or the reverse order; None if they do not fit.

    The floor in front of them stays free.
    """
    items = _units(room, kinds)
    total = float(sum(item.size[0] for item in items))
    walls = [wall for wall in room.plan.walls if wall.length >= total + 2 * (HALF + GAP)]
    for index in room.rng.permutation(len(walls)).tolist():
        wall = walls[index]
        slack = wall.length - total - 2 * (HALF + GAP)
        for share in (0.0, 1.0, 0.5, 0.25, 0.75):
            row = list(_lined(items, wall, wall.span[0] + HALF + GAP + share * slack))
            if room.solid.meets(np.concatenate([hull(item) for item in row])):
                continue
            if room.put(row, [zone_before(item, 0.7) for item in row], views=False):
                return row
    return None


def _units(room: Room, kinds: Sequence[str]) -> list[PlacedFurniture]:
    """Return the units of a row, with at most two cabinet models, so that they match."""
    cabinets = [room.object("base_cabinet") for _ in range(2)]
    items = [cabinets[int(room.rng.integers(2))] if kind == "base_cabinet" else room.object(kind) for kind in kinds]
    return items[::-1] if room.chance(0.5) else items


def _lined(items: Sequence[PlacedFurniture], wall: Wall, along: float) -> Iterator[PlacedFurniture]:
    """Generate objects side by side at a wall, from a coordinate along it."""
    for item in items if wall.normal[1 - wall.axis] * (1 if wall.axis == 0 else -1) > 0 else items[::-1]:
        yield backed(item, wall, along + float(item.size[0]) / 2)
        along += float(item.size[0])


def _above(room: Room, row: Sequence[PlacedFurniture]) -> None:
    """Place a hood over the stove and cabinets over the other units, except in front of windows."""
    shelf = room.chance(0.2)
    kinds = ("wall_shelf", "wall_shelf") if shelf else ("door_cabinet", "wall_cabinet")
    cabinets = [room.object(kind) for kind in kinds]
    narrow = [room.style.instance(model, room.look) for model in models_of("wall_cabinet")[:2]]
    if not shelf:
        _corner_cabinet(room, row)
    for unit in row:
        if unit.size[1] > 1.25:
            continue
        if unit.model.family == "cooker":
            hood = room.object("range_hood")
            low = HOOD_ROOM - float(hood.size[1]) if hood.size[1] > 0.3 else UNDER + 0.1
            above(room, unit, hood, max(low, 1.5))
            continue
        for item in (cabinets[int(room.rng.integers(2))], *cabinets, *narrow):
            if item.size[0] < unit.size[0] + 0.01 and above(room, unit, item, UNDER):
                break


def _corner_cabinet(room: Room, row: Sequence[PlacedFurniture]) -> None:
    """Place a wall cabinet in the corner at the end of a row, over one of its units."""
    item = room.object("corner_wall_cabinet")
    for spot in corner_spots(room, item, FLOOR_TOP + UNDER, HUNG):
        placed = item.at(*spot)
        below = [unit for unit in row if unit.size[1] < 1.0 and unit.model.family != "cooker"]
        if any((abs(placed.box - unit.box)[:, [0, 2]] < ENDS).any(axis=0).all() for unit in below):
            place(room, placed)


def _counters(room: Room, row: Sequence[PlacedFurniture], bases: Sequence[PlacedFurniture]) -> None:
    """Place objects on the counters, and rails above them."""
    for unit in row:
        if unit.model.family == "kitchen_sink":
            for kind, probability in (("soap_dispenser", 0.5), ("plates", 0.25), ("cup", 0.3)):
                if room.clutter(probability):
                    on_top(room, unit, kind)
        if unit.model.family == "cooker":
            for kind in ("pan", "pan", "kettle"):
                if room.clutter(0.6):
                    on_burner(room, unit, kind)
    if not bases:
        return
    more = 1.25 if "cooking" in room.style.interests else 0.8
    for kind, probability in COUNTER:
        if room.clutter(more * probability):
            unit = bases[int(room.rng.integers(len(bases)))]
            on_top(room, unit, kind, straight=kind in ("microwave", "toaster", "coffee_machine", "knife_block"))
    for kind, probability in (("knife_rail", 0.25), ("utensil_rail", 0.3), ("spice_rack", 0.15)):
        if room.chance(probability):
            above(room, bases[int(room.rng.integers(len(bases)))], room.object(kind), RAIL - 0.08)


def _island(room: Room, bases: list[PlacedFurniture]) -> None:
    """Place an island with stools on one side."""
    stool = room.object("bar_stool")

    def companions(island: PlacedFurniture) -> Iterator[PlacedFurniture]:
        for x in (-0.38, 0.38):
            for away in (0.05, 0.15, 0.25, 0.35):
                px, pz = island.beside(x, -float(island.size[2]) / 2 - away)
                turn = island.quarter * np.pi / 2 + float(room.rng.normal(0, 0.2))
                spot = turned(stool, px, FLOOR_TOP, pz, turn)
                if clear_of(spot, (island,)):
                    yield spot
                    break

    if island := freely(room, room.object("island"), companions, range(4)):
        bases.append(island)
