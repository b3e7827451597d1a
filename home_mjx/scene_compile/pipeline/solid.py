"""What of a house stops bodies: static boxes, movable objects, and the free space between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.architecture.rooms import ground_floor
from home_mjx.scene_compile.architecture.shell import Shell
from home_mjx.scene_compile.collision.colliders import (
    LEAF_TURN,
    ColliderOptions,
    floor_colliders,
    keep_reachable,
    not_hidden,
    object_colliders,
    passable_leaves,
    passages,
    wall_colliders,
)
from home_mjx.scene_compile.collision.movables import Candidate, MovableOptions, choose_movables
from home_mjx.scene_compile.geometry.boxes import BoxSet, join
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions, free_space
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import Rooms


@dataclass(frozen=True)
class LeafBox:
    """The box of a door's leaf."""

    object_id: int
    number: int  # among the leaves of its object
    is_open: bool
    box: BoxSet


@dataclass(frozen=True)
class Solid:
    """What of a house stops bodies.

    Attributes:
        static: Boxes that stay; those of door leaves as they stand are the last.
        object_id: Of each of them; -1 for the architecture.
        leaf_row: Row of `static` by object id and number of a leaf; -1 if it is behind other boxes.
        movable: Objects that can be pushed.
        stuck: Ids of objects that could be pushed if they did not stand in something.
        space: Where an agent can stand.
        report: Counts.
    """

    static: BoxSet
    object_id: Int[np.ndarray, " n"]
    leaf_row: Mapping[tuple[int, int], int]
    movable: list[Candidate]
    stuck: list[int]
    space: FreeSpace
    report: Mapping[str, int]


def make_solid(
    shell: Shell,
    rooms: Rooms,
    objects: Sequence[PlacedObject],
    colliders: ColliderOptions,
    movables: MovableOptions,
    navigation: NavigationOptions,
) -> Solid:
    """Boxes of a house's ground floor and the free space that they leave."""
    floor, level = ground_floor(rooms), int(rooms.level.min())
    walls = join([wall_colliders(shell, colliders), floor_colliders(rooms, floor, colliders)])
    walls = keep_reachable(walls, floor, colliders)
    fitted = {o.object_id: object_colliders(o, floor, colliders) for o in objects}
    boxes = {i: found for i, (found, _) in fitted.items()}
    leaves = [leaf for o in objects for leaf in _leaves(o, fitted[o.object_id][1], floor, colliders)]
    around = join([walls, *(leaf.box for leaf in leaves)])
    movable, stuck = choose_movables(objects, boxes, around, floor, level, movables)
    moving = {c.item.object_id for c in movable}
    closed = [leaf for leaf in leaves if not leaf.is_open]
    static = join([walls, *(b for i, b in boxes.items() if i not in moving)])
    obstacles = join([static, *(leaf.box for leaf in closed), *(c.box for c in movable)])

    def space(leaf_boxes: BoxSet) -> FreeSpace:
        return free_space(rooms, join([obstacles, leaf_boxes]), passages(objects), navigation)

    opened = [leaf.box for leaf in leaves if leaf.is_open]
    felt = passable_leaves(opened, lambda boxes: space(boxes).free.sum() * navigation.cell**2)
    kept = closed + [leaf for leaf in leaves if any(leaf.box is box for box in felt)]
    static = join([static, *(leaf.box for leaf in kept)])
    counts = [(-1, len(walls)), *((i, len(b)) for i, b in boxes.items() if i not in moving)]
    owners = np.repeat(*np.array(counts + [(leaf.object_id, 1) for leaf in kept], np.int32).T)
    shown = not_hidden(static)
    rows = np.where(shown, np.cumsum(shown) - 1, -1)[len(static) - len(kept) :].tolist()
    return Solid(
        static=static[shown],
        object_id=owners[shown],
        leaf_row={(leaf.object_id, leaf.number): row for leaf, row in zip(kept, rows, strict=True)},
        movable=movable,
        stuck=stuck,
        space=space(join(felt)),
        report={"movable_but_stuck": len(stuck), "leaves_not_solid": len(leaves) - len(kept)},
    )


def _leaves(item: PlacedObject, boxes: Sequence[BoxSet], floor: float, options: ColliderOptions) -> list[LeafBox]:
    """The leaves of a door that something on the floor can touch."""
    hinged = item.parts[1:]
    is_open = [bool(abs(part.closed) > LEAF_TURN) for part in hinged] or [True] * len(boxes)
    found = [LeafBox(item.object_id, i, *leaf) for i, leaf in enumerate(zip(is_open, boxes, strict=True))]
    return [leaf for leaf in found if len(keep_reachable(leaf.box, floor, options))]
