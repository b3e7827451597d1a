"""Boxes of the objects in a room."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed_model import Box, PlacedModel
from home_procgen.furnish.space.overlap_kernels import overlap_kernels

Boxes = Float[np.ndarray, "_ 2 3"]  # any number of boxes

MAX_TOUCH_OVERLAP = 0.002  # [m], maximum overlap of boxes that count as touching
MAX_RUG_THICKNESS = 0.012  # [m], maximum thickness of rugs and mats
MAX_OPEN_PARTS = 110  # maximum number of parts of a model that are tested individually
# Families whose parts leave space for other objects in, under or between them.
OPEN_FAMILIES = {
    *("chair", "stool", "office_chair", "outdoor_seating", "bench", "sofa", "dining_table", "table", "game_table"),
    *("coffee_table", "side_table", "console", "desk", "dressing_table", "nightstand", "tv_stand", "shelving"),
    *("curtain", "kitchen_sink", "cooker", "basin", "cart", "floor_lamp", "parasol", "bunker_bed", "shower"),
    *("storage_bench", "plant", "shoes_cabinet", "fireplace", "hanger", "large_toy", "screen", "wall_lamp"),
    *("piano", "washer", "bookshelf", "wardrobe", "microwave", "speaker", "dresser", "double_bed", "single_bed"),
    *("kitchen_cabinet", "fish_tank", "refrigerator", "bathtub", "tool_box", "trash_can", "table_lamp", "vase"),
}


def collision_boxes(item: PlacedModel) -> Boxes:
    """Return the collision boxes of an object [m]: one per part for open families, else its bounding box."""
    if item.model.family in OPEN_FAMILIES and len(item.model.parts) <= MAX_OPEN_PARTS:
        return item.parts
    return item.box[None]


def is_flat(box: Box) -> bool:
    """Return whether the height of a box is below `MAX_RUG_THICKNESS`."""
    return float(box[1, 1]) - float(box[0, 1]) < MAX_RUG_THICKNESS


def boxes_overlap(boxes: Boxes, others: Boxes, tolerance: float = MAX_TOUCH_OVERLAP) -> bool:
    """Return whether any of the boxes overlaps any of the others by more than `tolerance` on every axis [m]."""
    return overlap_kernels().any_overlap(boxes, others, len(others), -np.inf, tolerance)


def are_disjoint(item: PlacedModel, other: PlacedModel) -> bool:
    """Return whether the bounding boxes of two objects are disjoint; touching ones are not."""
    (ax, ay, az), (bx, by, bz) = item.box.tolist()
    (cx, cy, cz), (dx, dy, dz) = other.box.tolist()
    return bx < cx or dx < ax or bz < cz or dz < az or by < cy or dy < ay


def extrude_footprint(box: Box) -> Box:
    """Return a box from height 0 to 1 m over the same floor area."""
    return np.array([[box[0, 0], 0.0, box[0, 2]], [box[1, 0], 1.0, box[1, 2]]])


class BoxStore:
    """Growing array of boxes."""

    def __init__(self, boxes: Sequence[Box] = ()) -> None:
        self._data, self._count = np.zeros((256, 2, 3)), 0
        self.add(np.array(boxes, float).reshape(-1, 2, 3))

    @property
    def boxes(self) -> Boxes:
        """View of all stored boxes, in the order of addition [m]."""
        return self._data[: self._count]

    def add(self, boxes: Boxes) -> None:
        """Append boxes (n, 2, 3) [m]; no effect if there are none."""
        end = self._count + len(boxes)
        if end > len(self._data):
            more = max(end, len(self._data))
            self._data = np.concatenate([self._data, np.zeros((more, 2, 3))])
        self._data[self._count : end] = boxes
        self._count = end

    def overlaps_any(self, boxes: Boxes, tolerance: float = MAX_TOUCH_OVERLAP) -> bool:
        """Return whether a given box overlaps a stored box by more than `tolerance` on every axis [m]."""
        return overlap_kernels().any_overlap(boxes, self._data, self._count, tolerance, tolerance)
