"""Where an agent is and which way it looks."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.scene_compile.pytree import Pytree


class AgentPose(Pytree):
    """Pose of every agent: capsule centre [m], yaw [rad] about +z from +x, pitch [rad], up is positive."""

    pos: Float[Array, "a 3"]
    yaw: Float[Array, " a"]
    pitch: Float[Array, " a"]


def body_quat(yaw: Float[Array, ""]) -> Float[Array, "4"]:
    """Quaternion wxyz of a rotation by `yaw` about +z."""
    half = yaw / 2
    zero = jnp.zeros_like(half)
    return jnp.stack([jnp.cos(half), zero, zero, jnp.sin(half)])


def camera_quat(yaw: Float[Array, ""], pitch: Float[Array, ""]) -> Float[Array, "4"]:
    """Quaternion wxyz of MuJoCo's camera frame (looks along -z, +y up) for an agent that looks along +x at yaw 0.

    The product of the yaw about +z, the pitch about -y (up is positive) and the fixed turn that maps -z to +x and +y
    to +z, which is (1, 1, -1, -1) / 2.
    """
    cy, sy = jnp.cos(yaw / 2), jnp.sin(yaw / 2)
    cp, sp = jnp.cos(pitch / 2), jnp.sin(pitch / 2)
    turn = jnp.stack([cy * cp, sy * sp, -cy * sp, sy * cp])  # yaw * pitch
    base = jnp.array([0.5, 0.5, -0.5, -0.5], jnp.float32)
    return _multiply(turn, base)


def _multiply(a: Float[Array, "4"], b: Float[Array, "4"]) -> Float[Array, "4"]:
    w = a[0] * b[0] - jnp.dot(a[1:], b[1:])
    xyz = a[0] * b[1:] + b[0] * a[1:] + jnp.cross(a[1:], b[1:])
    return jnp.concatenate([w[None], xyz])
