"""Slanted walls: cut-off corners of homes, and bays of living and dining rooms."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from home_procgen.floor_plan.openings import find_outer_sites
from home_procgen.floor_plan.rooms import PlanWall, Rect, RoomPlan, outer_spans
from home_procgen.plan.shape.cut_rooms import CutRoom, Point
from home_procgen.plan.shape.program import ROOMY_TYPES
from home_procgen.plan.shape.rows import snap_to_grid
from home_procgen.plan.shape.storeys import Storey

CUT_CORNER_PROBABILITY, BAY_PROBABILITY = 0.14, 0.12  # probabilities
BAYED_TYPES = ("Living_Room", "Dining_Room")
MIN_REMAINING_WALL = 1.2  # [m], minimum remaining wall length next to a cut corner


def add_slants(rng: np.random.Generator, storeys: tuple[Storey, ...]) -> tuple[Storey, ...]:
    """Return the storeys, at random with one corner cut off on all of them, a bay on the ground floor, or both."""
    if rng.random() < CUT_CORNER_PROBABILITY:
        storeys = _cut_corner(rng, storeys)
    if rng.random() < BAY_PROBABILITY:
        rooms = _add_bay(rng, storeys[0].rooms)
        storeys = (replace(storeys[0], rooms=rooms), *storeys[1:])
    return storeys


def _cut_corner(rng: np.random.Generator, storeys: tuple[Storey, ...]) -> tuple[Storey, ...]:
    size = snap_to_grid(rng.uniform(0.8, 1.5))
    corners = [{corner: room for room, corner in _cuttable_corners(s.rooms, size)} for s in storeys]
    common = sorted(set.intersection(*(set(c) for c in corners)))
    if not common:
        return storeys
    chosen = common[int(rng.integers(len(common)))]
    return tuple(
        replace(storey, rooms=_replace_room(storey.rooms, found[chosen], cuts=((*chosen, size),)))
        for storey, found in zip(storeys, corners, strict=True)
    )


def _replace_room(rooms: Sequence[RoomPlan], index: int, **cuts: tuple) -> tuple[RoomPlan, ...]:
    room = rooms[index]
    return tuple(CutRoom(r.type, r.rects, **cuts) if r is room else r for r in rooms)


def _cuttable_corners(rooms: Sequence[RoomPlan], size: float) -> Iterator[tuple[int, Point]]:
    """Generate convex corners of roomy rooms between two outer walls that stay long enough after the cut."""
    for index, room in enumerate(rooms):
        if room.type not in ROOMY_TYPES:
            continue
        others = [wall for k, other in enumerate(rooms) if k != index for wall in other.walls]
        for one, other in zip(room.walls, (*room.walls[1:], room.walls[0]), strict=True):
            turns = one.direction[0] * other.direction[1] - one.direction[1] * other.direction[0]
            if turns > 0 and all(
                _is_outer_near_corner(w, one.end, size + MIN_REMAINING_WALL, others) for w in (one, other)
            ):
                yield index, one.end


def _is_outer_near_corner(wall: PlanWall, corner: Point, length: float, others: Sequence[PlanWall]) -> bool:
    """Return whether a wall is an outer wall over the given length from its end at a corner [m]."""
    at = corner[wall.axis]
    low, high = (at, at + length) if abs(wall.span[0] - at) < 1e-6 else (at - length, at)
    return any(a - 1e-6 <= low and high <= b + 1e-6 for a, b in outer_spans(wall, others))


def _add_bay(rng: np.random.Generator, rooms: tuple[RoomPlan, ...]) -> tuple[RoomPlan, ...]:
    """Return the rooms with a bay added to a living or dining room, if a site has space for it."""
    hosts = [i for i, room in enumerate(rooms) if room.type in BAYED_TYPES and type(room) is RoomPlan]
    deep, wide = snap_to_grid(rng.uniform(0.7, 1.0)), snap_to_grid(rng.uniform(2.8, 3.6))
    sites = [s for i in hosts for s in find_outer_sites(rooms, i) if s.span[1] - s.span[0] >= wide + 0.8]
    if not sites:
        return rooms
    site = sites[int(rng.integers(len(sites)))]
    wall, host = site.wall, site.rooms[0]
    low = snap_to_grid(sum(site.span) / 2 - wide / 2)
    out = -float(wall.normal[1 - wall.axis])
    near, far = sorted((wall.line, snap_to_grid(wall.line + out * deep)))
    ends = (low, snap_to_grid(low + wide))
    rect = Rect(ends[0], near, ends[1], far) if wall.axis == 0 else Rect(near, ends[0], far, ends[1])
    if any(_rects_overlap(rect, other) for room in rooms for other in room.rects):
        return rooms
    size = snap_to_grid(deep - 0.2)
    tips = [(end, far if out > 0 else near) if wall.axis == 0 else (far if out > 0 else near, end) for end in ends]
    bay = CutRoom(rooms[host].type, (*rooms[host].rects, rect), tuple((x, z, size) for x, z in tips))
    return tuple(bay if i == host else room for i, room in enumerate(rooms))


def _rects_overlap(a: Rect, b: Rect) -> bool:
    return min(a.x1, b.x1) - max(a.x0, b.x0) > 1e-3 and min(a.z1, b.z1) - max(a.z0, b.z0) > 1e-3
