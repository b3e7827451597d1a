"""Colour of hits: textured albedo under a light at the camera, in linear light, then sRGB bytes."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, UInt8

from home_mjx.raycast_render.image import texture
from home_mjx.raycast_render.surface import material_rows, texture_coordinates
from home_mjx.raycast_render.types import Hit, Scene
from home_mjx.scene_compile.bank import HouseBank

AMBIENT = 0.35  # of the light that falls on every surface
HEADLIGHT = 0.65  # of the light that falls on a surface that faces the camera
EXPOSURE = 1.0  # white under full light is white
SKY = (0.53, 0.68, 0.86)  # linear light, where nothing is hit


def albedo(bank: HouseBank, scene: Scene, hit: Hit) -> Float[Array, "*rays 3"]:
    """Diffuse reflectance in linear light: the material's colour times its texture; the sky's colour on a miss."""
    row = jnp.maximum(material_rows(scene, hit), 0)
    layer = bank.materials.texture[row]
    texel = texture.nearest(bank.materials.textures, jnp.maximum(layer, 0), texture_coordinates(scene, hit))
    texel = jnp.asarray(texture.DECODE)[texel[..., :3].astype(jnp.int32)]
    color = bank.materials.albedo[row][..., :3] * jnp.where(layer[..., None] < 0, 1, texel)
    return jnp.where(hit.instance[..., None] < 0, jnp.array(SKY, jnp.float32), color)


def head_light(
    color: Float[Array, "*rays 3"], normal: Float[Array, "*rays 3"], direction: Float[Array, "*rays 3"]
) -> Float[Array, "*rays 3"]:
    """Linear light that reaches the camera from a light beside it, without falling off; a miss keeps its colour."""
    length = jnp.linalg.norm(direction, axis=-1)
    facing = -jnp.sum(normal * direction, axis=-1) / length
    missed = jnp.all(normal == 0, axis=-1)
    light = jnp.where(missed, 1, AMBIENT + HEADLIGHT * facing)
    # Without the barrier XLA's CPU fusion gathers normals and texels again for each of the three channels.
    color, light = jax.lax.optimization_barrier((color, light))
    return color * light[..., None]


def encode(linear: Float[Array, "*rays 3"]) -> UInt8[Array, "*rays 3"]:
    """Bytes in sRGB (IEC 61966-2-1) of linear light, at a fixed exposure."""
    exposed = jnp.clip(linear * EXPOSURE, 0, 1)
    curve = 1.055 * jnp.power(jnp.maximum(exposed, 0.0031308), 1 / 2.4) - 0.055
    encoded = jnp.where(exposed <= 0.0031308, 12.92 * exposed, curve)
    return jnp.round(encoded * 255).astype(jnp.uint8)
