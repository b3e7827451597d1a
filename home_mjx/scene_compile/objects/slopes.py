"""Slopes: what stands for the steps of a flight of stairs, and flat for a landing."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.rotations import yaw_matrix


@dataclass(frozen=True)
class Slope:
    """A rectangle in the plan, that rises evenly along its length or is flat.

    Attributes:
        foot: Middle of its lower edge [m].
        yaw: Direction uphill, or of the way across a landing [rad].
        run: Length in the plan [m].
        width: [m].
        low: Height at its foot [m].
        high: At its head [m].
    """

    foot: Float[np.ndarray, "2"]
    yaw: float
    run: float
    width: float
    low: float
    high: float

    @property
    def up(self) -> Float[np.ndarray, "2"]:
        """Unit direction uphill in the plan."""
        return np.array([np.cos(self.yaw), np.sin(self.yaw)])

    @property
    def angle(self) -> float:
        """[rad], above the horizontal."""
        return float(np.arctan2(self.high - self.low, self.run))

    @property
    def grade(self) -> float:
        """Rise per length in the plan."""
        return (self.high - self.low) / self.run

    @cached_property
    def outline(self) -> Float[np.ndarray, "4 2"]:
        """In the plan [m], counter-clockwise: the edges are the right side, the head, the left side and the foot."""
        return self.part(0.0, self.run)

    def part(self, start: float, end: float) -> Float[np.ndarray, "4 2"]:
        """The part between two distances from the foot, in the plan [m]."""
        half = self.width / 2
        corners = np.array([[start, -half], [end, -half], [end, half], [start, half]])
        return self.foot + corners @ yaw_matrix(self.yaw)[:2, :2].T

    def along(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Distance from the foot along the way up [m]."""
        return (points - self.foot) @ self.up

    def contains(self, points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
        """Whether points are over the slope."""
        along, across = self.along(points), (points - self.foot) @ [-self.up[1], self.up[0]]
        return (along >= 0) & (along <= self.run) & (abs(across) <= self.width / 2)

    def surface(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Height under points; beyond its ends that of the end [m]."""
        return self.low + (self.high - self.low) * np.clip(self.along(points) / self.run, 0, 1)

    def turned(self, yaw: float) -> "Slope":
        """The slope in a frame that is turned about the vertical axis through the origin [rad]."""
        foot = yaw_matrix(yaw)[:2, :2] @ self.foot
        return Slope(foot, self.yaw + yaw, self.run, self.width, self.low, self.high)
