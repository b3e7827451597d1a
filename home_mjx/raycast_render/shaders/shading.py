"""The fast preset: textured albedo under a light at the camera, in linear light, and sRGB encoding."""

import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.scene.look import swap_textures, tint_materials
from home_mjx.raycast_render.scene.surface import material_rows, texture_coordinates
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.raycast_render.shaders import texture

AMBIENT_WEIGHT = 0.35  # irradiance factor of every surface
HEADLIGHT_WEIGHT = 0.65  # additional irradiance factor of a surface that faces the camera
EXPOSURE = 1.0  # maps a white surface under full light to white
MISS_COLOR = (0.53, 0.68, 0.86)  # linear light on a miss


def albedo(scene: Scene, hit: Hit) -> Vec:
    """Return the diffuse reflectance in linear light: the material's colour times its texture; sky colour on a miss."""
    materials = scene.bank.materials
    row = jnp.maximum(material_rows(scene, hit), 0)
    layer = swap_textures(scene.appearance, take(materials.texture, row), row, materials.texture)
    texel = texture.sample_nearest(materials.textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit))
    color = tint_materials(scene.appearance, take_vec(materials.albedo, row), row)
    color = select(layer < 0, color, color * texture.decode_linear(texel))
    return select(hit.instance < 0, Vec(*MISS_COLOR), color)


def shade_headlight(color: Vec, normal: Vec, direction: Vec) -> Vec:
    """Shade with a light at the camera without distance attenuation; a miss keeps its colour."""
    facing = -normal.dot(direction) * direction.inverse_norm()
    missed = normal.dot(normal) == 0
    return color * jnp.where(missed, 1.0, AMBIENT_WEIGHT + HEADLIGHT_WEIGHT * facing)


def encode_srgb(linear: Float[Array, "..."]) -> UInt8[Array, "..."]:
    """Encode linear light as sRGB bytes (IEC 61966-2-1), at a fixed exposure."""
    exposed = jnp.clip(linear * EXPOSURE, 0, 1)
    curve = 1.055 * jnp.power(jnp.maximum(exposed, 0.0031308), 1 / 2.4) - 0.055
    encoded = jnp.where(exposed <= 0.0031308, 12.92 * exposed, curve)
    return jnp.round(encoded * 255).astype(jnp.uint8)
