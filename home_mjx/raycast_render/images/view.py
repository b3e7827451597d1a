"""View of one camera in one environment: its rays, and their colours by a shader."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from home_mjx.core.checks import shorten
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras import sampling
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays, is_valid_camera
from home_mjx.raycast_render.cameras.shutter import is_instant, moving_rays, vignette
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.lighting.texture import encode_srgb
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.base import CameraRays, Shader, check_shader_bakes
from home_mjx.schema.compiled import RayKind


@dataclass(frozen=True)
class View:
    """A camera in an environment, and the shader of its colour images."""

    scene: Scene
    camera: Camera
    lens: Lens
    shader: Shader
    exclude: Int[Array, ""] | int
    cut_height: Float[Array, ""] | float | None = None  # [m]; None: nothing is cut
    before: Camera | None = None  # pose at the last control step; None: the camera rests

    @cached_property
    def valid(self) -> Bool[Array, ""]:
        """Scalar flag: the cameras are valid (`is_valid_camera`), and the poses of all moving instances are finite."""
        own = is_valid_camera(self.camera, self.lens) & jnp.all(jnp.isfinite(self.scene.moving.pose))
        return own if self._moving is None else own & is_valid_camera(self._moving, self.lens)

    @property
    def _moving(self) -> Camera | None:
        """Earlier camera from which this one moves while a colour image is taken; None if that is instant."""
        if self.before is None or is_instant(self.lens):
            return None
        return self.before.replace(fovy=self.camera.fovy)

    @cached_property
    def center_rays(self) -> CameraRays:
        """Rays through the centre of every pixel with their first hits, cast once; all miss unless `valid`."""
        return self.cast(0)

    def cast(self, sample: Int[Array, ""] | int, before: Camera | None = None) -> CameraRays:
        """Cast one ray per pixel, through its point of sample `sample` (0: centre); all miss unless `valid`.

        Rays of a camera that moves from `before` are at the instants of its shutter.
        """
        if before is None:
            origin, direction = camera_rays(self.camera, self.lens, sampling.sample_point(sample))
        else:
            origin, direction = moving_rays(before, self.camera, self.lens, sample)
        start, end = (0.0, jnp.inf) if self.cut_height is None else interval_below(self.cut_height, origin, direction)
        found = cast(
            self.scene,
            origin if self.lens.model == "orthographic" or before is not None else self.camera.pos,
            direction,
            t_min=start,
            t_max=jnp.where(self.valid, end, -1.0),
            exclude=self.exclude,
            mask=RayKind.CAMERA,
        )
        # Without the barrier XLA would fuse the camera's rays into every image and recompute them per component.
        direction, found = jax.lax.optimization_barrier((direction, found))
        return CameraRays(origin, direction, found, self.camera, self.lens, sample, self.exclude)

    def rgb(self) -> UInt8[Array, "*image 3"]:
        """Return the colour image: the mean over each pixel's samples after tone mapping, encoded as sRGB.

        Raises:
            ConfigError: The bank does not have a bake that the shader needs, or the shader does not return a `Vec`.
        """
        return self._mean(self._display).map(encode_srgb).pack()

    def radiance(self) -> Vec:
        """Return the shader's light before exposure and tone curve: the mean over samples; errors as of `rgb`."""
        return self._mean(self._light)

    def _mean(self, shade: Callable[[CameraRays], Vec]) -> Vec:
        """Return the mean of `shade` over each pixel's samples."""
        check_shader_bakes(self.shader, self.scene.bank)
        first = shade(self.center_rays if self._moving is None else self.cast(0, self._moving))
        if self.lens.samples == 1:
            return first

        def add(total: Vec, sample: Int[Array, ""]) -> tuple[Vec, None]:
            """Add one sample of all pixels."""
            return total + shade(self.cast(sample, self._moving)), None

        total, _ = jax.lax.scan(add, first, jnp.arange(1, self.lens.samples, dtype=jnp.int32))
        return total * (1 / self.lens.samples)

    def _display(self, rays: CameraRays) -> Vec:
        """Return the linear display light of one sample of each pixel, by the shader's `radiance` and `display`."""
        light = self._light(rays)
        if self.lens.vignette:
            center = camera_rays(self.camera, self.lens, sampling.sample_point(rays.sample))[1]
            light = light * vignette(self.lens, center)
        return self._checked("display", self.shader.display(self.scene, light), rays)

    def _light(self, rays: CameraRays) -> Vec:
        """Return the light of one sample of each pixel, by the shader's `radiance`."""
        return self._checked("radiance", self.shader.radiance(self.scene, rays), rays)

    def _checked(self, method: str, light: Any, rays: CameraRays) -> Vec:
        """Return `light`, the result of a shader's method, as it is.

        Raise `ConfigError` unless it is a `Vec` whose three components have the shape of `rays.hit.t`.
        """
        shapes = {jnp.shape(channel) for channel in jax.tree.leaves(light)}
        if not isinstance(light, Vec) or shapes != {rays.hit.t.shape}:
            wanted = f"a Vec with components of shape {rays.hit.t.shape}"
            message = f"`{method}` of the shader `{self.shader.name}` must return {wanted}, got {shorten(light)}"
            raise ConfigError(message, hint="`Vec.unpack` splits an array (H, W, 3).")
        return light


def interval_below(
    height: Float[Array, ""] | float, origin: Float[Array, "*image 3"], direction: Float[Array, "*image 3"]
) -> tuple[Float[Array, "*image"], Float[Array, "*image"]]:
    """Return the interval of t in which rays are below a height [m]; rays that are never below it get (0, -1).

    Example:
        >>> start, end = interval_below(2.0, jnp.array([0.0, 0.0, 3.0]), jnp.array([0.0, 0.0, -0.5]))
        >>> float(start), float(end)
        (2.0, inf)
    """
    rise, slope = height - origin[..., 2], direction[..., 2]
    crossing = rise / jnp.where(slope == 0, 1.0, slope)
    is_below = (rise > 0) | (slope < 0)
    start = jnp.where(slope < 0, jnp.maximum(crossing, 0.0), 0.0)
    end = jnp.where(is_below, jnp.where(slope > 0, crossing, jnp.inf), -1.0)
    return start, end
