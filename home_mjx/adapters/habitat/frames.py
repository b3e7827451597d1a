"""Frames: Habitat's worlds are Y up and agents look along -z at rotation 0; ours are Z up with yaw 0 along +x."""

import math
from collections.abc import Iterable

from home_mjx.errors import ConfigError

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # x, y, z, w, as in Habitat's files

NO_OFFSET = (0.0, 0.0, 0.0)
MAX_NORM_ERROR = 1e-3  # maximum difference of a squared norm of a rotation from 1


def to_world(position: Iterable[float], offset: Iterable[float] = NO_OFFSET) -> Vector:
    """Return a position of Habitat [m] in the world frame; `offset` [m] is added afterwards.

    Example:
        >>> to_world((1.0, 0.5, -2.0))
        (1.0, 2.0, 0.5)
    """
    x, y, z = position
    return _shift((x, -z, y), offset)


def from_world(position: Iterable[float], offset: Iterable[float] = NO_OFFSET) -> Vector:
    """Return a position of the world frame [m] in Habitat's: the inverse of `to_world`, exact without an offset.

    Example:
        >>> from_world((1.0, 2.0, 0.5))
        (1.0, 0.5, -2.0)
    """
    x, y, z = _shift(position, tuple(-value for value in offset))
    return (x, z, -y)


def _shift(position: Iterable[float], offset: Iterable[float]) -> Vector:
    """Return a position plus an offset; unchanged, signs of zeros included, where the offset is 0."""
    x, y, z = (float(value + step) if step else float(value) for value, step in zip(position, offset, strict=True))
    return (x, y, z)


def yaw_of(rotation: Iterable[float]) -> float:
    """Return the yaw [rad], -pi to pi, of a rotation x, y, z, w of Habitat; tilts are left out.

    Raises:
        ConfigError: The rotation has no norm of 1.

    Example:
        >>> round(yaw_of((0.0, 0.0, 0.0, 1.0)), 4)  # looks along Habitat's -z, which is our +y
        1.5708
    """
    x, y, z, w = rotation
    if not abs(x * x + y * y + z * z + w * w - 1) <= MAX_NORM_ERROR:
        raise ConfigError(f"expected a rotation x, y, z, w of norm 1, got {list(rotation)}")
    return math.atan2(1 - 2 * (x * x + y * y), -2 * (x * z + w * y))


def rotation_of(yaw: float) -> Quaternion:
    """Return the rotation x, y, z, w of Habitat of a yaw [rad].

    Example:
        >>> rotation_of(math.pi / 2)
        (0.0, 0.0, 0.0, 1.0)
    """
    half = (yaw - math.pi / 2) / 2
    return (0.0, math.sin(half), 0.0, math.cos(half))
