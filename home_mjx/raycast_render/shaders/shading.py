"""Colour of hits: textured albedo under a light at the camera, in linear light, then sRGB bytes."""

import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.scene.look import swapped, tinted
from home_mjx.raycast_render.scene.surface import material_rows, texture_coordinates
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.raycast_render.shaders import texture

AMBIENT = 0.35  # of the light that falls on every surface
HEADLIGHT = 0.65  # of the light that falls on a surface that faces the camera
EXPOSURE = 1.0  # white under full light is white
SKY = (0.53, 0.68, 0.86)  # linear light, where nothing is hit


def albedo(scene: Scene, hit: Hit) -> Vec:
    """Diffuse reflectance in linear light: the material's colour times its texture; the sky's colour on a miss."""
    materials = scene.bank.materials
    row = jnp.maximum(material_rows(scene, hit), 0)
    layer = swapped(scene.look, take(materials.texture, row), row, materials.texture)
    texel = texture.nearest(materials.textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit))
    color = tinted(scene.look, take_vec(materials.albedo, row), row)
    color = select(layer < 0, color, color * texture.linear(texel))
    return select(hit.instance < 0, Vec(*SKY), color)


def head_light(color: Vec, normal: Vec, direction: Vec) -> Vec:
    """Linear light that reaches the camera from a light beside it, without falling off; a miss keeps its colour."""
    facing = -normal.dot(direction) * direction.inverse_norm()
    missed = normal.dot(normal) == 0
    return color * jnp.where(missed, 1.0, AMBIENT + HEADLIGHT * facing)


def encode(linear: Float[Array, "..."]) -> UInt8[Array, "..."]:
    """Bytes in sRGB (IEC 61966-2-1) of linear light, at a fixed exposure."""
    exposed = jnp.clip(linear * EXPOSURE, 0, 1)
    curve = 1.055 * jnp.power(jnp.maximum(exposed, 0.0031308), 1 / 2.4) - 0.055
    encoded = jnp.where(exposed <= 0.0031308, 12.92 * exposed, curve)
    return jnp.round(encoded * 255).astype(jnp.uint8)
