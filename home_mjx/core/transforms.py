"""Affine maps as 3x4 matrices (linear part and translation), quaternions (w, x, y, z) and angles."""

from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float


def sum3(parts: Float[Array, "*n 3"]) -> Float[Array, "*n"]:
    """Sum over the last axis as written-out additions.

    On CPUs XLA lowers short reductions to library calls, which are ten times as slow.

    Example:
        >>> sum3(jnp.array([[1.0, 2.0, 4.0]])).tolist()
        [7.0]
    """
    return parts[..., 0] + parts[..., 1] + parts[..., 2]


def length3(vector: Float[Array, "*n 3"]) -> Float[Array, "*n"]:
    """Compute Euclidean lengths over the last axis with `sum3`."""
    return jnp.sqrt(sum3(vector * vector))


def wrap_angle(angle: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Wrap an angle [rad] to [-pi, pi); pi itself becomes -pi."""
    return (angle + jnp.pi) % (2 * jnp.pi) - jnp.pi


def yaw_quat(yaw: Float[Array, ""]) -> Float[Array, "4"]:
    """Return the quaternion wxyz of a rotation by `yaw` [rad] about +z."""
    half = yaw / 2
    zero = jnp.zeros_like(half)
    return jnp.stack([jnp.cos(half), zero, zero, jnp.sin(half)])


def camera_quat(yaw: Float[Array, ""], pitch: Float[Array, ""]) -> Float[Array, "4"]:
    """Return the quaternion wxyz of MuJoCo's camera frame (-z forward, +y up) for an agent that faces +x at yaw 0.

    It is the product of the yaw about +z, the pitch about -y (positive is up) and a constant rotation. The latter maps
    -z to +x and +y to +z; it is (1, 1, -1, -1) / 2. Angles in [rad].
    """
    cy, sy = jnp.cos(yaw / 2), jnp.sin(yaw / 2)
    cp, sp = jnp.cos(pitch / 2), jnp.sin(pitch / 2)
    turn = jnp.stack([cy * cp, sy * sp, -cy * sp, sy * cp])  # yaw * pitch
    base = jnp.array([0.5, 0.5, -0.5, -0.5], jnp.float32)
    return quat_multiply(turn, base)


def quat_multiply(a: Float[Array, "4"], b: Float[Array, "4"]) -> Float[Array, "4"]:
    """Multiply two quaternions wxyz: the result rotates by `b`, then by `a`."""
    w = a[0] * b[0] - jnp.dot(a[1:], b[1:])
    xyz = a[0] * b[1:] + b[0] * a[1:] + jnp.cross(a[1:], b[1:])
    return jnp.concatenate([w[None], xyz])


UNIT_QUAT_TOLERANCE = 1e-2  # tolerance of a unit quaternion's squared norm


def is_unit_quat(quat: Float[Array, "*n 4"]) -> Bool[Array, "*n"]:
    """Return whether quaternions have unit length within `UNIT_QUAT_TOLERANCE`; rotations by others would scale.

    Example:
        >>> is_unit_quat(jnp.array([[1.0, 0, 0, 0], [1.05, 0, 0, 0]])).tolist()
        [True, False]
    """
    return jnp.abs(jnp.sum(quat * quat, axis=-1) - 1) < UNIT_QUAT_TOLERANCE


def quat_matrix(quat: Float[Any, "4 *n"], xp: Any = jnp) -> Float[Any, "3 3 *n"]:
    """Return the rotation matrix, for column vectors, of a unit quaternion wxyz; it is not normalized here.

    `xp` is `numpy` or `jax.numpy`.

    Example:
        >>> quat_matrix(jnp.array([1.0, 0.0, 0.0, 0.0])).tolist()
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    w, x, y, z = quat
    return xp.stack(
        [
            xp.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]),
            xp.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]),
            xp.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]),
        ]
    )


def rigid_transform(pos: Float[Array, "3"], quat: Float[Array, "4"]) -> Float[Array, "3 4"]:
    """Return the affine map from a body frame to the world, from position [m] and unit quaternion wxyz."""
    return jnp.concatenate([quat_matrix(quat), pos[:, None]], axis=1)


def compose(outer: Float[Array, "3 4"], inner: Float[Array, "3 4"]) -> Float[Array, "3 4"]:
    """Compose two affine maps: the result applies `inner`, then `outer`."""
    linear = jnp.matmul(outer[:, :3], inner, precision="highest")
    return linear.at[:, 3].add(outer[:, 3])


def invert(pose: Float[Array, "3 4"]) -> Float[Array, "3 4"]:
    """Invert an affine map by cofactors; its linear part may scale, mirror and shear, but must not be singular."""
    a, b, c = pose[:, 0], pose[:, 1], pose[:, 2]
    rows = jnp.stack([jnp.cross(b, c), jnp.cross(c, a), jnp.cross(a, b)])
    linear = rows / jnp.sum(a * rows[0])
    offset = -jnp.matmul(linear, pose[:, 3], precision="highest")
    return jnp.concatenate([linear, offset[:, None]], axis=1)


def transform_bounds(pose: Float[Array, "3 4"], box: Float[Array, "2 3"]) -> Float[Array, "2 3"]:
    """Return world bounds (rows min, max) of `box`, axis-aligned bounds (min, max) in the local frame of `pose`.

    Source: J. Arvo, "Transforming axis-aligned bounding boxes", Graphics Gems, 1990.
    """
    center, half = (box[0] + box[1]) / 2, (box[1] - box[0]) / 2
    middle = jnp.matmul(pose[:, :3], center, precision="highest") + pose[:, 3]
    extent = jnp.matmul(jnp.abs(pose[:, :3]), half, precision="highest")
    return jnp.stack([middle - extent, middle + extent])
