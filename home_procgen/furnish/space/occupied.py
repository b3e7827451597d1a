"""Boxes of what is in a room."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed import Box, PlacedFurniture
from home_procgen.furnish.space.touching import touching

Boxes = Float[np.ndarray, "_ 2 3"]  # any number, each time

TOLERANCE = 0.002  # [m]: boxes that enter each other by less only touch
FLAT = 0.012  # [m]: rugs and mats are thinner
MOST = 110  # parts of a model that are looked at one by one
# What other things may stand in, under or between the parts of.
OPEN = {
    *("chair", "stool", "office_chair", "outdoor_seating", "bench", "sofa", "dining_table", "table", "game_table"),
    *("coffee_table", "side_table", "console", "desk", "dressing_table", "nightstand", "tv_stand", "shelving"),
    *("curtain", "kitchen_sink", "cooker", "basin", "cart", "floor_lamp", "parasol", "bunker_bed", "shower"),
    *("storage_bench", "plant", "shoes_cabinet", "fireplace", "hanger", "large_toy", "screen", "wall_lamp"),
    *("piano", "washer", "bookshelf", "wardrobe", "microwave", "speaker", "dresser", "double_bed", "single_bed"),
    *("kitchen_cabinet", "fish_tank", "refrigerator", "bathtub", "tool_box", "trash_can", "table_lamp", "vase"),
}


def hull(item: PlacedFurniture) -> Boxes:
    """The boxes that stand for a thing: one for each part, where others may come between these."""
    if item.model.family in OPEN and len(item.model.parts) <= MOST:
        return item.parts
    return item.box[None]


def is_flat(box: Box) -> bool:
    """Whether a box is that of a rug."""
    return float(box[1, 1]) - float(box[0, 1]) < FLAT


def meet(boxes: Boxes, others: Boxes, tolerance: float = TOLERANCE) -> bool:
    """Whether one of some boxes enters one of others."""
    return touching().meet(boxes, others, len(others), -np.inf, tolerance)


def apart(item: PlacedFurniture, other: PlacedFurniture) -> bool:
    """Whether nothing of one thing can meet the other, by the boxes around them."""
    (ax, ay, az), (bx, by, bz) = item.box.tolist()
    (cx, cy, cz), (dx, dy, dz) = other.box.tolist()
    return bx < cx or dx < ax or bz < cz or dz < az or by < cy or dy < ay


def upright(box: Box) -> Box:
    """A box of one metre's height over the same floor."""
    return np.array([[box[0, 0], 0.0, box[0, 2]], [box[1, 0], 1.0, box[1, 2]]])


class Store:
    """Boxes that only become more."""

    def __init__(self, boxes: Sequence[Box] = ()) -> None:
        self._data, self._count = np.zeros((256, 2, 3)), 0
        self.add(np.array(boxes, float).reshape(-1, 2, 3))

    @property
    def boxes(self) -> Boxes:
        """All of them."""
        return self._data[: self._count]

    def add(self, boxes: Boxes) -> None:
        """More of them."""
        end = self._count + len(boxes)
        if end > len(self._data):
            more = max(end, len(self._data))
            self._data = np.concatenate([self._data, np.zeros((more, 2, 3))])
        self._data[self._count : end] = boxes
        self._count = end

    def meets(self, boxes: Boxes, tolerance: float = TOLERANCE) -> bool:
        """Whether one of some boxes enters one of these."""
        return touching().meet(boxes, self._data, self._count, tolerance, tolerance)
