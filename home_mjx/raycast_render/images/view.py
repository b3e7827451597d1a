"""View of one camera in one environment: its rays, and their colours under a preset."""

from dataclasses import dataclass
from functools import cached_property

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.cameras import sampling
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays, is_valid_camera, pixel_footprint
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene import surface
from home_mjx.raycast_render.scene.look import scale_exposure
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit, optics, shading
from home_mjx.raycast_render.shaders.lights import LightSample
from home_mjx.raycast_render.shaders.preset import LitShader
from home_mjx.schema.compiled import RayKind


class CameraRays(Pytree):
    """One ray per pixel and its first hit."""

    origin: Float[Array, "*image 3"]
    direction: Float[Array, "*image 3"]
    hit: Hit


@dataclass(frozen=True)
class View:
    """A camera in an environment; `shader` None selects the fast preset."""

    scene: Scene
    camera: Camera
    lens: Lens
    shader: LitShader | None
    exclude: Int[Array, ""] | int

    @cached_property
    def valid(self) -> Bool[Array, ""]:
        """Validity of the camera and of the poses of all moving instances."""
        return is_valid_camera(self.camera, self.lens) & jnp.all(jnp.isfinite(self.scene.moving.pose))

    @cached_property
    def center_rays(self) -> CameraRays:
        """Rays through the centre of every pixel."""
        return self.cast(sampling.sample_point(0))

    def cast(self, at: Float[Array, "2"]) -> CameraRays:
        """Cast rays through a point of every pixel; all rays miss if a pose is invalid."""
        origin, direction = camera_rays(self.camera, self.lens, at)
        reach = jnp.where(self.valid, jnp.inf, -1.0)
        found = cast(
            self.scene,
            origin if self.lens.model == "orthographic" else self.camera.pos,
            direction,
            t_max=reach,
            exclude=self.exclude,
            mask=RayKind.CAMERA,
        )
        # Without the barrier XLA would fuse the camera's rays into every image and recompute them per component.
        direction, found = jax.lax.optimization_barrier((direction, found))
        return CameraRays(origin, direction, found)

    def rgb(self) -> UInt8[Array, "*image 3"]:
        """Return sRGB, the mean over each pixel's samples after tone mapping."""
        first = self._shown(self.center_rays, 0)
        if self.lens.samples == 1:
            return first.map(shading.encode_srgb).pack()

        def add(total: Vec, sample: Int[Array, ""]) -> tuple[Vec, None]:
            return total + self._shown(self.cast(sampling.sample_point(sample)), sample), None

        total, _ = jax.lax.scan(add, first, jnp.arange(1, self.lens.samples, dtype=jnp.int32))
        return (total * (1 / self.lens.samples)).map(shading.encode_srgb).pack()

    def _shown(self, rays: CameraRays, sample: Int[Array, ""] | int) -> Vec:
        """Return linear light on a display, in [0, 1]."""
        if self.shader is None:
            albedo = shading.albedo(self.scene, rays.hit)
            direction = Vec.unpack(rays.direction)
            normal = surface.unit_normals(self.scene, direction, rays.hit)
            light = scale_exposure(self.scene.appearance, shading.shade_headlight(albedo, normal, direction))
            return light.map(lambda x: jnp.clip(x, 0, 1))
        light = lit.radiance(
            self.scene,
            self.path_state(rays),
            pixel_footprint(self.camera, self.lens)[1],
            self._spread(rays.hit.t.shape, sample),
            self.shader,
            self.exclude,
        )
        exposure = lit.auto_exposure(light) if self.shader.exposure is None else self.shader.exposure
        return lit.tone_map(scale_exposure(self.scene.appearance, light), exposure)

    def path_state(self, rays: CameraRays) -> optics.PathState:
        """Return the path state of camera rays before specular transport."""
        width = jnp.full_like(rays.hit.t, pixel_footprint(self.camera, self.lens)[0])
        white = Vec(*[jnp.ones_like(width)] * 3)
        return optics.PathState(Vec.unpack(rays.origin), Vec.unpack(rays.direction), rays.hit, width, white)

    def _spread(self, shape: tuple[int, ...], sample: Int[Array, ""] | int) -> LightSample:
        """Return emitting positions on lights; None (their centres) without several samples or ambient occlusion."""
        if self.lens.samples == 1 and not (self.shader and self.shader.ao_radius):
            return None
        return 2 * sampling.sample_points(sample, shape, seed=1) - 1
