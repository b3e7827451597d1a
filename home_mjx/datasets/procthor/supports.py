"""Surfaces of our furniture under the things of a house, and walls beside them."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.procthor.placed import PlacedPiece
from home_mjx.geometry.wall_prisms import WALL_DEPTH

STEPS = (0.07, 0.35)  # [m], from the height in the file to our surface, tried in this order
# Fine categories in which things are, rather than on them: those far from all surfaces stay where they are.
CLOSED = ("dishwasher", "kitchen_cabinet", "microwave", "range_oven", "refrigerator", "safe", "wardrobe_cabinet")
LEVEL_HEIGHT = 0.05  # [m], height within which surfaces under one thing count as one
GAP = 0.001  # [m], between a thing and what carries it
BASE_POINTS = np.array([[0, 0, 0], [-1, 0, -1], [-1, 0, 1], [1, 0, -1], [1, 0, 1]])
BASE_SHARE = 0.6  # of the footprint of a thing, that has to be carried
SHARES_INWARDS = (0.0, 0.25, 0.5, 0.75, 1.0)  # shares of the way to the middle of what carries it
MIN_UP = 0.5  # minimum vertical component of the normal of a surface that carries
WALL_GAP = WALL_DEPTH / 2 + 0.004  # [m], from the middle line of a wall to what stands at it
MAX_PUSH = 0.3  # [m], depth in a wall beyond which a thing is not of this room


def find_support(item: PlacedPiece, carrier: PlacedPiece) -> PlacedPiece:
    """Return a thing on the surface of its carrier that is nearest to its height in the file.

    If there is none at about this height, the thing moves towards the middle of the carrier; if that does not help, a
    surface farther up or down counts.
    """
    triangles = _upward_triangles(carrier)
    base = BASE_POINTS * BASE_SHARE * np.array(item.size) / 2 @ item.turn.T
    inwards = (carrier.position - item.position) * (1, 0, 1)
    for step in (*STEPS, *((np.inf,) if carrier.fine not in CLOSED else ())):
        for share in SHARES_INWARDS:
            found = _top_below(triangles, item.position + share * inwards, base, step)
            if found is not None:
                return replace(item, position=found)
    return item


def _top_below(
    triangles: Float[np.ndarray, "t 3 3"], place: Float[np.ndarray, " 3"], base: Float[np.ndarray, "5 3"], step: float
) -> Float[np.ndarray, " 3"] | None:
    """Return a place on the surface within `step` [m] of its height that is nearest to it; None if there is none."""
    heights = [_heights(triangles, point[[0, 2]]) for point in base + place]
    near = heights[0][abs(heights[0] - place[1]) <= step]
    if not len(near):
        return None
    best = near[abs(near - place[1]).argmin()]
    level = np.concatenate(heights)
    top = level[abs(level - best) <= LEVEL_HEIGHT].max()
    return np.array([place[0], top + GAP, place[2]])


def _upward_triangles(item: PlacedPiece) -> Float[np.ndarray, "t 3 3"]:
    """Return the triangles of a thing in the house that face up [m]."""
    mesh = item.piece.mesh
    corners = (mesh.vertices @ item.linear.T + item.position)[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners[normal[:, 1] > MIN_UP * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)]


def _heights(triangles: Float[np.ndarray, "t 3 3"], point: Float[np.ndarray, " 2"]) -> Float[np.ndarray, " n"]:
    """Return the heights of the triangles above or below a point (x, z) [m]."""
    plan = triangles[..., [0, 2]] - point
    after = np.roll(plan, -1, axis=1)
    areas = plan[..., 0] * after[..., 1] - plan[..., 1] * after[..., 0]  # twice that of the triangle with each side
    inside = (areas <= 0).all(axis=1) | (areas >= 0).all(axis=1)
    total = areas[inside].sum(axis=1)
    weights = np.roll(areas[inside], -1, axis=1)[total != 0] / total[total != 0, None]
    return (weights * triangles[inside][total != 0][..., 1]).sum(axis=1)


def push_from_walls(corners: Float[np.ndarray, "4 2"], polygon: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " 2"]:
    """Return the shift (x, z) [m] by which a footprint leaves the walls along the sides of a room.

    Example:
        >>> room = np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]])
        >>> push_from_walls(np.array([[0.0, 1], [1, 1], [1, 2], [0, 2]]), room).round(3).tolist()
        [0.054, 0.0]
    """
    shift = np.zeros(2)
    sign = np.sign(np.sum(polygon[:, 0] * np.roll(polygon[:, 1], -1) - np.roll(polygon[:, 0], -1) * polygon[:, 1]))
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = float(np.hypot(*(end - start)))
        if length == 0:
            continue
        way = (end - start) / length
        inwards = sign * np.array([-way[1], way[0]])
        along, depth = (corners - start) @ way, (corners - start) @ inwards
        beside = along.min() < length - WALL_DEPTH and along.max() > WALL_DEPTH
        if beside and -MAX_PUSH < depth.min() < WALL_GAP and depth.mean() > 0:
            shift += (WALL_GAP - depth.min()) * inwards
    return shift
