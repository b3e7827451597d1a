"""The shader `fast`: textured albedo under a light at the camera."""

from dataclasses import dataclass
from typing import ClassVar

import jax.numpy as jnp

from home_mjx.raycast_render.scene.surface import unit_normals
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.base import CameraRays, Shader, register_shader
from home_mjx.raycast_render.shaders.texture import albedo

AMBIENT_WEIGHT = 0.35  # irradiance factor of every surface
HEADLIGHT_WEIGHT = 0.65  # additional irradiance factor of a surface that faces the camera


@register_shader
@dataclass(frozen=True)
class FastShader(Shader):
    """Albedo with nearest texels under a light at the camera; no rays beyond the camera's, and no options."""

    name: ClassVar[str] = "fast"

    def radiance(self, scene: Scene, rays: CameraRays) -> Vec:
        """Compute the albedo times the light at the camera; a miss has the colour of the sky."""
        color = albedo(scene, rays.hit)
        direction = Vec.unpack(rays.direction)
        return shade_headlight(color, unit_normals(scene, direction, rays.hit), direction)


def shade_headlight(color: Vec, normal: Vec, direction: Vec) -> Vec:
    """Scale colours by `AMBIENT_WEIGHT` + `HEADLIGHT_WEIGHT` times the cosine between normal and view.

    Unit normals face the camera; `direction` is its rays', of any length. Misses, with zero normal, keep their colour.
    """
    facing = -normal.dot(direction) * direction.inverse_norm()
    missed = normal.dot(normal) == 0
    return color * jnp.where(missed, 1.0, AMBIENT_WEIGHT + HEADLIGHT_WEIGHT * facing)
