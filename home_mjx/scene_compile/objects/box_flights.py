"""Stairs that an author has piled up from Box nodes: boxes that adjoin and whose tops rise step by step."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.house import Box

STEP = (0.05, 0.42)  # [m] from a step's top to the next one's
ADJOIN = 0.06  # [m] between two steps in the plan
EDGE = (0.1, 5.0)  # [m], of a step: others are rails, platforms and floors
LEAST = 4  # steps
ABOVE = 0.3  # [m], of the last step above the upper floor


def box_flights(
    objects: Sequence[PlacedObject], level: int, floor: Float[np.ndarray, " l"]
) -> list[list[PlacedObject]]:
    """Boxes of a level that may be stairs to the next one, the lowest first; whether they are, their treads will tell.

    Args:
        objects: Of the house.
        level: Index of the level on which they stand.
        floor: Heights of its floor and of those above [m].
    """
    low, high = floor[0] + STEP[0], floor[1] + ABOVE
    boxes = [item for item in objects if isinstance(item.node, Box) and item.level == level]
    boxes = [item for item in boxes if low <= _top(item) <= high and _is_step(item)]
    boxes.sort(key=lambda item: (_top(item), item.object_id))
    if len(boxes) < LEAST:
        return []
    count, group = connected_components(_follow(boxes), directed=False)
    flights = [[boxes[i] for i in np.flatnonzero(group == g)] for g in range(count)]
    return [flight for flight in flights if len(flight) >= LEAST and _top(flight[0]) <= floor[0] + STEP[1]]


def _top(item: PlacedObject) -> float:
    return float(item.triangles[..., 2].max())


def _is_step(item: PlacedObject) -> bool:
    edges = 2 * item.box.half[0, :2]
    return bool(edges.min() >= EDGE[0] and edges.max() <= EDGE[1])


def _follow(boxes: Sequence[PlacedObject]) -> Bool[np.ndarray, "n n"]:
    """Which boxes adjoin in the plan, one of them a step above the other."""
    turn = yaw_matrix(boxes[0].yaw)
    corners = [item.triangles.reshape(-1, 3) @ turn for item in boxes]
    low, high = np.array([c.min(axis=0) for c in corners]), np.array([c.max(axis=0) for c in corners])
    gap = np.maximum(low[:, None, :2] - high[None, :, :2], low[None, :, :2] - high[:, None, :2]).max(axis=-1)
    rise = abs(high[:, None, 2] - high[None, :, 2])
    return (gap <= ADJOIN) & (rise >= STEP[0]) & (rise <= STEP[1])
