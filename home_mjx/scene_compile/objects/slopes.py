"""Slopes: inclined rectangles that replace the steps of a flight of stairs, or flat ones for landings."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.rotations import yaw_matrix


@dataclass(frozen=True)
class Slope:
    """A rectangle in the plan with a constant grade; flat for a landing.

    Attributes:
        foot: Middle of its lower edge [m].
        yaw: Direction uphill, or across a landing [rad].
        run: Length in the plan [m].
        width: Width [m].
        low: Height at its foot [m].
        high: Height at its head [m].
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
        """Inclination above the horizontal [rad]."""
        return float(np.arctan2(self.high - self.low, self.run))

    @property
    def grade(self) -> float:
        """Rise per length in the plan."""
        return (self.high - self.low) / self.run

    @cached_property
    def outline(self) -> Float[np.ndarray, "4 2"]:
        """Corners in the plan [m], counter-clockwise; edges: right side, head, left side, foot."""
        return self.part(0.0, self.run)

    def part(self, start: float, end: float) -> Float[np.ndarray, "4 2"]:
        """Return the plan corners of the part between two distances from the foot [m], in the order of `outline`."""
        half = self.width / 2
        corners = np.array([[start, -half], [end, -half], [end, half], [start, half]])
        return self.foot + corners @ yaw_matrix(self.yaw)[:2, :2].T

    def along(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Return the signed distance of points uphill from the foot [m]; negative before it."""
        return (points - self.foot) @ self.up

    def contains(self, points: Float[np.ndarray, "*p 2"]) -> Bool[np.ndarray, "*p"]:
        """Return whether plan points are in the slope's rectangle, edges included."""
        along, across = self.along(points), (points - self.foot) @ [-self.up[1], self.up[0]]
        return (along >= 0) & (along <= self.run) & (abs(across) <= self.width / 2)

    def surface(self, points: Float[np.ndarray, "*p 2"]) -> Float[np.ndarray, "*p"]:
        """Return the height of the slope's plane at plan points, also beside it [m]; constant beyond its ends."""
        return self.low + (self.high - self.low) * np.clip(self.along(points) / self.run, 0, 1)

    def rotated(self, yaw: float) -> "Slope":
        """Return a copy rotated by `yaw` [rad] about the vertical axis through the world's origin."""
        foot = yaw_matrix(yaw)[:2, :2] @ self.foot
        return Slope(foot, self.yaw + yaw, self.run, self.width, self.low, self.high)
