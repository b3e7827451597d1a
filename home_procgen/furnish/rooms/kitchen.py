"""Kitchens: rows of units along a wall, cabinets and a hood above, and objects on the counters."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_to
from home_procgen.floor_plan.rooms import PlanWall
from home_procgen.floor_plan.walls import FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.rooms.dining import place_dining_set
from home_procgen.furnish.space.collision_boxes import collision_boxes
from home_procgen.furnish.space.corner_placement import corner_spots
from home_procgen.furnish.space.floor_placement import (
    HANGING_GAP,
    WALL_GAP,
    add_at_wall,
    back_against,
    front_zone,
    is_clear_of,
    place_freely,
    place_object,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_on_burner, place_on_top
from home_procgen.furnish.space.wall_placement import (
    ceiling_height,
    furnish_windows,
    hang_above,
    hang_kind,
    hang_pictures,
)
from home_procgen.style.object_kinds import list_models

# [m], undersides of wall cabinets, and height of rails between them and the counter
WALL_CABINET_HEIGHT, RAIL_HEIGHT = 1.45, 1.2
MAX_CORNER_OFFSET = 0.25  # [m], maximum distance between the sides of a corner cabinet and of the unit below it
MAX_LOW_UNIT = 1.25  # [m], height of units with cabinets above them
CABINET_STEP = 0.1  # [m], distance to the next place to try where no wall cabinet fits
SPLASH_GAP, SPLASH_MARGIN = 0.006, 0.004  # [m], thickness of a splashback with its gap; from it to worktop and cabinets
SPLASHBACK_PROBABILITY = 0.8
MIN_HOOD_HEIGHT = 1.55  # [m], minimum height of the undersides of hoods above the floor
HOOD_KINDS = ("high_hood", "hood", "low_hood")  # by the height of their shafts
# Kinds of units of a row, in order from one end; longer rows first.
UNIT_ROWS = (
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
MIN_WORKTOP = 1.2  # [m], minimum length of the worktops of base cabinets together
# Rows of base cabinets that make up for a short worktop, longest first.
WORKTOP_ROWS = (("wide_cabinet", "wide_cabinet"), ("wide_cabinet",), ("base_cabinet",), ("narrow_cabinet",))
# Objects on the counters: the most common ones first.
ON_COUNTER = (
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


def furnish_kitchen(room: RoomSpace) -> None:
    """Place a row of units along one wall, sometimes a second row, an island, and a dining set."""
    tries = product((True, False), UNIT_ROWS)
    row = next((row for is_clear, kinds in tries if (row := _place_row(room, kinds, is_clear))), [])
    bases = worktop_cabinets(row)
    if row:
        _place_wall_units(room, row)
    else:
        add_at_wall(room, "stove", 0.6)
    for kinds in WORKTOP_ROWS:
        while worktop_length(bases) < MIN_WORKTOP and (more := _place_row(room, kinds)):
            bases += more
            _place_wall_units(room, more)
    if not any(unit.model.family == "refrigerator" for unit in row):
        add_at_wall(room, "slim_fridge", 0.6)
    if room.plan.area > 9.5:
        place_dining_set(room, 4 if room.plan.area > 11.5 else 2)
    if room.draw_chance(0.85) and (more := _place_row(room, ("base_cabinet",) * int(room.rng.integers(1, 4)))):
        bases += more
        if room.draw_chance(0.6):
            _place_wall_units(room, more)
    if room.plan.area > 12.5 and room.draw_chance(0.35):
        _place_island(room, bases)
    _place_on_counters(room, row, bases)
    add_at_wall(room, "kitchen_bin", probability=0.8)
    if room.plan.area > 14:
        add_at_wall(room, "two_seater", 0.4, 0.2)
    for kind, probability in (("wine_rack", 0.1), ("trolley", 0.1), ("water_dispenser", 0.08), ("slim_plant", 0.3)):
        add_at_wall(room, kind, 0.2, probability)
    furnish_windows(room, ("short_curtain", "short_curtain", ""), 0.2)
    for kind, y, probability in (
        ("wall_clock", 1.7, 0.4),
        ("wall_shelf", 1.45, 0.3),
        ("end_shelf", 1.45, 0.1),
        ("indoor_wall_lamp", 1.7, 0.2),
    ):
        hang_kind(room, kind, y, probability)
    hang_pictures(room, 1)


def worktop_cabinets(items: Iterable[PlacedModel]) -> list[PlacedModel]:
    """Return the base cabinets and islands among objects."""
    return [item for item in items if item.model.family == "kitchen_cabinet" and item.size[1] < 1.0]


def worktop_length(items: Iterable[PlacedModel]) -> float:
    """Return the length of the worktops of the base cabinets and islands among objects [m]."""
    return float(sum(item.size[0] for item in worktop_cabinets(items)))


def _place_row(room: RoomSpace, kinds: Sequence[str], is_clear: bool = False) -> list[PlacedModel] | None:
    """Place units side by side along one wall, in the given or the reverse order; None if they do not fit.

    The floor in front of them stays free; with `is_clear`, neither tall units nor a hood hide a window.
    """
    items = _units(room, kinds)
    total = float(sum(item.size[0] for item in items))
    walls = [wall for wall in room.plan.walls if wall.length >= total + 2 * (PRISM_THICKNESS + WALL_GAP)]
    for index in room.rng.permutation(len(walls)).tolist():
        wall = walls[index]
        slack = wall.length - total - 2 * (PRISM_THICKNESS + WALL_GAP)
        for share in (0.0, 1.0, 0.5, 0.25, 0.75):
            row = list(_place_side_by_side(items, wall, wall.span[0] + PRISM_THICKNESS + WALL_GAP + share * slack))
            if is_clear and _hides_window(room, row):
                continue
            if room.solid.overlaps_any(np.concatenate([collision_boxes(item) for item in row])):
                continue
            if room.try_place(row, [front_zone(item, 0.7) for item in row], views=False):
                return row
    return None


def _hides_window(room: RoomSpace, row: Sequence[PlacedModel]) -> bool:
    """Return whether a tall unit of a row, or the hood of its stove, is in front of a window."""
    boxes = [unit.box.copy() for unit in row if unit.model.family == "cooker" or unit.size[1] > MAX_LOW_UNIT]
    for box in boxes:
        box[1, 1] = room.height
    return bool(boxes) and room.views.overlaps_any(np.stack(boxes))


def _units(room: RoomSpace, kinds: Sequence[str]) -> list[PlacedModel]:
    """Return the units of a row in the given or reverse order, with at most two models of base cabinets."""
    cabinets = [room.draw_object("base_cabinet") for _ in range(2)]
    items = [
        cabinets[int(room.rng.integers(2))] if kind == "base_cabinet" else room.draw_object(kind) for kind in kinds
    ]
    return items[::-1] if room.draw_chance(0.5) else items


def _place_side_by_side(items: Sequence[PlacedModel], wall: PlanWall, along: float) -> Iterator[PlacedModel]:
    """Generate objects, left to right as seen from the room, backs to a wall, from a coordinate along it [m]."""
    for item in items if wall.normal[1 - wall.axis] * (1 if wall.axis == 0 else -1) > 0 else items[::-1]:
        yield back_against(item, wall, along + float(item.size[0]) / 2)
        along += float(item.size[0])


def _place_wall_units(room: RoomSpace, row: Sequence[PlacedModel]) -> None:
    """Place a hood over the stove and cabinets over the other units, except in front of windows."""
    shelf = room.draw_chance(0.2)
    kinds = ("wall_shelf", "wall_shelf") if shelf else ("door_cabinet", "wall_cabinet")
    cabinets = [room.draw_object(kind) for kind in kinds]
    narrow = [room.style.make_object(model, room.look) for model in list_models("wall_cabinet")[:2]]
    low = [unit for unit in row if unit.size[1] <= MAX_LOW_UNIT]
    if room.draw_chance(SPLASHBACK_PROBABILITY):
        _place_splashbacks(room, [unit for unit in low if unit.size[1] < 1.0])
    for unit in (unit for unit in low if unit.model.family == "cooker"):
        _place_hood(room, unit)
    if not shelf:
        _place_corner_cabinet(room, row)
    for run in _runs(low):
        _fill_run(room, run, (cabinets[int(room.rng.integers(2))], *cabinets, *narrow))


def _place_splashbacks(room: RoomSpace, units: Sequence[PlacedModel]) -> None:
    """Hang a panel above each unit of a row, from its top to the wall cabinets, where nothing is in the way."""
    panel = room.draw_object("splashback")
    for unit in units:
        low = float(unit.size[1]) + SPLASH_MARGIN
        wide, high = (
            float(unit.size[0] / panel.size[0]),
            (WALL_CABINET_HEIGHT - SPLASH_MARGIN - low) / float(panel.size[1]),
        )
        hang_above(room, unit, replace(panel, scale=(round(wide, 4), round(high, 4), 1.0)), low)


def _runs(units: Sequence[PlacedModel]) -> list[list[PlacedModel]]:
    """Return units that stand side by side, without cookers, in order; the end beside a cooker comes first."""
    runs: list[list[PlacedModel]] = [[]]
    for unit in units:
        if unit.model.family == "cooker":
            runs[-1].reverse()
            runs.append([])
        elif runs[-1] and not _touch(runs[-1][-1], unit):
            runs.append([unit])
        else:
            runs[-1].append(unit)
    return [run for run in runs if run]


def _touch(unit: PlacedModel, other: PlacedModel) -> bool:
    gap = np.maximum(unit.box[0] - other.box[1], other.box[0] - unit.box[1])[[0, 2]]
    return bool((gap < WALL_GAP).all())


def _fill_run(room: RoomSpace, run: Sequence[PlacedModel], items: Sequence[PlacedModel]) -> None:
    """Hang wall cabinets side by side above units, from the first on: at each place the first of `items` that fits."""
    first, last = run[0], run[-1]
    length = float(sum(unit.size[0] for unit in run))
    right = np.subtract(first.local_point(1.0, 0.0), first.local_point(0.0, 0.0))
    away = float(np.subtract(last.position, first.position)[[0, 2]] @ right)
    side = -1.0 if away < 0 else 1.0
    along = 0.0
    while along + min(float(item.size[0]) for item in items) < length + 0.01:
        hung = 0.0
        for item in items:
            wide = float(item.size[0])
            shift = side * (along + wide / 2 - float(first.size[0]) / 2)
            if along + wide < length + 0.01 and hang_above(room, first, item, WALL_CABINET_HEIGHT, shift):
                hung = wide + 0.001
                break
        along += hung or CABINET_STEP


def _place_hood(room: RoomSpace, stove: PlacedModel) -> None:
    """Place the tallest hood over a stove whose shaft reaches the ceiling and whose underside is high enough."""
    ceiling = ceiling_height(room)
    hoods = (room.draw_object(kind) for kind in HOOD_KINDS)
    if hood := next((hood for hood in hoods if ceiling - float(hood.size[1]) >= MIN_HOOD_HEIGHT), None):
        hang_above(room, stove, hood, ceiling - float(hood.size[1]))


def _place_corner_cabinet(room: RoomSpace, row: Sequence[PlacedModel]) -> None:
    """Place a wall cabinet in each corner at an end of a row that is over one of its units, if it fits."""
    item = room.draw_object("corner_wall_cabinet")
    for spot in corner_spots(room, item, FLOOR_TOP + WALL_CABINET_HEIGHT, HANGING_GAP):
        placed = item.moved_to(*spot)
        below = [unit for unit in row if unit.size[1] < 1.0 and unit.model.family != "cooker"]
        if any((abs(placed.box - unit.box)[:, [0, 2]] < MAX_CORNER_OFFSET).any(axis=0).all() for unit in below):
            place_object(room, placed)


def _place_on_counters(room: RoomSpace, row: Sequence[PlacedModel], bases: Sequence[PlacedModel]) -> None:
    """Place random objects on sinks and stoves of the row and on base cabinets, and rails above the latter."""
    for unit in row:
        if unit.model.family == "kitchen_sink":
            for kind, probability in (("soap_dispenser", 0.5), ("plates", 0.25), ("cup", 0.3)):
                if room.draw_clutter(probability):
                    place_on_top(room, unit, kind)
        if unit.model.family == "cooker":
            for kind in ("pan", "pan", "kettle"):
                if room.draw_clutter(0.6):
                    place_on_burner(room, unit, kind)
    if not bases:
        return
    more = 1.25 if "cooking" in room.style.interests else 0.8
    for kind, probability in ON_COUNTER:
        if room.draw_clutter(more * probability):
            unit = bases[int(room.rng.integers(len(bases)))]
            place_on_top(room, unit, kind, straight=kind in ("microwave", "toaster", "coffee_machine", "knife_block"))
    for kind, probability in (("knife_rail", 0.25), ("utensil_rail", 0.3), ("spice_rack", 0.15)):
        if room.draw_chance(probability):
            anchor, rail = bases[int(room.rng.integers(len(bases)))], room.draw_object(kind)
            any(
                hang_above(room, anchor, rail, RAIL_HEIGHT - 0.08, gap=gap) for gap in (HANGING_GAP, SPLASH_GAP + 0.001)
            )


def _place_island(room: RoomSpace, bases: list[PlacedModel]) -> None:
    """Place an island with stools on one side, and append it to `bases`; no effect if it does not fit."""
    stool = room.draw_object("bar_stool")

    def companions(island: PlacedModel) -> Iterator[PlacedModel]:
        for x in (-0.38, 0.38):
            for away in (0.05, 0.15, 0.25, 0.35):
                px, pz = island.local_point(x, -float(island.size[2]) / 2 - away)
                turn = island.quarter * np.pi / 2 + float(room.rng.normal(0, 0.2))
                spot = yaw_to(stool, px, FLOOR_TOP, pz, turn)
                if is_clear_of(spot, (island,)):
                    yield spot
                    break

    if island := place_freely(room, room.draw_object("island"), companions, range(4)):
        bases.append(island)
