"""Derivatives of t, u and v of a hit with respect to the ray and the pose of the hit triangle."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.scene.types import Rays, Scene

Coordinates = tuple[Float[Array, " n"], Float[Array, " n"], Float[Array, " n"]]


def attach_gradient(
    scene: Scene,
    rays: Rays,
    instance: Int[Array, " n"],
    triangle: Int[Array, " n"],
    t: Float[Array, " n"],
    u: Float[Array, " n"],
    v: Float[Array, " n"],
) -> Coordinates:
    """Return t, u and v unchanged, but differentiable by the rays, flattened to n, and by `scene.moving.pose`.

    Which triangle is hit counts as constant; derivatives of misses are 0.
    """
    pose = _pose(scene, instance)
    corners = scene.geometry.triangle[jnp.maximum(triangle, 0)]
    origin, direction = rays.origin.reshape(-1, 3), rays.direction.reshape(-1, 3)
    return _attach(pose, origin, direction, corners, triangle >= 0, (t, u, v))


def _pose(scene: Scene, instance: Int[Array, " n"]) -> Float[Array, "n 3 4"]:
    """Return the world-from-model matrix of each hit instance; on a miss (-1), that of instance 0."""
    poses = scene.geometry.instance_pose[scene.house]
    size = poses.shape[0] + scene.moving.instance.shape[0]
    place = jnp.where(scene.moving.instance < 0, size, scene.moving.instance)
    table = jnp.zeros((size, 3, 4), jnp.float32).at[: poses.shape[0]].set(poses)
    return table.at[place].set(scene.moving.pose, mode="drop")[jnp.maximum(instance, 0)]


@jax.custom_jvp
def _attach(pose: Array, origin: Array, direction: Array, corners: Array, valid: Array, at: Coordinates) -> Coordinates:
    """Return `at`; the other arguments are those by which `_attach_jvp` differentiates it."""
    del pose, origin, direction, corners, valid
    return at


@_attach.defjvp
def _attach_jvp(primals: tuple, tangents: tuple) -> tuple[Coordinates, Coordinates]:
    """Differentiate origin + t direction = corner_0 + u edge_1 + v edge_2, which hits satisfy; 0 for misses."""
    pose, _, direction, corners, valid, _ = primals
    d_pose, d_origin, d_direction, d_corners, _, _ = tangents
    t, u, v = _attach(*primals)
    world = _linear(pose, corners) + pose[:, None, :, 3]
    d_world = _linear(pose, d_corners) + _linear(d_pose, corners) + d_pose[:, None, :, 3]
    edge_1, edge_2 = world[:, 1] - world[:, 0], world[:, 2] - world[:, 0]
    weight = jnp.stack([1 - u - v, u, v], axis=1)
    shift = jnp.sum(weight[:, :, None] * d_world, axis=1) - d_origin - jnp.where(valid, t, 0)[:, None] * d_direction
    normal = jnp.cross(edge_1, edge_2)
    d_t = _dot(shift, normal) / jnp.where(valid, _dot(direction, normal), 1)
    slide = d_t[:, None] * direction - shift
    area = jnp.where(valid, _dot(normal, normal), 1)
    d_u = _dot(jnp.cross(slide, edge_2), normal) / area
    d_v = _dot(jnp.cross(edge_1, slide), normal) / area
    return (t, u, v), (jnp.where(valid, d_t, 0), jnp.where(valid, d_u, 0), jnp.where(valid, d_v, 0))


def _linear(pose: Float[Array, "n 3 4"], corners: Float[Array, "n 3 3"]) -> Float[Array, "n 3 3"]:
    """Apply the linear part of poses to each of the three corners."""
    return jnp.einsum("nij,nkj->nki", pose[:, :, :3], corners, precision="highest")


def _dot(a: Float[Array, "n 3"], b: Float[Array, "n 3"]) -> Float[Array, " n"]:
    """Return scalar products row by row."""
    return jnp.sum(a * b, axis=1)
