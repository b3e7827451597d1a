"""One level of a house: its collision boxes, which objects move, and where an agent can stand between them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from home_mjx.geometry.boxes import BoxSet, distinct, join, no_boxes
from home_mjx.scene_compile.collision.colliders import (
    ColliderOptions,
    keep_reachable,
    not_hidden,
    object_colliders,
    passable_leaves,
)
from home_mjx.scene_compile.collision.movables import Candidate
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import Colliders


@dataclass(frozen=True)
class LooseLeaf:
    """The box of an open leaf whose hinge is not known: it stays as it stands, or is not felt."""

    object_id: int
    box: BoxSet


@dataclass(frozen=True)
class LevelBoxes:
    """What may be in an agent's way on a level.

    Attributes:
        walls: Of the architecture.
        objects: Of each object while it cannot be moved, by object id.
        loose: Open leaves whose hinges are not known.
        hinged: Leaves that turn, as placed.
    """

    walls: BoxSet
    objects: Mapping[int, BoxSet]
    loose: Sequence[LooseLeaf]
    hinged: BoxSet

    @property
    def fixed(self) -> BoxSet:
        """Walls and all leaves: what stays where it is, whichever objects move."""
        return join([self.walls, *(leaf.box for leaf in self.loose), self.hinged])


def level_boxes(walls: BoxSet, objects: Sequence[PlacedObject], floor: float, options: ColliderOptions) -> LevelBoxes:
    """The boxes that something on a floor can touch.

    Args:
        walls: Of the architecture.
        objects: Those that may reach into the level.
        floor: Height of the level's floor [m].
        options: How boxes are fitted.
    """
    fitted = {o.object_id: object_colliders(o, floor, options) for o in objects}
    loose = [LooseLeaf(i, leaf) for i, (_, leaves) in fitted.items() for leaf in leaves]
    return LevelBoxes(
        keep_reachable(walls, floor, options),
        {object_id: boxes for object_id, (boxes, _) in fitted.items()},
        [leaf for leaf in loose if len(keep_reachable(leaf.box, floor, options))],
        keep_reachable(join(leaf.box for o in objects for leaf in o.leaves), floor, options),
    )


@dataclass(frozen=True)
class Obstacles:
    """What is in an agent's way on a level.

    Attributes:
        boxes: All that may be.
        moving: Objects that can be pushed; their boxes stand where the objects do.
        felt: Leaves of unknown hinge that leave the way free.
        barriers: Invisible boxes that keep agents in the rooms.
    """

    boxes: LevelBoxes
    moving: Sequence[Candidate]
    felt: Sequence[LooseLeaf] = ()
    barriers: BoxSet = field(default_factory=no_boxes)

    @property
    def standing(self) -> dict[int, BoxSet]:
        """Boxes of the objects that stay, by object id."""
        moving = {c.item.object_id for c in self.moving}
        return {i: boxes for i, boxes in self.boxes.objects.items() if i not in moving}

    @property
    def static(self) -> BoxSet:
        """Every box that stays where it is; the barriers are the last."""
        return join([self.boxes.walls, self.things])

    @property
    def things(self) -> BoxSet:
        """These boxes without walls."""
        return join([*self.standing.values(), *(leaf.box for leaf in self.felt), self.barriers])

    @property
    def all(self) -> BoxSet:
        """Every box, also of what can be pushed; leaves that turn can be pushed open and are left out."""
        return join([self.static, *(c.box for c in self.moving)])


def find_obstacles(boxes: LevelBoxes, moving: Sequence[Candidate], free_area: Callable[[BoxSet], float]) -> Obstacles:
    """What is in the way: everything but the leaves of unknown hinge that cut off a part of the level.

    Args:
        boxes: All that may be in the way.
        moving: Objects that can be pushed.
        free_area: Size of the largest free region between some boxes [m^2].
    """
    around = Obstacles(boxes, moving).all
    kept = passable_leaves([leaf.box for leaf in boxes.loose], lambda leaves: free_area(join([around, leaves])))
    return Obstacles(boxes, moving, [leaf for leaf in boxes.loose if any(leaf.box is box for box in kept)])


def static_colliders(levels: Sequence[Obstacles], floors: BoxSet, unseen: BoxSet) -> Colliders:
    """The boxes of all levels that stay, without those that lie in others; the invisible ones are the last.

    Args:
        levels: What is in the way on each.
        floors: Of all levels.
        unseen: Fences, railings and guards; barriers of the levels come before them.
    """
    objects, loose = (
        by_object([level.standing for level in levels]),
        {id(leaf.box): leaf for level in levels for leaf in level.felt}.values(),
    )
    walls = distinct(join(level.boxes.walls for level in levels))
    barriers = join([*(level.barriers for level in levels), unseen])
    counts = [(-1, len(floors) + len(walls)), *((i, len(b)) for i, b in objects.items())]
    counts += [(leaf.object_id, 1) for leaf in loose] + [(-1, len(barriers))]
    boxes = join([floors, walls, *objects.values(), *(leaf.box for leaf in loose), barriers])
    shown = not_hidden(boxes) | (np.arange(len(boxes)) >= len(boxes) - len(barriers))
    return boxes[shown].colliders(np.repeat(*np.array(counts, np.int32).T)[shown])


def by_object(levels: Sequence[Mapping[int, BoxSet]]) -> dict[int, BoxSet]:
    """Boxes by object id: those that something on any of the levels can touch."""
    found: dict[int, list[BoxSet]] = {}
    for level in levels:
        for object_id, boxes in level.items():
            found.setdefault(object_id, []).append(boxes)
    return {object_id: distinct(join(boxes)) for object_id, boxes in found.items()}
