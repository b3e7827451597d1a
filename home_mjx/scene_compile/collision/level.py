"""One level of a house: its collision boxes, which objects move, and where an agent can stand between them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.scene_compile.collision.colliders import (
    LEAF_TURN,
    ColliderOptions,
    keep_reachable,
    not_hidden,
    object_colliders,
    passable_leaves,
)
from home_mjx.scene_compile.collision.movables import Candidate
from home_mjx.scene_compile.geometry.boxes import BoxSet, join
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import Colliders


@dataclass(frozen=True)
class LeafBox:
    """The box of a door's leaf as it stands."""

    object_id: int
    number: int  # among the leaves of its object
    is_open: bool
    box: BoxSet


@dataclass(frozen=True)
class LevelBoxes:
    """What may be in an agent's way on a level.

    Attributes:
        walls: Of the architecture.
        objects: Of each object while it cannot be moved, by object id.
        leaves: Of doors.
    """

    walls: BoxSet
    objects: Mapping[int, BoxSet]
    leaves: Sequence[LeafBox]

    @property
    def fixed(self) -> BoxSet:
        """Walls and all leaves: what stays where it is, whichever objects move."""
        return join([self.walls, *(leaf.box for leaf in self.leaves)])


def level_boxes(
    walls: BoxSet, objects: Sequence[PlacedObject], floor: float, options: ColliderOptions, with_leaves: bool
) -> LevelBoxes:
    """The boxes that something on a floor can touch.

    Args:
        walls: Of the architecture.
        objects: Those that may reach into the level.
        floor: Height of the level's floor [m].
        options: How boxes are fitted.
        with_leaves: Whether the leaves of doors are there; without, every door is wide open.
    """
    fitted = {o.object_id: object_colliders(o, floor, options) for o in objects}
    leaves = [leaf for o in objects for leaf in _leaf_boxes(o, fitted[o.object_id][1])] if with_leaves else []
    return LevelBoxes(
        keep_reachable(walls, floor, options),
        {object_id: boxes for object_id, (boxes, _) in fitted.items()},
        [leaf for leaf in leaves if len(keep_reachable(leaf.box, floor, options))],
    )


def _leaf_boxes(item: PlacedObject, boxes: Sequence[BoxSet]) -> list[LeafBox]:
    is_open = [bool(abs(leaf.closed) > LEAF_TURN) for leaf in item.hinged] or [True] * len(boxes)
    return [LeafBox(item.object_id, i, *leaf) for i, leaf in enumerate(zip(is_open, boxes, strict=True))]


@dataclass(frozen=True)
class Obstacles:
    """What is in an agent's way on a level.

    Attributes:
        boxes: All that may be.
        moving: Objects that can be pushed; their boxes stand where the objects do.
        felt: Leaves that stop an agent: the closed ones, then the open ones that leave the way free.
    """

    boxes: LevelBoxes
    moving: Sequence[Candidate]
    felt: Sequence[LeafBox]

    @property
    def standing(self) -> dict[int, BoxSet]:
        """Boxes of the objects that stay, by object id."""
        moving = {c.item.object_id for c in self.moving}
        return {i: boxes for i, boxes in self.boxes.objects.items() if i not in moving}

    @property
    def all(self) -> BoxSet:
        """Every box, also of what can be pushed."""
        static = [self.boxes.walls, *self.standing.values(), *(leaf.box for leaf in self.felt)]
        return join([*static, *(c.box for c in self.moving)])


def find_obstacles(boxes: LevelBoxes, moving: Sequence[Candidate], free_area: Callable[[BoxSet], float]) -> Obstacles:
    """What is in the way: everything but the open leaves that cut off a part of the level.

    Args:
        boxes: All that may be in the way.
        moving: Objects that can be pushed.
        free_area: Size of the largest free region between some boxes [m^2].
    """
    closed = Obstacles(boxes, moving, [leaf for leaf in boxes.leaves if not leaf.is_open])
    around = closed.all
    opened = [leaf.box for leaf in boxes.leaves if leaf.is_open]
    kept = passable_leaves(opened, lambda leaves: free_area(join([around, leaves])))
    felt = [leaf for leaf in boxes.leaves if any(leaf.box is box for box in kept)]
    return Obstacles(boxes, moving, [*closed.felt, *felt])


def static_colliders(obstacles: Obstacles) -> tuple[Colliders, dict[tuple[int, int], int]]:
    """The boxes that stay, and the row of each leaf by its object's id and its number; -1 behind other boxes.

    The boxes of door leaves as they stand are the last.
    """
    standing, felt = obstacles.standing, obstacles.felt
    boxes = join([obstacles.boxes.walls, *standing.values(), *(leaf.box for leaf in felt)])
    counts = [(-1, len(obstacles.boxes.walls)), *((i, len(b)) for i, b in standing.items())]
    owners = np.repeat(*np.array(counts + [(leaf.object_id, 1) for leaf in felt], np.int32).T)
    shown = not_hidden(boxes)
    rows = np.where(shown, np.cumsum(shown) - 1, -1)[len(boxes) - len(felt) :].tolist()
    leaf_row = {(leaf.object_id, leaf.number): row for leaf, row in zip(felt, rows, strict=True)}
    return boxes[shown].colliders(owners[shown]), leaf_row
