"""One level of a house: its collision boxes, which objects move, and where an agent can stand between them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from home_mjx.scene_compile.collision.colliders import (
    ColliderOptions,
    keep_reachable,
    not_hidden,
    object_colliders,
    passable_leaves,
)
from home_mjx.scene_compile.collision.movables import Candidate
from home_mjx.scene_compile.geometry.boxes import BoxSet, join, no_boxes
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


def level_boxes(
    walls: BoxSet, objects: Sequence[PlacedObject], floor: float, options: ColliderOptions, with_leaves: bool
) -> LevelBoxes:
    """The boxes that something on a floor can touch.

    Args:
        walls: Of the architecture.
        objects: Those that may reach into the level.
        floor: Height of the level's floor [m].
        options: How boxes are fitted.
        with_leaves: Whether leaves whose hinges are not known are there; without, these doors are wide open.
    """
    fitted = {o.object_id: object_colliders(o, floor, options) for o in objects}
    loose = [LooseLeaf(i, leaf) for i, (_, leaves) in fitted.items() for leaf in leaves] if with_leaves else []
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
        leaves = (leaf.box for leaf in self.felt)
        return join([self.boxes.walls, *self.standing.values(), *leaves, self.barriers])

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


def static_colliders(obstacles: Obstacles, fence: BoxSet) -> Colliders:
    """The boxes that stay, without those behind others; the barriers and then the fence are the last.

    Args:
        obstacles: Of the level.
        fence: Around the lot.
    """
    standing = obstacles.standing
    counts = [(-1, len(obstacles.boxes.walls)), *((i, len(b)) for i, b in standing.items())]
    counts += [(leaf.object_id, 1) for leaf in obstacles.felt]
    counts += [(-1, len(obstacles.barriers) + len(fence))]
    boxes = join([obstacles.static, fence])
    shown = not_hidden(boxes) | (np.arange(len(boxes)) >= len(boxes) - len(obstacles.barriers) - len(fence))
    return boxes[shown].colliders(np.repeat(*np.array(counts, np.int32).T)[shown])
