"""Seats around tables."""

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_to
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.floor_placement import is_clear_of
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.support_surfaces import find_support_surfaces

SIDE_PER_SEAT = 0.62  # [m], length of a table's side per seat
MAX_ROUND_AREA_RATIO = 0.9  # maximum ratio of a round top's area to its bounding rectangle
PULLED_OUT_PROBABILITY = 0.12  # probability that a chair is pulled out, as after use


@cache
def is_round(model_id: str) -> bool:
    """Return whether the largest level surface of a table covers less than 0.9 of its rectangle, as round ones do."""
    top = find_support_surfaces(model_id)[0]
    width, depth = np.ptp(top.triangles.reshape(-1, 2), axis=0).tolist()
    return top.area < MAX_ROUND_AREA_RATIO * width * depth


def seat_places(table: PlacedModel, count: int) -> list[tuple[float, float, float]]:
    """Return at most `count` seats at a table: x, z of a point of its edge [m], outward angle from +z to +x [rad]."""
    wide, deep = float(table.size[0]) / 2, float(table.size[2]) / 2
    if is_round(table.model.id):
        turns = 2 * np.pi * np.arange(count) / count
        local = [(wide * np.sin(a), deep * np.cos(a), a) for a in turns.tolist()]
    else:
        each = max(1, min(count // 2, int(2 * wide / SIDE_PER_SEAT)))
        rows = [((k + 0.5) / each - 0.5) * 2 * wide for k in range(each)]
        local = [(x, side * deep, 0.0 if side > 0 else np.pi) for side in (1, -1) for x in rows]
        if count > len(local) and deep > 0.38:
            local += [(side * wide, 0.0, side * np.pi / 2) for side in (1, -1)]
    turn = table.quarter * np.pi / 2
    return [(*table.local_point(float(x), float(z)), float(way) + turn) for x, z, way in local[:count]]


def chairs_around(room: RoomSpace, table: PlacedModel, chair: PlacedModel, count: int) -> Iterator[PlacedModel]:
    """Generate at most `count` chairs that face a table, pulled out and turned at random, where one has space."""
    done: list[PlacedModel] = []
    for x, z, way in seat_places(table, count):
        left = room.rng.random() < PULLED_OUT_PROBABILITY
        tuck = float(room.rng.uniform(-0.3, -0.15) if left else room.rng.uniform(-0.05, 0.25))
        turn = float(room.rng.normal(0, 0.3 if left else 0.07))
        spot: PlacedModel = yaw_to(chair, 0.0, 0.0, 0.0, way + np.pi + turn)
        for shallower in (0.0, 0.1, 0.2, 0.3, 0.4):
            spot = _at_table(spot, (x, z), way, tuck - shallower)  # `at` reuses the cached shape of the turned chair
            if is_clear_of(spot, (table, *done)):
                done.append(spot)
                yield spot
                break


def _at_table(chair: PlacedModel, edge: Sequence[float], way: float, tuck: float) -> PlacedModel:
    """Return a chair in front of a point of the edge, in its orientation, its front `tuck` below the table [m]."""
    away = float(chair.size[2]) / 2 - tuck
    x, z = edge[0] + away * np.sin(way), edge[1] + away * np.cos(way)
    return chair.moved_to(float(x), FLOOR_TOP, float(z))
