"""The levels of a house: what stops bodies on them, and where agents can stand. One loop, the ground floor among them.

Only the ground floor has physics: there objects move, leaves of doors are felt, and floors of raised rooms are boxes.
Agents that climb find the upper floors with nothing but walls and furniture, and every door open.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.scene_compile.architecture.frame import Frame
from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.collision.colliders import ColliderOptions, floor_colliders, passages, wall_colliders
from home_mjx.scene_compile.collision.level import (
    LevelBoxes,
    Obstacles,
    find_obstacles,
    level_boxes,
    static_colliders,
)
from home_mjx.scene_compile.collision.movables import Candidate, MovableOptions, choose_movables, make_bodies
from home_mjx.scene_compile.geometry.boxes import BoxSet, join
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions, free_space
from home_mjx.scene_compile.navigation.nowhere import nowhere_to_stand
from home_mjx.scene_compile.navigation.stairs import Stairs, find_stairs
from home_mjx.scene_compile.objects.doors import make_doors
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
        holes: Over stairs from below, where nobody can stand.
    """

    number: int
    floor: float
    is_ground: bool
    objects: Sequence[PlacedObject]
    walls: BoxSet
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
        doorways: Footprints of the doors of each of these levels [m].
        stairs: Flights between them.
        colliders: Static boxes of the ground floor; those of door leaves as they stand are the last.
        bodies: Objects that can be pushed.
        doors: Leaves of all doors.
        stuck: Ids of objects that could be pushed if they did not stand in something.
        report: Counts.
    """

    spaces: Sequence[FreeSpace]
    doorways: Sequence[Sequence[Float[np.ndarray, "4 2"]]]
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
    sites = [
        _site(grid, number, float(floor), frame.rooms, objects, walls, stairs, colliders)
        for grid, (number, floor) in enumerate(zip(numbers, floors, strict=True))
    ]
    levels = [_level(site, frame.rooms, colliders, movables, navigation) for site in sites]
    ground = levels[0].obstacles
    static, leaf_row = static_colliders(ground)
    stuck = [object_id for level in levels for object_id in level.stuck]
    return Levels(
        spaces=[level.space for level in levels],
        doorways=[passages([o for o in objects if o.level == number]) for number in numbers],
        stairs=stairs,
        colliders=static,
        bodies=make_bodies(ground.moving),
        doors=_doors(objects, leaf_row),
        stuck=np.array(stuck, np.int32),
        report={"movable_but_stuck": len(stuck), "leaves_not_solid": len(ground.boxes.leaves) - len(ground.felt)},
    )


def _site(
    grid: int,
    number: int,
    floor: float,
    rooms: Rooms,
    objects: Sequence[PlacedObject],
    walls: BoxSet,
    stairs: Sequence[Stairs],
    options: ColliderOptions,
) -> Site:
    """The level of a grid; objects of other levels reach into the ground floor only."""
    holes = join(flight.hole for flight in stairs if flight.upper == grid)
    if grid == 0:
        return Site(number, floor, True, objects, join([walls, floor_colliders(rooms, floor, options)]), holes)
    return Site(number, floor, False, [o for o in objects if o.level == number], walls, holes)


def _level(
    site: Site, rooms: Rooms, colliders: ColliderOptions, movables: MovableOptions, navigation: NavigationOptions
) -> Level:
    """What is in the way on a level, what of it moves, and where an agent can stand between."""
    boxes = level_boxes(site.walls, site.objects, site.floor, colliders, with_leaves=site.is_ground)
    moving, stuck = _moving(site, boxes, movables)
    gaps = passages(site.objects)

    def space(around: BoxSet) -> FreeSpace:
        return free_space(rooms, join([around, site.holes]), gaps, navigation, site.number)

    obstacles = find_obstacles(boxes, moving, lambda around: space(around).free.sum() * navigation.cell**2)
    left = space(obstacles.all)
    if site.is_ground and not left.standable.any():
        raise nowhere_to_stand(space(boxes.walls), navigation)
    return Level(obstacles, left, stuck)


def _moving(site: Site, boxes: LevelBoxes, options: MovableOptions) -> tuple[list[Candidate], list[int]]:
    """The objects of a level that can be pushed, and ids of those that could be if they did not stand in something."""
    if not site.is_ground:
        return [], []
    return choose_movables(site.objects, boxes.objects, boxes.fixed, site.floor, site.number, options)


def _doors(objects: Sequence[PlacedObject], leaf_row: Mapping[tuple[int, int], int]) -> Doors:
    """Leaves of all doors, and the row of the collider that stands for each."""
    rows = [leaf_row.get((o.object_id, number), -1) for o in objects for number in range(len(o.leaves))]
    return make_doors([leaf for o in objects for leaf in o.leaves], rows)
