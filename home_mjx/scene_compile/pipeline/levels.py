"""Levels of a house: colliders, floors, doors, movable bodies and free space."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int

from home_mjx.geometry.boxes import BoxSet, distinct, join
from home_mjx.geometry.meshes import bounds
from home_mjx.scene_compile.architecture.frame import Frame
from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.collision.barriers import fence, find_barriers, within_reach
from home_mjx.scene_compile.collision.choose import choose_movables
from home_mjx.scene_compile.collision.colliders import ColliderOptions, wall_colliders
from home_mjx.scene_compile.collision.edges import edge_barriers
from home_mjx.scene_compile.collision.floors import FloorPlan, plan_floors
from home_mjx.scene_compile.collision.level import (
    LevelBoxes,
    Obstacles,
    by_object,
    find_obstacles,
    level_boxes,
    static_colliders,
)
from home_mjx.scene_compile.collision.movables import Candidate, MovableOptions, make_bodies
from home_mjx.scene_compile.collision.ramps import guards, make_ramps, sills, with_ramps
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions, free_space
from home_mjx.scene_compile.navigation.nowhere import nowhere_to_stand
from home_mjx.scene_compile.objects.doorways import Doorway, find_doorways
from home_mjx.scene_compile.objects.leaves import ajar_leaves, make_doors
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.scene_compile.objects.stairs import CATEGORY, Stairs, find_stairs
from home_mjx.scene_compile.pipeline.limits import check_levels
from home_mjx.schema.compiled import Bodies, Colliders, Doors, Ramps, Rooms


@dataclass(frozen=True)
class Site:
    """Inputs of a level that has rooms, before its obstacles are computed.

    Attributes:
        grid: Index among the levels that have rooms, lowest first.
        number: Level index.
        plan: Floor plan.
        objects: Objects that may extend into the level, without stairs that agents climb.
        doorways: Doorways of its doors.
        upstairs: Stairs that begin on this level.
        downstairs: Stairs that end on this level.
    """

    grid: int
    number: int
    plan: FloorPlan
    objects: Sequence[PlacedObject]
    doorways: Sequence[Doorway]
    upstairs: Sequence[Stairs]
    downstairs: Sequence[Stairs]

    def floors(self, step: float) -> BoxSet:
        """Return boxes of its floors [m].

        On the lowest level, a plane replaces those up to `step` above the lowest floor.
        """
        return self.plan.boxes(self.plan.lowest + step if self.grid == 0 else -np.inf)

    def raised(self, step: float) -> BoxSet:
        """Return boxes of the floors more than `step` above the level's lowest floor [m]."""
        return self.plan.boxes(self.plan.lowest + step)


@dataclass(frozen=True)
class Levels:
    """Colliders, bodies, doors and free space of a house.

    Attributes:
        spaces: Free space of each level that has rooms, lowest first.
        doorways: Doorways of each of these levels.
        leaves: Boxes on each of these levels of leaves that turn: initial, closed and wide open.
        open_leaves: The same, only wide open.
        stairs: Stairs between them that agents climb.
        colliders: Static boxes of all levels; barriers, a fence of four boxes and the ramps are last.
        ramps: Slopes of the stairs.
        bodies: Movable objects.
        doors: Leaves that turn, of all levels.
        stuck: Ids of objects of movable categories that are not free to move.
        report: Counts.
    """

    spaces: Sequence[FreeSpace]
    doorways: Sequence[Sequence[Doorway]]
    leaves: Sequence[BoxSet]
    open_leaves: Sequence[BoxSet]
    stairs: Sequence[Stairs]
    colliders: Colliders
    ramps: Ramps
    bodies: Bodies
    doors: Doors
    stuck: Int[np.ndarray, " n"]
    report: Mapping[str, int]


def build_levels(
    frame: Frame,
    shell: Shell,
    objects: Sequence[PlacedObject],
    colliders: ColliderOptions,
    movables: MovableOptions,
    navigation: NavigationOptions,
) -> Levels:
    """Compute the colliders, bodies, doors and free space of all levels of a house.

    Args:
        frame: Rooms.
        shell: Walls.
        objects: Objects of all levels.
        colliders: Options of box fitting.
        movables: Criteria for movable objects.
        navigation: Sizes of an agent and of a cell.

    Raises:
        DatasetError: The house exceeds the `limits`, or its ground floor has no standable cell.
    """
    check_levels(frame, shell, navigation.cell)
    rooms, walls = frame.rooms, wall_colliders(shell, colliders)
    sites = find_sites(rooms, objects, navigation.climb)
    stairs = [one for site in sites for one in site.upstairs]
    floors = join([*(site.floors(colliders.step) for site in sites), sills(stairs)])
    sides = guards(stairs)
    boxes = [level_boxes(walls, site.objects, site.plan.lowest, colliders) for site in sites]
    fixed = join([*(b.fixed for b in boxes), floors, sides])
    moving, stuck, too_many = choose_movables(objects, by_object([b.objects for b in boxes]), fixed, rooms, movables)
    found = [_obstacles(site, b, moving, rooms, colliders, navigation) for site, b in zip(sites, boxes, strict=True)]
    static = join(level.static for level in found)
    rails = edge_barriers([s.plan for s in sites], floors, stairs, join([static, sides]), sites[0].plan.lowest)
    unseen = join([sides, rails, fence(rooms)])
    fixtures = static_colliders(found, floors, unseen)
    ramps = make_ramps(stairs, len(fixtures.pos))
    leaves = [leaf for o in objects for leaf in o.leaves]
    around = join(level.things for level in found), join(level.boxes.walls for level in found)
    doors = make_doors(leaves, *around, movable=join(candidate.box for candidate in moving))
    blocked = join([sides, rails, ajar_leaves(leaves, *around)])
    return Levels(
        spaces=_spaces(sites, found, blocked, rooms, colliders, navigation),
        doorways=[site.doorways for site in sites],
        leaves=[_leaf_boxes(objects, doors, site.number) for site in sites],
        open_leaves=[_leaf_boxes(objects, doors, site.number, all_angles=False) for site in sites],
        stairs=stairs,
        colliders=with_ramps(fixtures, ramps),
        ramps=ramps,
        bodies=make_bodies(moving),
        doors=doors,
        stuck=np.array(stuck, np.int32),
        report={
            "movable_but_stuck": len(stuck),
            "movable_but_too_many": too_many,
            "leaves_not_solid": sum(len(level.boxes.loose) - len(level.felt) for level in found),
            "barriers": sum(len(level.barriers) for level in found) + len(rails),
            "floor_boxes": len(floors),
            "stairs": sum(o.info.coarse == CATEGORY for o in objects),
            "ramps": len(ramps.slope),
        },
    )


def find_sites(rooms: Rooms, objects: Sequence[PlacedObject], climb: bool) -> list[Site]:
    """Return the levels that have rooms, lowest first; the ground floor includes objects of other levels.

    Objects out of reach of agents are omitted.

    Args:
        rooms: Outlines and floors.
        objects: Objects of all levels.
        climb: True if agents use stairs.
    """
    numbers = np.unique(rooms.level).tolist()
    lowest = np.array([rooms.floor[rooms.level == number].min() for number in numbers])
    stairs = find_stairs(objects, rooms, numbers, lowest) if climb else []
    climbed = {object_id for one in stairs for object_id in one.object_ids}
    near = [o for o in objects if o.room >= 0 or within_reach(bounds(o.triangles), rooms)]
    doorways, sites = find_doorways(objects, rooms), []
    for grid, number in enumerate(numbers):
        here = [doorway for doorway in doorways if doorway.level == number]
        sites.append(
            Site(
                grid=grid,
                number=number,
                plan=plan_floors(rooms, number, [d.footprint for d in here if not d.leads_outdoors], stairs, grid),
                objects=[o for o in near if o.object_id not in climbed and (grid == 0 or o.level == number)],
                doorways=here,
                upstairs=[one for one in stairs if one.lower == grid],
                downstairs=[one for one in stairs if one.upper == grid],
            )
        )
    return sites


def _obstacles(
    site: Site,
    boxes: LevelBoxes,
    moving: Sequence[Candidate],
    rooms: Rooms,
    colliders: ColliderOptions,
    navigation: NavigationOptions,
) -> Obstacles:
    """Return the obstacles of a level, with barriers where it has gaps to the outdoors."""
    sides = join([guards([*site.upstairs, *site.downstairs]), site.raised(colliders.step)])

    def free_area(around: BoxSet) -> float:
        return _space(site, join([around, sides]), rooms, navigation).free.sum() * navigation.cell**2

    obstacles = find_obstacles(boxes, moving, free_area)
    indoors = [doorway.footprint for doorway in site.doorways if not doorway.leads_outdoors]
    indoors += [outline for one in (*site.upstairs, *site.downstairs) for outline in one.outlines]
    barriers = find_barriers(rooms, site.number, obstacles.static, indoors, colliders.wall_length)
    return replace(obstacles, barriers=barriers)


def _space(
    site: Site, around: BoxSet, rooms: Rooms, options: NavigationOptions, fixed: BoxSet | None = None
) -> FreeSpace:
    """Compute the free space of a level between boxes, of which `fixed` cannot be moved (None: all are fixed)."""
    gaps = [doorway.footprint for doorway in site.doorways]
    return free_space(rooms, around, gaps, options, site.number, site.upstairs, site.downstairs, fixed)


def _spaces(
    sites: Sequence[Site],
    obstacles: Sequence[Obstacles],
    rails: BoxSet,
    rooms: Rooms,
    colliders: ColliderOptions,
    options: NavigationOptions,
) -> list[FreeSpace]:
    """Compute the free space of each level; obstacles of all levels count, since stairs lead past the next level."""
    around, fixed = (
        distinct(join([*boxes, rails])) for boxes in zip(*((o.all, o.static) for o in obstacles), strict=True)
    )
    spaces = []
    for site in sites:
        raised = site.raised(colliders.step)
        spaces.append(_space(site, join([around, raised]), rooms, options, join([fixed, raised])))
    if not spaces[0].standable.any():
        raise nowhere_to_stand(_space(sites[0], obstacles[0].boxes.walls, rooms, options), options)
    return spaces


def _leaf_boxes(objects: Sequence[PlacedObject], doors: Doors, level: int, all_angles: bool = True) -> BoxSet:
    """Return boxes of a level's leaves that turn: initial, closed and wide open, or only wide open."""
    leaves = [(o.level, leaf) for o in objects for leaf in o.leaves]
    angles = zip(leaves, np.clip(0, doors.low, doors.high), doors.closed, doors.wide, strict=True)
    used = slice(0 if all_angles else 2, None)
    return join(leaf.box_at(float(a)) for (at, leaf), *three in angles if at == level for a in three[used])
