"""The levels of a house: what stops bodies on them, and where agents can stand. One loop, the ground floor among them.

Only the ground floor has physics: there objects move, and floors of raised rooms are boxes.
Agents that climb find the upper floors with nothing but walls and furniture, and every door open or passable.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.architecture.frame import Frame
from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.collision.barriers import fence, find_barriers
from home_mjx.scene_compile.collision.colliders import ColliderOptions, floor_colliders, wall_colliders
from home_mjx.scene_compile.collision.level import (
    LevelBoxes,
    Obstacles,
    find_obstacles,
    level_boxes,
    static_colliders,
)
from home_mjx.scene_compile.collision.movables import Candidate, MovableOptions, choose_movables, make_bodies
from home_mjx.scene_compile.geometry.boxes import BoxSet, footprint, join
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions, free_space
from home_mjx.scene_compile.navigation.nowhere import nowhere_to_stand
from home_mjx.scene_compile.navigation.stairs import Stairs, find_stairs
from home_mjx.scene_compile.objects.doorways import Doorway, find_doorways
from home_mjx.scene_compile.objects.leaves import ajar_leaves, make_doors
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.scene_compile.pipeline.limits import check_levels
from home_mjx.schema.compiled import Bodies, Colliders, Doors, Rooms


@dataclass(frozen=True)
class Site:
    """A level that has rooms, before anything is known of what is in the way there.

    Attributes:
        number: Level index.
        floor: Height of the lowest of its rooms' floors [m].
        is_ground: Whether it is the lowest.
        objects: Those that may reach into it.
        walls: Boxes of the architecture that may.
        doorways: Of its doors.
        holes: Over stairs from below, where nobody can stand.
    """

    number: int
    floor: float
    is_ground: bool
    objects: Sequence[PlacedObject]
    walls: BoxSet
    doorways: Sequence[Doorway]
    holes: BoxSet


@dataclass(frozen=True)
class Level:
    """What was found on a level.

    Attributes:
        obstacles: What is in an agent's way.
        space: Where an agent can stand.
        stuck: Ids of objects that could be pushed if they did not stand in something.
    """

    obstacles: Obstacles
    space: FreeSpace
    stuck: Sequence[int]


@dataclass(frozen=True)
class Levels:
    """What stops bodies in a house, and where agents can stand.

    Attributes:
        spaces: Free space of each level that has rooms, the lowest first.
        doorways: Of each of these levels.
        leaves: Boxes of the leaves of each of these levels that turn, as placed, closed and wide open.
        stairs: Flights between them.
        colliders: Static boxes of the ground floor; barriers, and a fence of four boxes, are the last.
        bodies: Objects that can be pushed.
        doors: Leaves that turn, of all levels.
        stuck: Ids of objects that could be pushed if they did not stand in something.
        report: Counts.
    """

    spaces: Sequence[FreeSpace]
    doorways: Sequence[Sequence[Doorway]]
    leaves: Sequence[BoxSet]
    stairs: Sequence[Stairs]
    colliders: Colliders
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
    """What stops bodies on each level of a house, and where agents can stand.

    Args:
        frame: Rooms.
        shell: Walls.
        objects: Of all levels.
        colliders: How boxes are fitted.
        movables: What can be pushed.
        navigation: Size of an agent and of a cell.

    Raises:
        DatasetError: The house is too large, see `limits`, or an agent can stand nowhere on its ground floor.
    """
    check_levels(frame, shell, navigation.cell)
    numbers = np.unique(frame.rooms.level).tolist()
    floors = np.array([frame.rooms.floor[frame.rooms.level == number].min() for number in numbers])
    stairs = find_stairs(objects, numbers, floors)
    walls = wall_colliders(shell, colliders)
    doorways = find_doorways(objects, frame.rooms)
    sites = [
        _site(grid, number, float(floor), frame.rooms, objects, walls, doorways, stairs, colliders)
        for grid, (number, floor) in enumerate(zip(numbers, floors, strict=True))
    ]
    levels = [_level(site, frame.rooms, colliders, movables, navigation) for site in sites]
    ground = levels[0].obstacles
    static = join(level.obstacles.static for level in levels)
    doors = make_doors([leaf for o in objects for leaf in o.leaves], static)
    stuck = [object_id for level in levels for object_id in level.stuck]
    return Levels(
        spaces=[level.space for level in levels],
        doorways=[site.doorways for site in sites],
        leaves=[_leaf_boxes(objects, doors, number) for number in numbers],
        stairs=stairs,
        colliders=static_colliders(ground, fence(frame.rooms)),
        bodies=make_bodies(ground.moving),
        doors=doors,
        stuck=np.array(stuck, np.int32),
        report={
            "movable_but_stuck": len(stuck),
            "leaves_not_solid": len(ground.boxes.loose) - len(ground.felt),
            "barriers": len(ground.barriers),
        },
    )


def _site(
    grid: int,
    number: int,
    floor: float,
    rooms: Rooms,
    objects: Sequence[PlacedObject],
    walls: BoxSet,
    doorways: Sequence[Doorway],
    stairs: Sequence[Stairs],
    options: ColliderOptions,
) -> Site:
    """The level of a grid; objects of other levels reach into the ground floor only."""
    holes = join(flight.hole for flight in stairs if flight.upper == grid)
    here = [doorway for doorway in doorways if doorway.level == number]
    if grid == 0:
        return Site(number, floor, True, objects, join([walls, floor_colliders(rooms, floor, options)]), here, holes)
    return Site(number, floor, False, [o for o in objects if o.level == number], walls, here, holes)


def _level(
    site: Site, rooms: Rooms, colliders: ColliderOptions, movables: MovableOptions, navigation: NavigationOptions
) -> Level:
    """What is in the way on a level, what of it moves, and where an agent can stand between."""
    boxes = level_boxes(site.walls, site.objects, site.floor, colliders, with_leaves=site.is_ground)
    moving, stuck = _moving(site, boxes, movables)
    gaps = [doorway.footprint for doorway in site.doorways]

    def space(around: BoxSet) -> FreeSpace:
        return free_space(rooms, join([around, site.holes]), gaps, navigation, site.number)

    obstacles = find_obstacles(boxes, moving, lambda around: space(around).free.sum() * navigation.cell**2)
    indoors = [doorway.footprint for doorway in site.doorways if not doorway.leads_outdoors]
    indoors += [footprint(site.holes, i) for i in range(len(site.holes))]
    barriers = find_barriers(rooms, site.number, obstacles.static, indoors, colliders.wall_length)
    obstacles = replace(obstacles, barriers=barriers)
    ajar = ajar_leaves([leaf for o in site.objects if o.level == site.number for leaf in o.leaves], obstacles.static)
    left = space(join([obstacles.all, ajar]))
    if site.is_ground and not left.standable.any():
        raise nowhere_to_stand(space(boxes.walls), navigation)
    return Level(obstacles, left, stuck)


def _moving(site: Site, boxes: LevelBoxes, options: MovableOptions) -> tuple[list[Candidate], list[int]]:
    """The objects of a level that can be pushed, and ids of those that could be if they did not stand in something."""
    if not site.is_ground:
        return [], []
    return choose_movables(site.objects, boxes.objects, boxes.fixed, site.floor, site.number, options)


def _leaf_boxes(objects: Sequence[PlacedObject], doors: Doors, level: int) -> BoxSet:
    """The leaves of a level that turn, each as placed, closed and wide open."""
    leaves = [(o.level, leaf) for o in objects for leaf in o.leaves]
    angles = zip(leaves, np.clip(0, doors.low, doors.high), doors.closed, doors.wide, strict=True)
    return join(leaf.box_at(float(a)) for (at, leaf), *three in angles if at == level for a in three)
