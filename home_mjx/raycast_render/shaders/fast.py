"""The shader `fast`: textured albedo under a light at the camera; darker in rooms whose lamps are off."""

from dataclasses import dataclass
from typing import ClassVar

import jax.numpy as jnp

from home_mjx.raycast_render.lighting.texture import albedo, emission
from home_mjx.raycast_render.scene.appearance import instance_glow
from home_mjx.raycast_render.scene.surface import semantics, unit_normals
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, take
from home_mjx.raycast_render.shaders.base import CameraRays, Shader, register_shader
from home_mjx.schema.semantic import Semantic

AMBIENT_WEIGHT = 0.35  # irradiance factor of every surface
DARK_WEIGHT = 0.4  # light in a room whose lamps are all off, of that with all on
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
        light = shade_headlight(color, unit_normals(scene, direction, rays.hit), direction)
        light, own = light_by_switches(scene, rays.hit, light), emission(scene, rays.hit)
        return light if own is None else light + own


def light_by_switches(scene: Scene, hit: Hit, light: Vec) -> Vec:
    """Darken rooms by the share of their lamps that is off, and blend what is on to white by its glow.

    Unchanged without states of lamps, see `EnvConfig.switches`; elsewhere than in rooms too.
    """
    look, glow = scene.appearance, instance_glow(scene.appearance, hit.instance)
    if look is None or look.lamps is None or glow is None:
        return light
    room = semantics(scene, hit, Semantic.ROOM)
    lamps = jnp.minimum(take(look.lamps, jnp.clip(room + 1, 0, look.lamps.shape[0] - 1)), 1.0)
    light = light * jnp.where(room < 0, 1.0, DARK_WEIGHT + (1 - DARK_WEIGHT) * lamps)
    return light * (1 - glow) + Vec(1.0, 1.0, 1.0) * glow


def shade_headlight(color: Vec, normal: Vec, direction: Vec) -> Vec:
    """Scale colours by `AMBIENT_WEIGHT` + `HEADLIGHT_WEIGHT` times the cosine between normal and view.

    Unit normals face the camera; `direction` is its rays', of any length. Misses, with zero normal, keep their colour.
    """
    facing = -normal.dot(direction) * direction.inverse_norm()
    missed = normal.dot(normal) == 0
    return color * jnp.where(missed, 1.0, AMBIENT_WEIGHT + HEADLIGHT_WEIGHT * facing)
