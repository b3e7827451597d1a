"""Collision boxes of one level, with the obstacles that remain for agents."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, unique_boxes
from home_mjx.scene_compile.collision.colliders import (
    ColliderOptions,
    exposed_mask,
    keep_reachable,
    object_colliders,
    select_passable_leaves,
)
from home_mjx.scene_compile.collision.movables import MovableCandidate
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import Colliders


@dataclass(frozen=True)
class UnhingedLeaf:
    """Box of an open leaf without a known hinge: static, or without a collider."""

    object_id: int
    box: BoxSet


@dataclass(frozen=True)
class LevelBoxes:
    """Possible obstacles on a level.

    Attributes:
        walls: Boxes of the architecture.
        objects: Boxes of each object while it is fixed, by object id.
        unhinged: Open leaves without a known hinge.
        hinged: Boxes of leaves that turn or slide, in their initial pose.
    """

    walls: BoxSet
    objects: Mapping[int, BoxSet]
    unhinged: Sequence[UnhingedLeaf]
    hinged: BoxSet

    @property
    def fixed(self) -> BoxSet:
        """Boxes of walls, unhinged leaves and hinged leaves as they are initially; independent of movable objects."""
        return concat_boxes([self.walls, *(leaf.box for leaf in self.unhinged), self.hinged])


def level_boxes(walls: BoxSet, objects: Sequence[PlacedObject], floor: float, options: ColliderOptions) -> LevelBoxes:
    """Return the boxes that agents or objects on a floor can touch: of walls, objects, unhinged and hinged leaves.

    Boxes of an object, fixed or movable, are those in its initial pose without its open leaves. Boxes outside the
    height limits are dropped, not cut. An object without boxes has an empty set.

    Args:
        walls: Boxes of the architecture.
        objects: Objects that may extend into the level.
        floor: Height of the level's floor [m].
        options: Options of box fitting.
    """
    fitted = {o.object_id: object_colliders(o, floor, options) for o in objects}
    loose = [UnhingedLeaf(i, leaf) for i, (_, leaves) in fitted.items() for leaf in leaves]
    return LevelBoxes(
        keep_reachable(walls, floor, options),
        {object_id: boxes for object_id, (boxes, _) in fitted.items()},
        [leaf for leaf in loose if len(keep_reachable(leaf.box, floor, options))],
        keep_reachable(concat_boxes(leaf.box for o in objects for leaf in o.leaves), floor, options),
    )


@dataclass(frozen=True)
class Obstacles:
    """Obstacles of agents on a level.

    Attributes:
        boxes: All possible obstacles.
        movable: Movable objects; their boxes are in their initial pose.
        solid_leaves: Leaves without a known hinge that keep their colliders, since they leave the way free.
        barriers: Invisible boxes that keep agents in the rooms.
    """

    boxes: LevelBoxes
    movable: Sequence[MovableCandidate]
    solid_leaves: Sequence[UnhingedLeaf] = ()
    barriers: BoxSet = field(default_factory=empty_boxes)

    @property
    def fixed_objects(self) -> dict[int, BoxSet]:
        """Boxes of the fixed objects, by object id."""
        moving = {c.item.object_id for c in self.movable}
        return {i: boxes for i, boxes in self.boxes.objects.items() if i not in moving}

    @property
    def static(self) -> BoxSet:
        """Boxes of walls, fixed objects and solid leaves, then the barriers."""
        return concat_boxes([self.boxes.walls, self.static_without_walls])

    @property
    def static_without_walls(self) -> BoxSet:
        """Boxes of fixed objects and solid leaves, then the barriers."""
        return concat_boxes([*self.fixed_objects.values(), *(leaf.box for leaf in self.solid_leaves), self.barriers])

    @property
    def all(self) -> BoxSet:
        """`static`, then movable objects; hinged leaves are omitted, since agents can push them open."""
        return concat_boxes([self.static, *(c.box for c in self.movable)])


def find_obstacles(
    boxes: LevelBoxes, moving: Sequence[MovableCandidate], free_area: Callable[[BoxSet], float]
) -> Obstacles:
    """Return obstacles, without barriers yet, except leaves without a known hinge that cut off a part of the level.

    Args:
        boxes: All possible obstacles.
        moving: Movable objects.
        free_area: Function from boxes to the area of the largest free region between them [m^2].
    """
    around = Obstacles(boxes, moving).all
    kept = select_passable_leaves(
        [leaf.box for leaf in boxes.unhinged], lambda leaves: free_area(concat_boxes([around, leaves]))
    )
    return Obstacles(boxes, moving, [leaf for leaf in boxes.unhinged if any(leaf.box is box for box in kept)])


def static_colliders(levels: Sequence[Obstacles], floors: BoxSet, invisible: BoxSet) -> Colliders:
    """Return the floors, walls, fixed objects, leaves and invisible boxes of all levels, in this order.

    Visible boxes inside another box are omitted. Only boxes of objects and leaves have an object id; others have -1.
    Movable objects and hinged leaves are not included.

    Args:
        levels: Obstacles of each level.
        floors: Floor boxes of all levels.
        invisible: Fences, railings and guards; the levels' barriers precede them.
    """
    objects, loose = (
        merge_by_object([level.fixed_objects for level in levels]),
        {id(leaf.box): leaf for level in levels for leaf in level.solid_leaves}.values(),
    )
    walls = unique_boxes(concat_boxes(level.boxes.walls for level in levels))
    barriers = concat_boxes([*(level.barriers for level in levels), invisible])
    counts = [(-1, len(floors) + len(walls)), *((i, len(b)) for i, b in objects.items())]
    counts += [(leaf.object_id, 1) for leaf in loose] + [(-1, len(barriers))]
    boxes = concat_boxes([floors, walls, *objects.values(), *(leaf.box for leaf in loose), barriers])
    shown = exposed_mask(boxes) | (np.arange(len(boxes)) >= len(boxes) - len(barriers))
    return boxes[shown].colliders(np.repeat(*np.array(counts, np.int32).T)[shown])


def merge_by_object(levels: Sequence[Mapping[int, BoxSet]]) -> dict[int, BoxSet]:
    """Return the boxes of each object on all levels, by object id, without duplicates."""
    found: dict[int, list[BoxSet]] = {}
    for level in levels:
        for object_id, boxes in level.items():
            found.setdefault(object_id, []).append(boxes)
    return {object_id: unique_boxes(concat_boxes(boxes)) for object_id, boxes in found.items()}
