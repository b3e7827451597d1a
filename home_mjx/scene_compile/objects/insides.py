"""Insides of furniture in the world: what agents cannot enter, and free boxes behind fronts, in which things can be."""

from collections.abc import Sequence

import numpy as np

from home_mjx.geometry.boxes import BoxSet, bounding_box, concat_boxes
from home_mjx.geometry.meshes import transform
from home_mjx.geometry.rotations import yaw_quat
from home_mjx.scene_compile.objects.compartments import Pocket
from home_mjx.scene_compile.objects.doors import LeafPart, place_boxes
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import Compartments


def find_compartments(objects: Sequence[PlacedObject]) -> Compartments:
    """Return the compartments behind all fronts that open, with shut drawers; of a drawer that is the free box in it.

    Leaves are numbered in the order of the objects, as rows of the table of doors.
    """
    leaf, boxes, count = [], [], 0
    for item in objects:
        for number, part in enumerate(item.leaf_parts if item.leaves else ()):
            for pocket in item.pockets:
                if np.array_equal(pocket.front, _front_box(part)):
                    leaf.append(count + number)
                    boxes.append(place_boxes(_free_box(part, pocket)[None], item.pose, item.yaw))
        count += len(item.leaves)
    if not boxes:
        return Compartments.empty()
    free = concat_boxes(boxes)
    return Compartments(np.array(leaf, np.int32), free.center, yaw_quat(free.yaw), free.half)


def find_insides(objects: Sequence[PlacedObject]) -> list[BoxSet]:
    """Return shut fronts of furniture and the compartments behind them, in which agents cannot stand."""
    fronts = [leaf.box_at(leaf.closed) for o in objects for leaf in o.leaves if leaf.is_front]
    corners = [transform(o.pose, pocket.box) for o in objects for pocket in o.pockets]
    yaws = [o.yaw for o in objects for _ in o.pockets]
    return fronts + [bounding_box(points, yaw) for points, yaw in zip(corners, yaws, strict=True)]


def _front_box(part: LeafPart) -> np.ndarray:
    """Return minimum and maximum of a front without its tray, as `Pocket.front` has them."""
    return (part.board or part.model).box.astype(np.float64)


def _free_box(part: LeafPart, pocket: Pocket) -> np.ndarray:
    """Return minimum and maximum of a compartment, or of what the boards of its tray leave of it [m]."""
    if part.tray is None:
        return pocket.box
    bottom, left, right, back = part.tray
    across, end = 1 - pocket.axis, (pocket.side + 1) // 2
    free = np.stack([bottom[0], bottom[1]])
    free[0, 2], free[1, 2] = bottom[1, 2], left[1, 2]
    free[0, across], free[1, across] = left[1, across], right[0, across]
    free[1 - end, pocket.axis] = back[end, pocket.axis]
    return free
