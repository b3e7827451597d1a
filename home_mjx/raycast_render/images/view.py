"""View of one camera in one environment: its rays, and their colours under a preset."""

from dataclasses import dataclass
from functools import cached_property

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt8

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.cameras import sampling
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays, is_usable, pixel_width
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene import surface
from home_mjx.raycast_render.scene.look import exposed
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit, optics, shading
from home_mjx.raycast_render.shaders.lights import Spread
from home_mjx.raycast_render.shaders.preset import Lit
from home_mjx.schema.compiled import Ray


class CameraRays(Pytree):
    """One ray per pixel and its first hit."""

    origin: Float[Array, "*image 3"]
    direction: Float[Array, "*image 3"]
    hit: Hit


@dataclass(frozen=True)
class View:
    """A camera in an environment; `options` None selects the fast preset."""

    scene: Scene
    camera: Camera
    lens: Lens
    options: Lit | None
    exclude: Int[Array, ""] | int

    @cached_property
    def valid(self) -> Bool[Array, ""]:
        """Validity of the camera and of the poses of all moving instances."""
        return is_usable(self.camera, self.lens) & jnp.all(jnp.isfinite(self.scene.moving.pose))

    @cached_property
    def middle(self) -> CameraRays:
        """Rays through the centre of every pixel."""
        return self.cast(sampling.point(0))

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
            mask=Ray.CAMERA,
        )
        # Without the barrier XLA would fuse the camera's rays into every image and recompute them per component.
        direction, found = jax.lax.optimization_barrier((direction, found))
        return CameraRays(origin, direction, found)

    def rgb(self) -> UInt8[Array, "*image 3"]:
        """Return sRGB, the mean over each pixel's samples after tone mapping."""
        first = self._shown(self.middle, 0)
        if self.lens.samples == 1:
            return first.map(shading.encode).packed()

        def add(total: Vec, sample: Int[Array, ""]) -> tuple[Vec, None]:
            return total + self._shown(self.cast(sampling.point(sample)), sample), None

        total, _ = jax.lax.scan(add, first, jnp.arange(1, self.lens.samples, dtype=jnp.int32))
        return (total * (1 / self.lens.samples)).map(shading.encode).packed()

    def _shown(self, rays: CameraRays, sample: Int[Array, ""] | int) -> Vec:
        """Return linear light on a display, in [0, 1]."""
        if self.options is None:
            albedo = shading.albedo(self.scene, rays.hit)
            direction = Vec.of(rays.direction)
            normal = surface.unit_normals(self.scene, direction, rays.hit)
            light = exposed(self.scene.look, shading.head_light(albedo, normal, direction))
            return light.map(lambda x: jnp.clip(x, 0, 1))
        light = lit.radiance(
            self.scene,
            self.sight(rays),
            pixel_width(self.camera, self.lens)[1],
            self._spread(rays.hit.t.shape, sample),
            self.options,
            self.exclude,
        )
        exposure = lit.metered(light) if self.options.exposure is None else self.options.exposure
        return lit.tone_map(exposed(self.scene.look, light), exposure)

    def sight(self, rays: CameraRays) -> optics.Sight:
        """Return the path state of camera rays before specular transport."""
        width = jnp.full_like(rays.hit.t, pixel_width(self.camera, self.lens)[0])
        white = Vec(*[jnp.ones_like(width)] * 3)
        return optics.Sight(Vec.of(rays.origin), Vec.of(rays.direction), rays.hit, width, white)

    def _spread(self, shape: tuple[int, ...], sample: Int[Array, ""] | int) -> Spread:
        """Return emitting positions on lights; None (their centres) without several samples or ambient occlusion."""
        if self.lens.samples == 1 and not (self.options and self.options.corners):
            return None
        return 2 * sampling.points(sample, shape, seed=1) - 1
