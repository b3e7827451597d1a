"""Levels of a house: colliders, floors, doors, movable bodies and free space."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int

from home_mjx.geometry.boxes import BoxSet, concat_boxes, unique_boxes
from home_mjx.geometry.meshes import bounds
from home_mjx.scene_compile.architecture.rooms import HouseFrame
from home_mjx.scene_compile.architecture.shell import BuildingShell
from home_mjx.scene_compile.collision.barriers import build_fence, find_barriers, is_within_lot
from home_mjx.scene_compile.collision.colliders import ColliderOptions, wall_colliders
from home_mjx.scene_compile.collision.drop_barriers import build_drop_barriers
from home_mjx.scene_compile.collision.floors import FloorPlan, plan_floors
from home_mjx.scene_compile.collision.level_colliders import (
    LevelBoxes,
    Obstacles,
    find_obstacles,
    level_boxes,
    merge_by_object,
    static_colliders,
)
from home_mjx.scene_compile.collision.movable_selection import select_movables
from home_mjx.scene_compile.collision.movables import MovableCandidate, MovableOptions, make_bodies
from home_mjx.scene_compile.collision.ramps import append_ramps, build_guards, build_sills, make_ramps
from home_mjx.scene_compile.navigation.free_space import (
    FreeSpace,
    NavigationOptions,
    find_free_space,
    no_free_space_error,
)
from home_mjx.scene_compile.objects.doorways import Doorway, find_doorways
from home_mjx.scene_compile.objects.insides import find_compartments, find_insides
from home_mjx.scene_compile.objects.leaves import find_blocking_leaves, make_doors
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.scene_compile.objects.stairs import STAIRS_CATEGORY, Staircase, find_stairs
from home_mjx.scene_compile.pipeline.limits import check_levels
from home_mjx.schema.compiled import Bodies, Colliders, Compartments, Doors, Ramps, RoomTable


@dataclass(frozen=True)
class LevelSite:
    """Inputs of a level that has rooms, before its obstacles are computed.

    Attributes:
        grid: Index among the levels that have rooms, lowest first.
        level: Level index.
        plan: Floor plan.
        objects: Objects that may extend into the level, without stairs that agents climb.
        doorways: Doorways of its doors.
        upstairs: Stairs that begin on this level.
        downstairs: Stairs that end on this level.
    """

    grid: int
    level: int
    plan: FloorPlan
    objects: Sequence[PlacedObject]
    doorways: Sequence[Doorway]
    upstairs: Sequence[Staircase]
    downstairs: Sequence[Staircase]

    def floors(self, step: float) -> BoxSet:
        """Return the boxes of the level's floors; the lowest level has none up to `step` [m] above its lowest floor.

        The ground plane is there instead.
        """
        return self.plan.boxes(self.plan.lowest + step if self.grid == 0 else -np.inf)

    def raised_floors(self, step: float) -> BoxSet:
        """Return boxes of the floors more than `step` [m] above the level's lowest floor."""
        return self.plan.boxes(self.plan.lowest + step)


@dataclass(frozen=True)
class LevelGeometry:
    """Colliders, bodies, doors and free space of a house.

    Attributes:
        spaces: Free space of each level that has rooms, lowest first.
        doorways: Doorways of each of these levels.
        leaves: Boxes on each of these levels of leaves that turn or slide: initial, closed and wide open.
        open_leaves: The same, only wide open.
        stairs: Stairs between them that agents climb.
        colliders: Static boxes of all levels; barriers, a fence of four boxes and the ramps are last.
        ramps: Slopes of the stairs.
        bodies: Movable objects.
        doors: Leaves that turn or slide, of all levels.
        compartments: Free boxes behind those of furniture.
        stuck_objects: Ids of objects of movable categories that are not free to move.
        report: Counts.
    """

    spaces: Sequence[FreeSpace]
    doorways: Sequence[Sequence[Doorway]]
    leaves: Sequence[BoxSet]
    open_leaves: Sequence[BoxSet]
    stairs: Sequence[Staircase]
    colliders: Colliders
    ramps: Ramps
    bodies: Bodies
    doors: Doors
    compartments: Compartments
    stuck_objects: Int[np.ndarray, " n"]
    report: Mapping[str, int]


def build_levels(
    frame: HouseFrame,
    shell: BuildingShell,
    objects: Sequence[PlacedObject],
    colliders: ColliderOptions,
    movables: MovableOptions,
    navigation: NavigationOptions,
) -> LevelGeometry:
    """Compute the colliders, bodies, doors and free space of all levels of a house, from the objects of all levels.

    Raises:
        DatasetError: The house exceeds the `limits`, or its ground floor has no standable cell.
    """
    check_levels(frame, shell, navigation.cell)
    rooms, walls = frame.rooms, wall_colliders(shell, colliders)
    sites = find_level_sites(rooms, objects, navigation.use_stairs)
    stairs = [one for site in sites for one in site.upstairs]
    floors = concat_boxes([*(site.floors(colliders.min_top_height) for site in sites), build_sills(stairs)])
    sides = build_guards(stairs)
    boxes = [level_boxes(walls, site.objects, site.plan.lowest, colliders) for site in sites]
    fixed = concat_boxes([*(b.fixed for b in boxes), floors, sides])
    moving, stuck, too_many = select_movables(
        objects, merge_by_object([b.objects for b in boxes]), fixed, rooms, movables
    )
    found = [_obstacles(site, b, moving, rooms, colliders, navigation) for site, b in zip(sites, boxes, strict=True)]
    static = concat_boxes(level.static for level in found)
    rails = build_drop_barriers(
        [s.plan for s in sites], floors, stairs, concat_boxes([static, sides]), sites[0].plan.lowest
    )
    unseen = concat_boxes([sides, rails, build_fence(rooms)])
    fixtures = static_colliders(found, floors, unseen)
    ramps = make_ramps(stairs, len(fixtures.pos))
    leaves = [leaf for o in objects for leaf in o.leaves]
    around = (
        concat_boxes(level.static_without_walls for level in found),
        concat_boxes(level.boxes.walls for level in found),
    )
    own = merge_by_object([b.objects for b in boxes])
    bodies = {
        leaf.instance: own[o.object_id] for o in objects for leaf in o.leaves if leaf.is_front and o.object_id in own
    }
    doors = make_doors(leaves, *around, concat_boxes(candidate.box for candidate in moving), bodies)
    blocked = concat_boxes([sides, rails, find_blocking_leaves(leaves, *around), *find_insides(objects)])
    return LevelGeometry(
        spaces=_spaces(sites, found, blocked, rooms, colliders, navigation),
        doorways=[site.doorways for site in sites],
        leaves=[_leaf_boxes(objects, doors, site.level) for site in sites],
        open_leaves=[_leaf_boxes(objects, doors, site.level, all_angles=False) for site in sites],
        stairs=stairs,
        colliders=append_ramps(fixtures, ramps),
        ramps=ramps,
        bodies=make_bodies(moving),
        doors=doors,
        compartments=find_compartments(objects),
        stuck_objects=np.array(stuck, np.int32),
        report={
            "movable_but_stuck": len(stuck),
            "movable_but_too_many": too_many,
            "leaves_not_solid": sum(len(level.boxes.unhinged) - len(level.solid_leaves) for level in found),
            "barriers": sum(len(level.barriers) for level in found) + len(rails),
            "floor_boxes": len(floors),
            "stairs": sum(o.info.coarse == STAIRS_CATEGORY for o in objects),
            "ramps": len(ramps.slope),
        },
    )


def find_level_sites(rooms: RoomTable, objects: Sequence[PlacedObject], climb: bool) -> list[LevelSite]:
    """Return the levels that have rooms, lowest first, each with its own level's objects that agents can reach.

    These are in a room, or partly within the lot. The lowest level has the reachable objects of all levels, since they
    may extend into it. If `climb`, the stairs that agents use are not among the objects of any level.
    """
    numbers = np.unique(rooms.level).tolist()
    lowest = np.array([rooms.floor[rooms.level == number].min() for number in numbers])
    stairs = find_stairs(objects, rooms, numbers, lowest) if climb else []
    climbed = {object_id for one in stairs for object_id in one.object_ids}
    near = [o for o in objects if o.room >= 0 or is_within_lot(bounds(o.triangles), rooms)]
    doorways, sites = find_doorways(objects, rooms), []
    for grid, number in enumerate(numbers):
        here = [doorway for doorway in doorways if doorway.level == number]
        sites.append(
            LevelSite(
                grid=grid,
                level=number,
                plan=plan_floors(rooms, number, [d.footprint for d in here if not d.leads_outdoors], stairs, grid),
                objects=[o for o in near if o.object_id not in climbed and (grid == 0 or o.level == number)],
                doorways=here,
                upstairs=[one for one in stairs if one.lower == grid],
                downstairs=[one for one in stairs if one.upper == grid],
            )
        )
    return sites


def _obstacles(
    site: LevelSite,
    boxes: LevelBoxes,
    moving: Sequence[MovableCandidate],
    rooms: RoomTable,
    colliders: ColliderOptions,
    navigation: NavigationOptions,
) -> Obstacles:
    """Return the obstacles of a level, with barriers where it has gaps to the outdoors.

    Leaves without a known hinge are included only where they do not cut off a part of the level.
    """
    sides = concat_boxes(
        [build_guards([*site.upstairs, *site.downstairs]), site.raised_floors(colliders.min_top_height)]
    )

    def free_area(around: BoxSet) -> float:
        """Return the area [m^2] of the largest free region between boxes, guards of stairs and raised floors."""
        return _space(site, concat_boxes([around, sides]), rooms, navigation).free.sum() * navigation.cell**2

    obstacles = find_obstacles(boxes, moving, free_area)
    indoors = [doorway.footprint for doorway in site.doorways if not doorway.leads_outdoors]
    indoors += [outline for one in (*site.upstairs, *site.downstairs) for outline in one.outlines]
    barriers = find_barriers(rooms, site.level, obstacles.static, indoors, colliders.max_wall_length)
    return replace(obstacles, barriers=barriers)


def _space(
    site: LevelSite, around: BoxSet, rooms: RoomTable, options: NavigationOptions, fixed: BoxSet | None = None
) -> FreeSpace:
    """Compute the free space of a level between boxes, of which `fixed` cannot be moved (None: all are fixed)."""
    gaps = [doorway.footprint for doorway in site.doorways if not doorway.leads_outdoors]
    return find_free_space(rooms, around, gaps, options, site.level, site.upstairs, site.downstairs, fixed)


def _spaces(
    sites: Sequence[LevelSite],
    obstacles: Sequence[Obstacles],
    rails: BoxSet,
    rooms: RoomTable,
    colliders: ColliderOptions,
    options: NavigationOptions,
) -> list[FreeSpace]:
    """Compute the free space of each level; obstacles of all levels count, since stairs lead past the next level.

    `rails` are further boxes that cannot be moved. Each level's raised floors are obstacles on that level only.
    Raise `DatasetError` if no floor, or no cell of the lowest level, is standable.
    """
    around, fixed = (
        unique_boxes(concat_boxes([*boxes, rails]))
        for boxes in zip(*((o.all, o.static) for o in obstacles), strict=True)
    )
    spaces = []
    for site in sites:
        raised = site.raised_floors(colliders.min_top_height)
        spaces.append(_space(site, concat_boxes([around, raised]), rooms, options, concat_boxes([fixed, raised])))
    has_floor = any((space.standable & ~space.on_ramp).any() for space in spaces)
    if not (has_floor and spaces[0].standable.any()):
        raise no_free_space_error(_space(sites[0], obstacles[0].boxes.walls, rooms, options), options)
    return spaces


def _leaf_boxes(objects: Sequence[PlacedObject], doors: Doors, level: int, all_angles: bool = True) -> BoxSet:
    """Return three boxes of each leaf of a level: initial, closed and wide open; only wide open if not `all_angles`.

    Fronts of furniture, which are shut, have none.
    """
    leaves = [(o.level, leaf) for o in objects for leaf in o.leaves]
    angles = zip(leaves, np.clip(0, doors.low, doors.high), doors.closed, doors.fully_open, strict=True)
    used = slice(0 if all_angles else 2, None)
    return concat_boxes(
        leaf.box_at(float(a)) for (at, leaf), *three in angles if at == level and not leaf.is_front for a in three[used]
    )
