"""Where an agent can get in a house, by brute force over its collision boxes on a fine grid."""

import numpy as np
from scipy import ndimage

from home_mjx.schema.compiled import Colliders, CompiledHouse

CELL = 0.04  # [m]
AROUND = 3.0  # [m], of the grid beyond the rooms
RADIUS = 0.07  # [m]: an agent of 0.1 m, 3 cm deep in what it is pushed against
LOW, HIGH = 0.5, 1.5  # [m] above the floor: a box between them is in the way of every agent that is 1.6 m tall


def gap_to(boxes: Colliders, points: np.ndarray) -> np.ndarray:
    """Distance in the plan from each point to the nearest box; 0 inside."""
    gap = np.full(points.shape[:-1], np.inf)
    for pos, (w, _, _, z), size in zip(boxes.pos, boxes.quat, boxes.size, strict=True):
        along = np.array([w * w - z * z, 2 * w * z])
        away = points - pos[:2]
        u, v = away @ along, away @ np.array([-along[1], along[0]])
        gap = np.minimum(gap, np.hypot(np.maximum(abs(u) - size[0], 0), np.maximum(abs(v) - size[1], 0)))
    return gap


def rows(boxes: Colliders, kept: np.ndarray) -> Colliders:
    return Colliders(boxes.pos[kept], boxes.quat[kept], boxes.size[kept], boxes.object_id[kept])


def outside_rooms(polygons, points: np.ndarray) -> np.ndarray:
    """Distance from points to the nearest room [m]; 0 inside. By winding numbers and distances to edges."""
    away = np.full(len(points), np.inf)
    for polygon in polygons:
        start, way = polygon, np.roll(polygon, -1, axis=0) - polygon
        arm = points[:, None] - start
        along = np.clip((arm * way).sum(axis=-1) / np.maximum((way**2).sum(axis=-1), 1e-12), 0, 1)
        edge = np.linalg.norm(arm - along[..., None] * way, axis=-1).min(axis=1)
        ahead = arm - way
        turn = np.arctan2(arm[..., 0] * ahead[..., 1] - arm[..., 1] * ahead[..., 0], (arm * ahead).sum(axis=-1)).sum(
            axis=1
        )
        away = np.minimum(away, np.where(abs(turn) > np.pi, 0, edge))
    return away


def reached(boxes: Colliders, floor: float, polygons, starts: np.ndarray) -> np.ndarray:
    """Points that an agent can get to from any of some starts, between boxes that stay where they are."""
    top, bottom = boxes.pos[:, 2] + boxes.size[:, 2], boxes.pos[:, 2] - boxes.size[:, 2]
    met = rows(boxes, (top > floor + LOW) & (bottom < floor + HIGH))
    corners = np.concatenate(polygons)
    low, high = corners.min(axis=0) - AROUND, corners.max(axis=0) + AROUND
    x, y = (np.arange(a, b, CELL) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1)
    labels, _ = ndimage.label(gap_to(met, points) > RADIUS, np.ones((3, 3)))
    column, row = np.round((starts - low) / CELL).astype(int).T
    parts = np.unique(labels[row, column])
    return points[np.isin(labels, parts[parts > 0])]


def farthest_from_rooms(house: CompiledHouse, boxes: Colliders) -> float:
    """How far from all rooms of the ground floor an agent can get that starts anywhere it can stand [m]."""
    n, ground = house.navigation, np.flatnonzero(house.rooms.level == house.navigation.level[0])
    row, column = np.nonzero(n.region[0] >= 0)
    starts = n.origin + (np.stack([column, row], axis=-1) + 0.5) * n.cell
    polygons = [house.rooms.polygon[r] for r in ground]
    points = reached(boxes, float(n.floor[0]), polygons, starts)
    assert len(points) > 0.5 * len(starts) * (n.cell / CELL) ** 2
    return float(outside_rooms(polygons, points).max())
