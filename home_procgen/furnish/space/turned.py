"""Objects at arbitrary angles."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed import PlacedModel, RotatedObject


@dataclass(frozen=True)
class YawedObject(RotatedObject):
    """An object turned by an arbitrary angle, in addition to its quarter turns.

    Attributes:
        angle: Angle about the vertical axis, from z towards x [rad].
    """

    angle: float = 0.0

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Linear part of the transform: rotation times scale and mirror."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]) @ self._shape[0]


def yaw_to(item: PlacedModel, x: float, y: float, z: float, angle: float) -> YawedObject:
    """Return an object at a place [m] whose front points to (sin angle, cos angle) in (x, z)."""
    at = (round(x, 4), round(y, 4), round(z, 4))
    made = object.__new__(YawedObject)  # the constructor takes several times as long: see `PlacedModel.moved_to`
    own = made.__dict__
    own.update((name, getattr(item, name)) for name in ("model", "scale", "mirrored", "closed", "materials"))
    own["position"], own["quarter"], own["angle"] = at, 0, round(angle, 4)
    return made


def yaw_by(item: PlacedModel, angle: float) -> PlacedModel:
    """Return the same object, turned by a further angle at its place [rad]."""
    if isinstance(item, YawedObject):
        return replace(item, angle=round(item.angle + angle, 4))
    return yaw_to(item, *item.position, item.quarter * np.pi / 2 + angle)
