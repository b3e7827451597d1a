"""Objects at arbitrary angles."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.placed import PlacedFurniture, Slanted


@dataclass(frozen=True)
class Turned(Slanted):
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


def turned(item: PlacedFurniture, x: float, y: float, z: float, angle: float) -> Turned:
    """Return an object at a place [m] whose front points to (sin angle, cos angle) in (x, z)."""
    at = (round(x, 4), round(y, 4), round(z, 4))
    made = object.__new__(Turned)  # the constructor takes several times as long: see `PlacedFurniture.at`
    own = made.__dict__
    own.update((name, getattr(item, name)) for name in ("model", "scale", "mirrored", "closed", "materials"))
    own["position"], own["quarter"], own["angle"] = at, 0, round(angle, 4)
    return made


def askew(item: PlacedFurniture, angle: float) -> PlacedFurniture:
    """Return the same object, turned by a further angle at its place [rad]."""
    if isinstance(item, Turned):
        return replace(item, angle=round(item.angle + angle, 4))
    return turned(item, *item.position, item.quarter * np.pi / 2 + angle)
