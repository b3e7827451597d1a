"""Rays and probes against the collision boxes of a house, by brute force: shares nothing with the compiler."""

import numpy as np
from scipy.spatial.transform import Rotation

from home_mjx.schema.compiled import CompiledHouse


class Solids:
    """All static boxes of a house, and the plane of its ground floor."""

    def __init__(self, house: CompiledHouse) -> None:
        boxes = house.colliders
        self.turn = Rotation.from_quat(boxes.quat, scalar_first=True).as_matrix()
        self.pos, self.size = boxes.pos, boxes.size
        self.plane = float(house.rooms.floor[house.rooms.level == house.rooms.level.min()].min())
        self.reach = np.linalg.norm(boxes.size, axis=1)

    def below(self, points: np.ndarray) -> np.ndarray:
        """Height of what a ray straight down from each point meets first; a ray that starts in a box meets nothing."""
        found = np.full(len(points), self.plane)
        for pos, size, turn, reach in zip(self.pos, self.size, self.turn, self.reach, strict=True):
            near = np.flatnonzero(((points[:, :2] - pos[:2]) ** 2).sum(axis=1) <= reach**2)
            start, way = (points[near] - pos) @ turn, -turn[2]
            with np.errstate(divide="ignore", invalid="ignore"):
                t = np.stack([(-size - start) / way, (size - start) / way])
            inside = abs(start) <= size
            enter = np.where(way == 0, np.where(inside, -np.inf, np.inf), t.min(axis=0)).max(axis=1)
            leave = np.where(way == 0, np.inf, t.max(axis=0)).min(axis=1)
            hit = (enter >= 0) & (enter <= leave)
            top = np.where(hit, points[near, 2] - enter, -np.inf)
            found[near] = np.maximum(found[near], top)
        return found

    def blocked(self, points: np.ndarray, low: float, high: float, radius: float) -> np.ndarray:
        """Whether a post around each point, from `low` to `high` above it, meets a box."""
        found = np.zeros(len(points), bool)
        for z in np.arange(low, high, 0.3):
            at = points + np.array([0, 0, z])
            for pos, size, turn, reach in zip(self.pos, self.size, self.turn, self.reach, strict=True):
                near = np.flatnonzero(~found & (((at - pos) ** 2).sum(axis=1) <= (reach + radius) ** 2))
                local = abs((at[near] - pos) @ turn)
                found[near] |= np.linalg.norm(np.maximum(local - size, 0), axis=1) < radius
        return found
