"""Balconies, loggias and terraces: outdoor rooms along outer walls of common rooms."""

from collections.abc import Sequence

import numpy as np

from home_procgen.floor_plan.openings import find_outer_sites
from home_procgen.floor_plan.rooms import PlanWall, Rect, RoomPlan, outer_spans
from home_procgen.plan.shape.cut_rooms import is_beside_cut
from home_procgen.plan.shape.program import MAX_ROOMS
from home_procgen.plan.shape.rows import snap_to_grid

HOSTS = ("Living_Room", "Dining_Room", "Kitchen", "Hallway", "Hall")
OUTDOOR_PROBABILITY = 0.33  # probability of an outdoor room on a storey with a possible host
MIN_HOST_WALL = 2.0  # [m], minimum length of the wall
MIN_LOGGIA_WALLS = 2  # minimum number of walled sides of a loggia


def add_outdoors(
    rng: np.random.Generator, rooms: tuple[RoomPlan, ...], ground: bool, below: Sequence[RoomPlan]
) -> tuple[RoomPlan, ...]:
    """Return the rooms of a storey, sometimes with one outdoor room added.

    Args:
        rng: Source of randomness.
        rooms: Rooms of the storey.
        ground: Whether it is the ground floor.
        below: Rooms of the storeys below, which the outdoor room must not overlap.
    """
    if rng.random() > OUTDOOR_PROBABILITY or len(rooms) >= MAX_ROOMS or any(room.type == "Terrace" for room in rooms):
        return rooms
    hosts = [i for i, room in enumerate(rooms) if room.type in HOSTS]
    sites = [s for i in hosts for s in find_outer_sites(rooms, i) if s.span[1] - s.span[0] >= MIN_HOST_WALL]
    sites = [s for s in sites if not is_beside_cut(rooms[s.rooms[0]], s.wall)]
    sites.sort(key=lambda s: HOSTS.index(rooms[s.rooms[0]].type) + rng.uniform(0, 2))
    for site in sites:
        terrace = ground and rng.random() < 0.45
        deep = snap_to_grid(rng.uniform(2.4, 3.8) if terrace else rng.uniform(1.3, 1.8))
        length = snap_to_grid(
            min(rng.uniform(3.0, 6.0) if terrace else rng.uniform(2.2, 4.5), site.span[1] - site.span[0])
        )
        shift = (site.span[1] - site.span[0] - length) * rng.choice([0.0, 0.5, 1.0])
        rect = _outside_rect(site.wall, snap_to_grid(site.span[0] + shift), length, deep)
        if not any(_rects_overlap(rect, other) for room in (*rooms, *below) for other in room.rects):
            kind = "Terrace" if terrace else _balcony_or_loggia(rect, rooms)
            return (*rooms, RoomPlan(kind, (rect,)))
    return rooms


def _outside_rect(wall: PlanWall, start: float, length: float, deep: float) -> Rect:
    out = -wall.normal[1 - wall.axis]
    near, far = sorted((wall.line, snap_to_grid(wall.line + float(out) * deep)))
    ends = start, snap_to_grid(start + length)
    return Rect(ends[0], near, ends[1], far) if wall.axis == 0 else Rect(near, ends[0], far, ends[1])


def _rects_overlap(a: Rect, b: Rect) -> bool:
    return min(a.x1, b.x1) - max(a.x0, b.x0) > 1e-3 and min(a.z1, b.z1) - max(a.z0, b.z0) > 1e-3


def _balcony_or_loggia(rect: Rect, rooms: Sequence[RoomPlan]) -> str:
    """Return "Loggia" if at least `MIN_LOGGIA_WALLS` sides have walls, else "Balcony"."""
    walls = [wall for room in rooms for wall in room.walls]
    open_length = [sum(b - a for a, b in outer_spans(wall, walls)) for wall in RoomPlan("Balcony", (rect,)).walls]
    closed = sum(left < 0.2 * wall.length for left, wall in zip(open_length, RoomPlan("", (rect,)).walls, strict=True))
    return "Loggia" if closed >= MIN_LOGGIA_WALLS else "Balcony"
