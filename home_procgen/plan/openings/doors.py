"""Doors: private rooms are leaves of the door graph, and one entrance leads into it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from home_procgen.floor_plan.openings import (
    DOOR_Y,
    MIN_OPENING_MARGIN,
    OpeningSite,
    PlanOpening,
    find_inner_sites,
    find_outer_sites,
)
from home_procgen.floor_plan.placed_model import PlacedModel, overlap_mask, quarter_towards, stack_boxes
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan
from home_procgen.plan.openings.passage import BOX_HEIGHT, is_passable, stairwell_box
from home_procgen.plan.shape.cut_rooms import is_beside_cut
from home_procgen.plan.shape.program import CONNECTING_TYPES, OUTDOOR_TYPES, PRIVATE_ACCESS_TYPES
from home_procgen.plan.shape.storeys import Stairwell, Storey
from home_procgen.primitives.family import FurnitureModel

EXTRA_DOOR_PROBABILITY = 0.45  # probability of a second door connection between common rooms
ENTRANCE_TYPES = ("Entryway", "Hall", "Lobby", "Hallway", "Living_Room")
PRIVATE_RANK = 10
GUEST_TYPES = ("Hallway", "Hall", "Lobby", "Living_Room", "Dining_Room")
DOUBLE_DOOR_PROBABILITY = 0.4  # probability of a double door between two of them
STAIR_PROTRUSION = 0.2  # [m], by which stairs may protrude from their place towards the hall


class OpeningModels(NamedTuple):
    """Models of a home's openings."""

    door: FurnitureModel
    glazed: FurnitureModel  # of doors to outdoor rooms
    garage_door: FurnitureModel
    entry: FurnitureModel  # of the entrance
    double: FurnitureModel  # of some doors between guest rooms


def privacy_rank(kind: str) -> int:
    """Return the privacy rank of a room type: 0 for a hallway, `PRIVATE_RANK` for rooms that connect no others."""
    return CONNECTING_TYPES.index(kind) if kind in CONNECTING_TYPES else PRIVATE_RANK


def walkable_rooms(storey: Storey) -> tuple[RoomPlan, ...]:
    """Return the rooms, with the stairwell removed from the hall, because no door may be next to it."""
    if storey.stairs_up is None and storey.stairs_down is None:
        return storey.rooms
    hall = storey.rooms[0]
    return (RoomPlan(hall.type, hall.rects[:-1]), *storey.rooms[1:])


@dataclass
class StoreyDoors:
    """Doors of a storey under construction."""

    rng: np.random.Generator
    rooms: Sequence[RoomPlan]
    models: OpeningModels
    doors: list[PlanOpening]
    stairs: Stairwell | None

    def room_type(self, room: int) -> str:
        """Return the type of the room with an index."""
        return self.rooms[room].type

    def add_door(self, sites: Sequence[OpeningSite]) -> bool:
        """Add a door at the first site with a place for one; return whether one was added."""
        for site in sites:
            if door := self.fit_door(site):
                self.doors.append(door)
                return True
        return False

    def fit_door(self, site: OpeningSite) -> PlanOpening | None:
        """Return a door near an end of a wall stretch, with leaves and passage clear of other doors; None if none fits.

        It swings into the more private room, against the nearer wall; a door to the outside is closed.
        """
        return next((door for model in self._models(site) if (door := self._fit(site, model))), None)

    def _models(self, site: OpeningSite) -> Iterator[FurnitureModel]:
        """Generate the possible door models of a site, in order of preference."""
        kinds = [self.room_type(room) for room in site.rooms]
        if any(kind in OUTDOOR_TYPES for kind in kinds):
            yield self.models.glazed
            return
        if len(kinds) == 1:
            yield self.models.entry
        elif all(kind in GUEST_TYPES for kind in kinds) and self.rng.random() < DOUBLE_DOOR_PROBABILITY:
            yield self.models.double
        yield self.models.door

    def _fit(self, site: OpeningSite, model: FurnitureModel) -> PlanOpening | None:
        outdoors = [room for room in site.rooms if self.room_type(room) in OUTDOOR_TYPES]
        inside = max((r for r in site.rooms if r not in outdoors), key=lambda r: privacy_rank(self.room_type(r)))
        swing = site.wall.normal if inside == site.rooms[0] else -site.wall.normal
        owners = (inside, *(room for room in site.rooms if room != inside))
        quarter = quarter_towards(*-swing)
        for along in _positions(self.rng, site.span, float(model.size[0])):
            x, z = site.wall.point(along)
            placed = PlacedModel(model, (x, DOOR_Y, z), quarter, closed=len(owners) == 1)
            for mirrored in _mirror_options(placed, site.wall, site.span):
                one = PlacedModel(model, (x, DOOR_Y, z), quarter, mirrored=mirrored, closed=len(owners) == 1)
                door = PlanOpening(one, owners)
                if self._free(door):
                    return door
        return None

    def _free(self, door: PlanOpening) -> bool:
        boxes = stack_boxes([other.object.box for other in self.doors])
        passages = stack_boxes([other.passage for other in self.doors])
        if overlap_mask(door.object.box, passages).any() or overlap_mask(door.passage, boxes).any():
            return False
        if (
            self.stairs
            and overlap_mask(
                door.object.box, stack_boxes([stairwell_box(self.stairs, STAIR_PROTRUSION, BOX_HEIGHT)])
            ).any()
        ):
            return False
        inside = door.rooms[0]
        others = [other for other in self.doors if inside in other.rooms]
        return is_passable(self.rooms[inside], [*others, door])


def _positions(rng: np.random.Generator, span: tuple[float, float], width: float) -> Iterator[float]:
    """Generate centre positions of an opening on a 0.1 m grid, roughly from the ends of the wall inwards."""
    slack = span[1] - span[0] - width - 2 * MIN_OPENING_MARGIN
    if slack >= -1e-9:
        low, count = span[0] + width / 2 + MIN_OPENING_MARGIN, int(slack / 0.1 + 1e-6) + 1
        near = [min(i, count - 1 - i) + rng.uniform(0, 2.5) for i in range(count)]
        yield from (round(low + 0.1 * int(i), 6) for i in np.argsort(near))


def _mirror_options(placed: PlacedModel, wall: PlanWall, span: tuple[float, float]) -> tuple[bool, bool]:
    """Return the two `mirrored` options of a door; the first puts its hinge at the nearer end of the wall."""
    hinge = placed.local_point(-float(placed.size[0]) / 2, 0.0)[wall.axis]
    at = placed.position[2 * wall.axis]
    nearer_low = at - span[0] < span[1] - at
    return (False, True) if (hinge < at) == nearer_low else (True, False)


def draw_doors(rng: np.random.Generator, storey: Storey, models: OpeningModels) -> list[PlanOpening] | None:
    """Draw the doors of a storey, without the entrance; None if a room cannot be reached as required."""
    rooms = walkable_rooms(storey)
    plan = StoreyDoors(rng, rooms, models, [], storey.stairs_up or storey.stairs_down)
    sites = find_inner_sites(rooms)
    common = [i for i, room in enumerate(rooms) if room.type in CONNECTING_TYPES]
    if not _join_common(plan, sites, common):
        return None
    for room in (i for i in range(len(rooms)) if i not in common):
        able = CONNECTING_TYPES if rooms[room].type in OUTDOOR_TYPES else PRIVATE_ACCESS_TYPES
        ways = [s for s in sites if room in s.rooms and rooms[_other_room(s, room)].type in able]
        if rooms[room].type in OUTDOOR_TYPES:
            ways.sort(key=lambda s: -privacy_rank(rooms[_other_room(s, room)].type))
        else:
            ways.sort(key=lambda s: privacy_rank(rooms[_other_room(s, room)].type) + rng.uniform(0, 0.5))
        if not plan.add_door(ways):
            return None
    return plan.doors


def _other_room(site: OpeningSite, room: int) -> int:
    return next(r for r in site.rooms if r != room)


def _join_common(plan: StoreyDoors, sites: Sequence[OpeningSite], common: Sequence[int]) -> bool:
    """Connect the `common` rooms by a tree of doors from the hall, and some extra ones; return whether it succeeded."""
    ranked = sorted(
        (sum(privacy_rank(plan.room_type(r)) for r in site.rooms) + plan.rng.uniform(0, 1.5), i, site)
        for i, site in enumerate(sites)
        if set(site.rooms) <= set(common)
    )
    reached = {0}
    while len(reached) < len(common):
        border = [site for _, _, site in ranked if len(reached & set(site.rooms)) == 1]
        if not plan.add_door(border):
            return False
        reached |= set(plan.doors[-1].rooms)
    for _, _, site in ranked:
        joined = any(set(site.rooms) == set(door.rooms) for door in plan.doors)
        if not joined and plan.rng.random() < EXTRA_DOOR_PROBABILITY:
            plan.add_door([site])
    return True


def draw_entrance(
    rng: np.random.Generator, storey: Storey, models: OpeningModels, doors: Sequence[PlanOpening]
) -> PlanOpening | None:
    """Draw a closed door from outside into the entryway, the hall or the living room; None if none fits."""
    rooms = walkable_rooms(storey)
    plan = StoreyDoors(rng, rooms, models, list(doors), storey.stairs_up or storey.stairs_down)
    able = [i for i, room in enumerate(rooms) if room.type in ENTRANCE_TYPES]
    for room in sorted(able, key=lambda i: ENTRANCE_TYPES.index(rooms[i].type)):
        sites = [s for s in find_outer_sites(storey.rooms, room) if _bounds_walkable_part(s.wall, rooms[room])]
        sites = [s for s in sites if not is_beside_cut(rooms[room], s.wall)]
        for site in sorted(sites, key=lambda s: s.span[1] - s.span[0] + rng.uniform(0, 1)):
            if door := plan.fit_door(site):
                return door
    return None


def _bounds_walkable_part(wall: PlanWall, room: RoomPlan) -> bool:
    """Return whether a wall also bounds the walkable part of a room."""
    return any(
        other.axis == wall.axis and abs(other.line - wall.line) < 0.05 and other.span == wall.span
        for other in room.walls
    )


def draw_garage_doors(
    rng: np.random.Generator, rooms: Sequence[RoomPlan], models: OpeningModels, taken: Sequence[PlanOpening]
) -> Iterator[PlanOpening]:
    """Generate a closed garage door in an outer wall of each garage that has space for one."""
    width = float(models.garage_door.size[0]) + 2 * MIN_OPENING_MARGIN
    for room in (i for i, plan in enumerate(rooms) if plan.type == "Garage"):
        sites = [s for s in find_outer_sites(rooms, room) if s.span[1] - s.span[0] >= width]
        for site in sorted(sites, key=lambda s: s.span[1] - s.span[0]):
            low, high = site.span
            x, z = site.wall.point(round((low + high) / 2, 1))
            placed = PlacedModel(models.garage_door, (x, DOOR_Y, z), quarter_towards(*site.wall.normal))
            if not overlap_mask(placed.box, stack_boxes([o.object.box for o in taken])).any():
                yield PlanOpening(placed, (room,))
                break
