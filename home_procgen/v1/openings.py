"""Doors, windows and the entrance of a flat."""

from collections.abc import Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.openings import (
    DOOR_Y,
    HIGH_SILL_Y,
    MIN_OPENING_MARGIN,
    SILL_Y,
    LevelPlan,
    OpeningSite,
    PlanOpening,
)
from home_procgen.floor_plan.placed_model import PlacedModel, overlap_mask, quarter_towards, stack_boxes
from home_procgen.floor_plan.rooms import RoomPlan, outer_spans, shared_span
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import choose_random
from home_procgen.v1.furniture import family_models
from home_procgen.v1.plan import draw_rooms, draw_types

WINDOWLESS = ("Storage", "Wardrobe")
WET = ("Bathroom", "Toilet")
# Reluctance to route a way through a type of room.
PRIVACY = {"Hallway": 0, "Living_Room": 1, "Dining_Room": 2, "Kitchen": 3, "Office": 6}
_PRIVATE = 10


def draw_plan(rng: np.random.Generator) -> LevelPlan:
    """Draw a floor plan in which every room is reachable from the entrance."""
    types = draw_types(rng)
    x, z = np.round(rng.uniform(30, 50, 2), 1).tolist()
    while True:
        rooms = draw_rooms(rng, types, (x, z))
        doors = _draw_doors(rng, rooms) if rooms else None
        if rooms and doors:
            windows = _draw_windows(rng, rooms, doors)
            height = float(rng.choice([2.5, 2.6, 2.7, 2.8, 3.0], p=[0.15, 0.15, 0.45, 0.15, 0.1]))
            return LevelPlan(rooms, (*doors, *windows), height)


def _inner_sites(rooms: Sequence[RoomPlan]) -> list[OpeningSite]:
    pairs = [(a, b) for b in range(len(rooms)) for a in range(b)]
    return [
        OpeningSite(wall, span, (a, b))
        for a, b in pairs
        for wall in rooms[a].walls
        for other in rooms[b].walls
        if (span := shared_span(wall, other)) and span[1] - span[0] >= 1.2
    ]


def _outer_sites(rooms: Sequence[RoomPlan], room: int) -> list[OpeningSite]:
    others = [wall for i, other in enumerate(rooms) if i != room for wall in other.walls]
    return [OpeningSite(wall, span, (room,)) for wall in rooms[room].walls for span in outer_spans(wall, others)]


def _privacy(rooms: Sequence[RoomPlan], site: OpeningSite) -> int:
    return sum(PRIVACY.get(rooms[i].type, _PRIVATE) for i in site.rooms)


def _draw_doors(rng: np.random.Generator, rooms: Sequence[RoomPlan]) -> list[PlanOpening] | None:
    """Draw a spanning tree of doors through the least private rooms, extra doors between public rooms, and an entrance.

    Return None if a room or the entrance has no place for a door.
    """
    model = choose_random(family_models()["door"], rng)
    ranked = sorted(
        ((_privacy(rooms, site) + rng.uniform(0, 2), i, site) for i, site in enumerate(_inner_sites(rooms)))
    )
    doors: list[PlanOpening] = []
    reached = {0}
    while len(reached) < len(rooms):
        border = (site for _, _, site in ranked if len(reached & set(site.rooms)) == 1)
        door = next((door for site in border if (door := _fit_door(rng, rooms, site, model, doors))), None)
        if door is None:
            return None
        doors.append(door)
        reached |= set(door.rooms)
    for rank, _, site in ranked:
        joined = any(set(site.rooms) == set(door.rooms) for door in doors)
        if rank < 8 and not joined and rng.random() < 0.5 and (door := _fit_door(rng, rooms, site, model, doors)):
            doors.append(door)
    entrance = _draw_entrance(rng, rooms, model, doors)
    return [*doors, entrance] if entrance else None


def _draw_entrance(
    rng: np.random.Generator, rooms: Sequence[RoomPlan], model: FurnitureModel, doors: Sequence[PlanOpening]
) -> PlanOpening | None:
    """Return a closed door to the outside, in the most public room with a place for it; None if no room has one."""
    public = [room for room, plan in enumerate(rooms) if plan.type in PRIVACY]
    for room in sorted(public, key=lambda i: PRIVACY[rooms[i].type]):
        for site in _outer_sites(rooms, room):
            if door := _fit_door(rng, rooms, site, model, doors):
                return door
    return None


def _fit_door(
    rng: np.random.Generator,
    rooms: Sequence[RoomPlan],
    site: OpeningSite,
    model: FurnitureModel,
    doors: Sequence[PlanOpening],
) -> PlanOpening | None:
    """Return a door in a stretch of wall, with leaf and passage clear of the other doors; None if none fits.

    The leaf swings into the more private room; a door to the outside is closed.
    """
    inside = max(site.rooms, key=lambda i: PRIVACY.get(rooms[i].type, _PRIVATE))
    swing = site.wall.normal if inside == site.rooms[0] else -site.wall.normal
    owners = (inside, *(room for room in site.rooms if room != inside))
    boxes = stack_boxes([door.object.box for door in doors])
    passages = stack_boxes([door.passage for door in doors])
    for along in _positions(rng, site.span, float(model.size[0])):
        x, z = site.wall.point(along)
        for mirrored in rng.permutation([False, True]).tolist():
            quarter = quarter_towards(*-swing)
            placed = PlacedModel(model, (x, DOOR_Y, z), quarter, mirrored=mirrored, closed=len(owners) == 1)
            door = PlanOpening(placed, owners)
            if not overlap_mask(placed.box, passages).any() and not overlap_mask(door.passage, boxes).any():
                return door
    return None


def _positions(rng: np.random.Generator, span: tuple[float, float], width: float) -> Iterator[float]:
    """Generate centre positions of an opening along the wall, in random order, on a 0.1 m grid."""
    slack = span[1] - span[0] - width - 2 * MIN_OPENING_MARGIN
    if slack >= 0:
        low = span[0] + width / 2 + MIN_OPENING_MARGIN
        yield from (round(low + 0.1 * int(step), 6) for step in rng.permutation(int(slack / 0.1) + 1))


def _draw_windows(
    rng: np.random.Generator, rooms: Sequence[RoomPlan], doors: Sequence[PlanOpening]
) -> list[PlanOpening]:
    """Draw windows in outer walls: at least one per habitable room if a wall allows it."""
    windows: list[PlanOpening] = []
    for room, plan in enumerate(rooms):
        if plan.type in WINDOWLESS:
            continue
        count = 0
        for site in sorted(_outer_sites(rooms, room), key=lambda site: site.span[0] - site.span[1]):
            if count and rng.random() < 0.4:
                continue
            found = list(_fit_windows(rng, site, plan.type in WET, [*doors, *windows]))
            windows += found
            count += len(found)
    return windows


def _fit_windows(
    rng: np.random.Generator, site: OpeningSite, wet: bool, taken: Sequence[PlanOpening]
) -> Iterator[PlanOpening]:
    """Generate one centred window in a stretch of outer wall, or two in a long one; small and high in `wet` rooms."""
    low, high = site.span
    middles = [low + (high - low) * share for share in ((0.25, 0.75) if high - low > 5 else (0.5,))]
    models = family_models()["window"]
    fitting = [
        m
        for m in (models[:1] if wet else models[1:])
        if m.size[0] + 2 * MIN_OPENING_MARGIN <= (high - low) / len(middles)
    ]
    if not fitting:
        return
    model = choose_random(fitting, rng)
    boxes = stack_boxes(
        [box for opening in taken for box in (opening.object.box, opening.passage)[: 1 + opening.is_door]]
    )
    for middle in middles:
        x, z = site.wall.point(middle)
        placed = PlacedModel(model, (x, HIGH_SILL_Y if wet else SILL_Y, z), quarter_towards(*site.wall.normal))
        if not overlap_mask(placed.box, boxes).any():
            yield PlanOpening(placed, site.rooms)
