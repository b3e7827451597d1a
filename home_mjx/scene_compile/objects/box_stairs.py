"""Detection of stairs built from Box nodes: adjoining boxes whose tops rise step by step."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float
from scipy.sparse.csgraph import connected_components

from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.house import BoxNode

STEP_RISE_RANGE = (0.05, 0.42)  # [m], minimum and maximum rise of a step
MAX_STEP_GAP = 0.06  # [m], maximum gap between adjoining steps in the plan
STEP_EDGE_RANGE = (0.1, 5.0)  # [m], minimum and maximum edge of a step; other boxes are rails, platforms and floors
MIN_STEPS = 4  # minimum number of steps
MAX_TOP_ABOVE_FLOOR = 0.3  # [m], maximum height of the last step above the upper floor


def find_box_stairs(
    objects: Sequence[PlacedObject], level: int, floor: Float[np.ndarray, " l"]
) -> list[list[PlacedObject]]:
    """Return groups of adjoining boxes on a level that may be stairs to the next one, each sorted by height.

    A group has at least `MIN_STEPS` boxes and begins at most one step above the floor. Tops are up to
    `MAX_TOP_ABOVE_FLOOR` above the next floor. These are candidates only; the detection of treads decides whether they
    are stairs.

    Args:
        objects: Objects of the house.
        level: Index of the lower level.
        floor: Heights of its floor and of those above [m].
    """
    low, high = floor[0] + STEP_RISE_RANGE[0], floor[1] + MAX_TOP_ABOVE_FLOOR
    boxes = [item for item in objects if isinstance(item.node, BoxNode) and item.level == level]
    boxes = [item for item in boxes if low <= _top(item) <= high and _is_step(item)]
    boxes.sort(key=lambda item: (_top(item), item.object_id))
    if len(boxes) < MIN_STEPS:
        return []
    count, group = connected_components(_adjoin(boxes), directed=False)
    flights = [[boxes[i] for i in np.flatnonzero(group == g)] for g in range(count)]
    return [
        flight for flight in flights if len(flight) >= MIN_STEPS and _top(flight[0]) <= floor[0] + STEP_RISE_RANGE[1]
    ]


def _top(item: PlacedObject) -> float:
    """Return the height of an object's highest corner [m]."""
    return float(item.triangles[..., 2].max())


def _is_step(item: PlacedObject) -> bool:
    """Return whether both edges of a box in the plan are within `STEP_EDGE_RANGE`."""
    edges = 2 * item.box.half[0, :2]
    return bool(edges.min() >= STEP_EDGE_RANGE[0] and edges.max() <= STEP_EDGE_RANGE[1])


def _adjoin(boxes: Sequence[PlacedObject]) -> Bool[np.ndarray, "n n"]:
    """Return a symmetric matrix: whether two boxes adjoin in the plan and their tops differ by the rise of one step.

    Gaps are between their bounding boxes at the yaw of the first box.
    """
    turn = yaw_matrix(boxes[0].yaw)
    corners = [item.triangles.reshape(-1, 3) @ turn for item in boxes]
    low, high = np.array([c.min(axis=0) for c in corners]), np.array([c.max(axis=0) for c in corners])
    gap = np.maximum(low[:, None, :2] - high[None, :, :2], low[None, :, :2] - high[:, None, :2]).max(axis=-1)
    rise = abs(high[:, None, 2] - high[None, :, 2])
    return (gap <= MAX_STEP_GAP) & (rise >= STEP_RISE_RANGE[0]) & (rise <= STEP_RISE_RANGE[1])
