"""The levels of a house: what stops bodies on them, and where agents can stand. One loop, the ground floor among them.

Only the ground floor has physics: there objects move, leaves of doors are felt, and floors of raised rooms are boxes.
Agents that climb find the upper floors with nothing but walls and furniture, and every door open.
"""

from collections.abc import Iterator, Mapping, Sequence
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
from home_mjx.scene_compile.navigation.stairs import Stairs, find_stairs
from home_mjx.scene_compile.objects.doors import make_doors
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.scene_compile.pipeline.limits import check_levels
from home_mjx.schema.compiled import Bodies, Colliders, Doors


@dataclass(frozen=True)
class Site:
    """A level that has rooms, before anything is known of what is in the way there."""

    number: int  # level index
    floor: float  # [m], the lowest of its rooms
    is_ground: bool
    objects: Sequence[PlacedObject]  # those that may reach into it
    walls: BoxSet  # and what else of the architecture may


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
        DatasetError: The house is too large, see `limits`.
    """
    check_levels(frame, shell, navigation.cell)
    numbers = np.unique(frame.rooms.level).tolist()
    floors = np.array([frame.rooms.floor[frame.rooms.level == number].min() for number in numbers])
    stairs = find_stairs(objects, numbers, floors)
    walls = wall_colliders(shell, colliders)
    found, spaces, stuck = [], [], []
    for site in _sites(frame, objects, walls, list(zip(numbers, floors.tolist(), strict=True)), colliders):
        boxes = level_boxes(site.walls, site.objects, site.floor, colliders, with_leaves=site.is_ground)
        moving, fixed = _moving(site, boxes, movables)
        holes = join(flight.hole for flight in stairs if flight.upper == len(spaces))
        obstacles, space = _free(frame, site, boxes, moving, holes, navigation)
        found.append(obstacles)
        spaces.append(space)
        stuck += fixed
    static, leaf_row = static_colliders(found[0])
    hinged = [(leaf, leaf_row.get((o.object_id, i), -1)) for o in objects for i, leaf in enumerate(o.leaves)]
    return Levels(
        spaces=spaces,
        doorways=[passages([o for o in objects if o.level == number]) for number in numbers],
        stairs=stairs,
        colliders=static,
        bodies=make_bodies(found[0].moving),
        doors=make_doors([leaf for leaf, _ in hinged], [row for _, row in hinged]),
        stuck=np.array(stuck, np.int32),
        report={
            "movable_but_stuck": len(stuck),
            "leaves_not_solid": len(found[0].boxes.leaves) - len(found[0].felt),
        },
    )


def _sites(
    frame: Frame,
    objects: Sequence[PlacedObject],
    walls: BoxSet,
    levels: Sequence[tuple[int, float]],
    options: ColliderOptions,
) -> Iterator[Site]:
    """The levels by number and height of their floor, the lowest first."""
    for grid, (number, floor) in enumerate(levels):
        if grid == 0:
            raised = floor_colliders(frame.rooms, floor, options)
            yield Site(number, floor, True, objects, join([walls, raised]))
        else:
            yield Site(number, floor, False, [o for o in objects if o.level == number], walls)


def _moving(site: Site, boxes: LevelBoxes, options: MovableOptions) -> tuple[list[Candidate], list[int]]:
    """The objects of a level that can be pushed, and ids of those that could be if they did not stand in something."""
    if not site.is_ground:
        return [], []
    return choose_movables(site.objects, boxes.objects, boxes.fixed, site.floor, site.number, options)


def _free(
    frame: Frame,
    site: Site,
    boxes: LevelBoxes,
    moving: Sequence[Candidate],
    holes: BoxSet,
    options: NavigationOptions,
) -> tuple[Obstacles, FreeSpace]:
    """What is in an agent's way on a level, and the space that it leaves."""
    gaps = passages(site.objects)

    def space(obstacles: BoxSet) -> FreeSpace:
        return free_space(frame.rooms, join([obstacles, holes]), gaps, options, site.number)

    obstacles = find_obstacles(boxes, moving, lambda around: space(around).free.sum() * options.cell**2)
    return obstacles, space(obstacles.all)
