"""Optical flow: where each pixel's surface point was in an earlier image."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.cameras.projection import project
from home_mjx.raycast_render.images.view import View
from home_mjx.raycast_render.scene.surface import index_by_instance
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, take
from home_mjx.raycast_render.shaders.base import resolve_shader

FAR = 1e5  # [m], distance of the sky


def optical_flow(
    scene: Scene, camera: Camera, before: Scene, camera_before: Camera, lens: Lens, exclude: Int[Array, ""] | int = -1
) -> tuple[Float[Array, "h w 2"], Bool[Array, "h w"]]:
    """Return the motion of each pixel's surface point since an earlier instant, and whether it had a pixel then.

    Motion is right and down in pixels: the point's coordinates in this image minus those in the earlier one, whether or
    not it was visible there. Points of movable objects, doors and agents move with them; the sky is far away. The flow
    is 0 where the point was behind the camera.

    Args:
        scene: Scene now.
        camera: Camera now.
        before: Scene of the same house at the earlier instant.
        camera_before: Camera then.
        lens: Lens of both: pinhole, fisheye, orthographic or panorama.
        exclude: Object id hidden from the camera; -1 none.

    Raises:
        ConfigError: The lens cannot project points.

    Example:
        >>> flow, known = optical_flow(scene, camera, earlier, camera_before, Lens(64, 64))  # doctest: +SKIP
    """
    hit = View(scene, camera, lens, resolve_shader("fast"), exclude).center_rays.hit
    origin, direction = camera_rays(camera, lens)
    point = Vec.unpack(origin + direction * jnp.where(hit.instance < 0, FAR, hit.t)[..., None])
    poses = [
        index_by_instance(getattr(scene.geometry, name)[scene.house], one.moving, getattr(one.moving, field))
        for one, name, field in ((scene, "instance_inverse", "inverse"), (before, "instance_pose", "pose"))
    ]
    instance = jnp.maximum(hit.instance, 0)
    moved = _transform(poses[1], instance, _transform(poses[0], instance, point)).pack()
    moved = jnp.where((hit.instance < 0)[..., None], point.pack(), moved)
    (now, _), (then, known) = project(camera, lens, point.pack()), project(camera_before, lens, moved)
    return jnp.where(known[..., None], now - then, 0.0), known


def _transform(poses: Float[Array, "i 3 4"], instance: Int[Array, "*rays"], point: Vec) -> Vec:
    """Apply to each point the matrix of its instance."""
    rows = [[take(poses, instance, i, j) for j in range(4)] for i in range(3)]
    return Vec(*(a * point.x + b * point.y + c * point.z + d for a, b, c, d in rows))
