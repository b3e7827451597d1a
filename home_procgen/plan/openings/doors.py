"""Doors: private rooms are leaves of the door graph, and one entrance leads into it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from home_procgen.floor_plan.openings import DOOR_Y, MARGIN, Opening, OpeningSite
from home_procgen.floor_plan.placed import PlacedFurniture, overlaps, quarter_towards, stack
from home_procgen.floor_plan.rooms import RoomPlan, Wall
from home_procgen.plan.needs.room_program import LINKS, OUTDOORS, TO_PRIVATE
from home_procgen.plan.openings.bounds import column
from home_procgen.plan.openings.passage import HEIGHT, is_passable
from home_procgen.plan.openings.sites import inner_sites, outer_sites
from home_procgen.plan.shape.cut_rooms import beside_cut
from home_procgen.plan.shape.storeys import Stairwell, Storey
from home_procgen.primitives.family import Furniture

MORE = 0.45  # probability of a second door connection between common rooms
ENTRANCE = ("Entryway", "Hall", "Lobby", "Hallway", "Living_Room")
PRIVATE = 10
GRAND = ("Hallway", "Hall", "Lobby", "Living_Room", "Dining_Room")
DOUBLE = 0.4  # probability of a double door between two of them
STRINGERS = 0.2  # [m], by which stairs may protrude from their place towards the hall


class OpeningModels(NamedTuple):
    """OpeningModels of a home's openings."""

    door: Furniture
    glazed: Furniture  # of doors to outdoor rooms
    garage_door: Furniture
    entry: Furniture  # of the entrance
    double: Furniture  # of some doors between guest rooms


def rank(kind: str) -> int:
    """Return the privacy rank of a room type; the hall has the lowest."""
    return LINKS.index(kind) if kind in LINKS else PRIVATE


def walked(storey: Storey) -> tuple[RoomPlan, ...]:
    """Return the rooms, with the stairwell removed from the hall, because no door may be next to it."""
    if storey.stairs is None and storey.well is None:
        return storey.rooms
    hall = storey.rooms[0]
    return (RoomPlan(hall.type, hall.rects[:-1]), *storey.rooms[1:])


@dataclass
class DoorPlan:
    """Doors of a storey under construction."""

    rng: np.random.Generator
    rooms: Sequence[RoomPlan]
    models: OpeningModels
    doors: list[Opening]
    stairs: Stairwell | None

    def kind(self, room: int) -> str:
        """Return the type of a room."""
        return self.rooms[room].type

    def join(self, sites: Sequence[OpeningSite]) -> bool:
        """Add a door at the first site with a place for one; return whether one was added."""
        for site in sites:
            if door := self.fit(site):
                self.doors.append(door)
                return True
        return False

    def fit(self, site: OpeningSite) -> Opening | None:
        """Return a door near an end of a wall stretch, with leaves and passage clear of other doors; None if none fits.

        It swings into the more private room, against the nearer wall; a door to the outside is closed.
        """
        return next((door for model in self._models(site) if (door := self._fit(site, model))), None)

    def _models(self, site: OpeningSite) -> Iterator[Furniture]:
        """Generate the possible door models of a site, in order of preference."""
        kinds = [self.kind(room) for room in site.rooms]
        if any(kind in OUTDOORS for kind in kinds):
            yield self.models.glazed
            return
        if len(kinds) == 1:
            yield self.models.entry
        elif all(kind in GRAND for kind in kinds) and self.rng.random() < DOUBLE:
            yield self.models.double
        yield self.models.door

    def _fit(self, site: OpeningSite, model: Furniture) -> Opening | None:
        outdoors = [room for room in site.rooms if self.kind(room) in OUTDOORS]
        inside = max((r for r in site.rooms if r not in outdoors), key=lambda r: rank(self.kind(r)))
        swing = site.wall.normal if inside == site.rooms[0] else -site.wall.normal
        owners = (inside, *(room for room in site.rooms if room != inside))
        quarter = quarter_towards(*-swing)
        for along in _positions(self.rng, site.span, float(model.size[0])):
            x, z = site.wall.point(along)
            placed = PlacedFurniture(model, (x, DOOR_Y, z), quarter, closed=len(owners) == 1)
            for mirrored in _hands(placed, site.wall, site.span):
                one = PlacedFurniture(model, (x, DOOR_Y, z), quarter, mirrored=mirrored, closed=len(owners) == 1)
                door = Opening(one, owners)
                if self._free(door):
                    return door
        return None

    def _free(self, door: Opening) -> bool:
        boxes = stack([other.placed.box for other in self.doors])
        passages = stack([other.passage for other in self.doors])
        if overlaps(door.placed.box, passages).any() or overlaps(door.passage, boxes).any():
            return False
        if self.stairs and overlaps(door.placed.box, stack([column(self.stairs, STRINGERS, HEIGHT)])).any():
            return False
        inside = door.rooms[0]
        others = [other for other in self.doors if inside in other.rooms]
        return is_passable(self.rooms[inside], [*others, door])


def _positions(rng: np.random.Generator, span: tuple[float, float], width: float) -> Iterator[float]:
    """Generate centre positions of an opening on a 0.1 m grid, roughly from the ends of the wall inwards."""
    slack = span[1] - span[0] - width - 2 * MARGIN
    if slack >= -1e-9:
        low, count = span[0] + width / 2 + MARGIN, int(slack / 0.1 + 1e-6) + 1
        near = [min(i, count - 1 - i) + rng.uniform(0, 2.5) for i in range(count)]
        yield from (round(low + 0.1 * int(i), 6) for i in np.argsort(near))


def _hands(placed: PlacedFurniture, wall: Wall, span: tuple[float, float]) -> tuple[bool, bool]:
    """Return the two `mirrored` options of a door; the first puts its hinge at the nearer end of the wall."""
    hinge = placed.beside(-float(placed.size[0]) / 2, 0.0)[wall.axis]
    at = placed.position[2 * wall.axis]
    nearer_low = at - span[0] < span[1] - at
    return (False, True) if (hinge < at) == nearer_low else (True, False)


def draw_doors(rng: np.random.Generator, storey: Storey, models: OpeningModels) -> list[Opening] | None:
    """Draw the doors of a storey, without the entrance; None if a room cannot be reached as required."""
    rooms = walked(storey)
    plan = DoorPlan(rng, rooms, models, [], storey.stairs or storey.well)
    sites = inner_sites(rooms)
    common = [i for i, room in enumerate(rooms) if room.type in LINKS]
    if not _join_common(plan, sites, common):
        return None
    for room in (i for i in range(len(rooms)) if i not in common):
        able = LINKS if rooms[room].type in OUTDOORS else TO_PRIVATE
        ways = [s for s in sites if room in s.rooms and rooms[_other(s, room)].type in able]
        if rooms[room].type in OUTDOORS:
            ways.sort(key=lambda s: -rank(rooms[_other(s, room)].type))
        else:
            ways.sort(key=lambda s: rank(rooms[_other(s, room)].type) + rng.uniform(0, 0.5))
        if not plan.join(ways):
            return None
    return plan.doors


def _other(site: OpeningSite, room: int) -> int:
    return next(r for r in site.rooms if r != room)


def _join_common(plan: DoorPlan, sites: Sequence[OpeningSite], common: Sequence[int]) -> bool:
    """Connect the common rooms by a tree of doors from the hall, and some extra doors; return whether it succeeded."""
    ranked = sorted(
        (sum(rank(plan.kind(r)) for r in site.rooms) + plan.rng.uniform(0, 1.5), i, site)
        for i, site in enumerate(sites)
        if set(site.rooms) <= set(common)
    )
    reached = {0}
    while len(reached) < len(common):
        border = [site for _, _, site in ranked if len(reached & set(site.rooms)) == 1]
        if not plan.join(border):
            return False
        reached |= set(plan.doors[-1].rooms)
    for _, _, site in ranked:
        joined = any(set(site.rooms) == set(door.rooms) for door in plan.doors)
        if not joined and plan.rng.random() < MORE:
            plan.join([site])
    return True


def draw_entrance(
    rng: np.random.Generator, storey: Storey, models: OpeningModels, doors: Sequence[Opening]
) -> Opening | None:
    """Draw a closed door from outside into the entryway, the hall or the living room; None if none fits."""
    rooms = walked(storey)
    plan = DoorPlan(rng, rooms, models, list(doors), storey.stairs or storey.well)
    able = [i for i, room in enumerate(rooms) if room.type in ENTRANCE]
    for room in sorted(able, key=lambda i: ENTRANCE.index(rooms[i].type)):
        sites = [s for s in outer_sites(storey.rooms, room) if _of(s.wall, rooms[room])]
        sites = [s for s in sites if not beside_cut(rooms[room], s.wall)]
        for site in sorted(sites, key=lambda s: s.span[1] - s.span[0] + rng.uniform(0, 1)):
            if door := plan.fit(site):
                return door
    return None


def _of(wall: Wall, room: RoomPlan) -> bool:
    """Return whether a wall also bounds the walkable part of a room."""
    return any(
        other.axis == wall.axis and abs(other.line - wall.line) < 0.05 and other.span == wall.span
        for other in room.walls
    )


def garage_doors(
    rng: np.random.Generator, rooms: Sequence[RoomPlan], models: OpeningModels, taken: Sequence[Opening]
) -> Iterator[Opening]:
    """Generate a closed garage door in an outer wall of each garage that has space for one."""
    width = float(models.garage_door.size[0]) + 2 * MARGIN
    for room in (i for i, plan in enumerate(rooms) if plan.type == "Garage"):
        sites = [s for s in outer_sites(rooms, room) if s.span[1] - s.span[0] >= width]
        for site in sorted(sites, key=lambda s: s.span[1] - s.span[0]):
            low, high = site.span
            x, z = site.wall.point(round((low + high) / 2, 1))
            placed = PlacedFurniture(models.garage_door, (x, DOOR_Y, z), quarter_towards(*site.wall.normal))
            if not overlaps(placed.box, stack([o.placed.box for o in taken])).any():
                yield Opening(placed, (room,))
                break
