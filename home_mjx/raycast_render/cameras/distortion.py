"""Radial distortion of lenses: polynomials of the angle (fisheye) or of the distance from the axis (pinhole)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Array, Float

from home_mjx.core.checks import check_number, shorten
from home_mjx.errors import ConfigError

MAX_COEFFICIENTS = 4
NEWTON_STEPS = 8
CHECKED_RADII = np.linspace(0.0, 1.0, 101)  # where distortions must increase


def distort(radius: Float[Array, "*n"], coefficients: Sequence[float]) -> Float[Array, "*n"]:
    """Return radii x (1 + k1 x^2 + k2 x^4 + ...) in the image, for angles [rad] or distances at unit depth x."""
    return radius * _series(radius, coefficients, 0)


def undistort(radius: Float[Array, "*n"], coefficients: Sequence[float]) -> Float[Array, "*n"]:
    """Return the angles or distances x whose `distort` is `radius`, by Newton's method.

    Example:
        >>> import jax.numpy as jnp
        >>> round(float(undistort(distort(jnp.float32(0.8), (0.1, -0.02)), (0.1, -0.02))), 4)
        0.8
    """
    found = radius
    for _ in range(NEWTON_STEPS if coefficients else 0):
        found = found - (distort(found, coefficients) - radius) / _series(found, coefficients, 2)
    return found


def check_distortion(coefficients: Sequence[float], model: str) -> None:
    """Raise `ConfigError` unless these are at most four finite numbers, none but for a pinhole or fisheye.

    Radii must increase up to an angle of 1 rad or a distance of 1.
    """
    if not isinstance(coefficients, tuple) or len(coefficients) > MAX_COEFFICIENTS:
        raise ConfigError(f"`distortion` must be a tuple of at most four numbers, got {shorten(coefficients)}")
    for value in coefficients:
        check_number("coefficient of `distortion`", value)
    if coefficients and model not in ("pinhole", "fisheye"):
        raise ConfigError(f"a camera of model `{model}` has no distortion", hint="Use a pinhole or a fisheye.")
    if np.min(_series(CHECKED_RADII, coefficients, 2)) <= 0:
        raise ConfigError(f"`distortion` {coefficients} folds the image: radii must increase with angles")


def check_corners(coefficients: Sequence[float], fovy: float, aspect: float, is_fisheye: bool) -> None:
    """Raise `ConfigError` unless radii increase up to the corners of an image of width / height `aspect`.

    Args:
        coefficients: Those of the lens.
        fovy: Vertical field of view [rad].
        aspect: Width over height of the image.
        is_fisheye: Whether it is a fisheye, whose angles end at pi; else a pinhole.
    """
    edge = fovy / 2 if is_fisheye else np.tan(fovy / 2)
    radius = np.linspace(0.0, np.pi if is_fisheye else 4 * edge * np.hypot(1, aspect), 1000)
    corner = np.hypot(1, aspect) * edge * (_series(edge, coefficients, 0) if is_fisheye else 1.0)
    bent = radius * _series(radius, coefficients, 0)
    inside = radius <= np.append(radius[bent >= corner], radius[-1])[0]
    reached = is_fisheye or bent.max() >= corner
    if np.min(_series(radius, coefficients, 2)[inside]) <= 0 or not reached:
        hint = "Take a narrower field of view or smaller coefficients."
        raise ConfigError(f"`distortion` {coefficients} folds the corners of an image of {fovy:.3g} rad", hint=hint)


def _series(radius: Any, coefficients: Sequence[float], slope: int) -> Any:
    """Return 1 + k1 x^2 + k2 x^4 + ..., or with `slope` 2 the derivative of `distort`, 1 + 3 k1 x^2 + 5 k2 x^4 + ..."""
    square, total = radius * radius, 0.0
    for number in range(len(coefficients), 0, -1):
        total = (total + (1 + slope * number) * coefficients[number - 1]) * square
    return 1.0 + total + 0.0 * square
