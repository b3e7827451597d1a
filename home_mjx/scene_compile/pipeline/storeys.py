"""The levels above a house's ground floor, as agents would find them."""

from collections.abc import Sequence

import numpy as np

from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.collision.colliders import (
    ColliderOptions,
    keep_reachable,
    object_colliders,
    passages,
    wall_colliders,
)
from home_mjx.scene_compile.geometry.boxes import BoxSet, join
from home_mjx.scene_compile.navigation.free_space import NavigationOptions, Storeys, free_space
from home_mjx.scene_compile.navigation.stairs import find_stairs
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import Rooms


def find_storeys(
    shell: Shell,
    rooms: Rooms,
    objects: Sequence[PlacedObject],
    colliders: ColliderOptions,
    options: NavigationOptions,
) -> Storeys:
    """Free space of the upper levels, the doors of all levels, and the stairs between them.

    Args:
        shell: Walls.
        rooms: Outlines and floors.
        objects: Of all levels.
        colliders: How boxes are fitted.
        options: Sizes of an agent.
    """
    levels = np.unique(rooms.level).tolist()
    floors = np.array([rooms.floor[rooms.level == level].min() for level in levels])
    stairs = find_stairs(objects, levels, floors)
    doorways = [passages([o for o in objects if o.level == level]) for level in levels]
    upper = []
    for grid, level in enumerate(levels[1:], 1):
        solid = _obstacles(shell, [o for o in objects if o.level == level], float(floors[grid]), colliders)
        holes = join(flight.hole for flight in stairs if flight.upper == grid)
        upper.append(free_space(rooms, join([solid, holes]), doorways[grid], options, level))
    return Storeys(upper, doorways, stairs)


def _obstacles(shell: Shell, objects: Sequence[PlacedObject], floor: float, colliders: ColliderOptions) -> BoxSet:
    """Walls and furniture of one level; door leaves are thought open."""
    walls = keep_reachable(wall_colliders(shell, colliders), floor, colliders)
    return join([walls, *(object_colliders(o, floor, colliders)[0] for o in objects)])
