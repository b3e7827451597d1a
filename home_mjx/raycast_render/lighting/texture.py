"""Colours of surfaces: texture look-ups with mip maps, diffuse reflectance, and sRGB."""

import math
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8, UInt32

from home_mjx.core.color import decode_srgb
from home_mjx.raycast_render.scene.appearance import swap_textures, tint_materials
from home_mjx.raycast_render.scene.surface import material_rows, texture_coordinates
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec


def _decode_table() -> Float[np.ndarray, "256"]:
    """Return the linear light of each sRGB byte (IEC 61966-2-1)."""
    return decode_srgb(np.arange(256) / 255).astype(np.float32)


SRGB_TO_LINEAR = _decode_table()
# Minimax polynomial of the curve above byte 10, highest power first, fitted to the 245 bytes.
SRGB_TO_LINEAR_POLYNOMIAL = (-0.05466916, 0.22675983, -0.43463315, 0.71703972, 0.51144349, 0.03313933, 0.00091457)
EXPOSURE = 1.0  # maps a white surface under full light to white
MISS_COLOR = (0.53, 0.68, 0.86)  # linear light on a miss


def albedo(scene: Scene, hit: Hit) -> Vec:
    """Return the diffuse reflectance in linear RGB: the material's colour times its texture; sky colour on a miss."""
    materials = scene.bank.materials
    row = jnp.maximum(material_rows(scene, hit), 0)
    layer = swap_textures(scene.appearance, take(materials.texture, row), row, materials.texture)
    texel = sample_nearest(materials.textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit))
    color = tint_materials(scene.appearance, take_vec(materials.albedo, row), row)
    color = select(layer < 0, color, color * decode_linear(texel))
    return select(hit.instance < 0, Vec(*MISS_COLOR), color)


def emission(scene: Scene, hit: Hit) -> Vec | None:
    """Return the emission of materials in linear light, 0 on a miss; None if no house of the bank has any."""
    lights = scene.bank.lights
    if not lights.glowing.shape[1]:
        return None
    rows, colors = lights.glowing[scene.house], lights.glow[scene.house]
    same = (material_rows(scene, hit)[..., None] == rows) & (rows >= 0)
    return Vec(*(jnp.where(same, colors[:, channel], 0.0).sum(axis=-1) for channel in range(3)))


def encode_srgb(linear: Float[Array, "..."]) -> UInt8[Array, "..."]:
    """Encode linear light, clipped to [0, 1], as sRGB bytes, rounded (IEC 61966-2-1)."""
    exposed = jnp.clip(linear * EXPOSURE, 0, 1)
    curve = 1.055 * jnp.power(jnp.maximum(exposed, 0.0031308), 1 / 2.4) - 0.055
    encoded = jnp.where(exposed <= 0.0031308, 12.92 * exposed, curve)
    return jnp.round(encoded * 255).astype(jnp.uint8)


def texture_edge(textures: UInt32[Any, "l p"]) -> int:
    """Return the edge of the largest mip level [px] of textures (layers, texels of all levels).

    A square texture of edge s has (4 s^2 - 1) / 3 texels in all levels.
    """
    return math.isqrt((3 * textures.shape[1] + 1) // 4)


def texel_channel(texel: UInt32[Array, "*rays"], place: int) -> Int[Array, "*rays"]:
    """Return a byte (0..255) of packed texels; `place` 0 is red, 1 green, 2 blue, 3 alpha."""
    return ((texel >> (8 * place)) & 255).astype(jnp.int32)


def decode_linear(texel: UInt32[Array, "*rays"]) -> Vec:
    """Decode packed sRGB texels to linear light in [0, 1]; alpha is ignored."""
    return Vec(*(take(jnp.asarray(SRGB_TO_LINEAR), texel_channel(texel, place)) for place in range(3)))


def linear_approx(texel: UInt32[Array, "*rays"]) -> Vec:
    """Decode packed sRGB texels to linear light within 6e-6, without a table look-up per channel; alpha is ignored."""

    def decode(byte: Int[Array, "*rays"]) -> Float[Array, "*rays"]:
        """Decode one channel."""
        value = byte.astype(jnp.float32) * (1 / 255)
        curve = jnp.full_like(value, SRGB_TO_LINEAR_POLYNOMIAL[0])
        for power in SRGB_TO_LINEAR_POLYNOMIAL[1:]:
            curve = curve * value + power
        return jnp.where(byte <= 10, value * (1 / 12.92), curve)

    return Vec(*(decode(texel_channel(texel, place)) for place in range(3)))


def sample_nearest(
    textures: UInt32[Array, "l p"], layer: Int[Array, "*rays"], u: Float[Array, "*rays"], v: Float[Array, "*rays"]
) -> UInt32[Array, "*rays"]:
    """Return the nearest packed texel, at u (right) and v (up from the bottom), of a repeating texture's largest level.

    It is the texel that contains the point; `layer` must be valid. At 64x64 pixels textures are minified, and bilinear
    taps would cost four gathers and still alias.
    """
    size = texture_edge(textures)
    column, row = (jnp.minimum(jnp.floor((x - jnp.floor(x)) * size).astype(jnp.int32), size - 1) for x in (u, v))
    return _pick(textures, layer, (size - 1 - row) * size + column)


def sample_trilinear(
    textures: UInt32[Array, "l p"],
    layer: Int[Array, "*rays"],
    u: Float[Array, "*rays"],
    v: Float[Array, "*rays"],
    level: Float[Array, "*rays"],
) -> Vec:
    """Interpolate between texels and between mip levels of a repeating texture; return linear light.

    `u` is to the right, `v` upwards; v = 0 is the bottom row. Mip level 0 is the largest, 1 has half its edge; levels
    are clipped to those of the texture.
    """
    last = texture_edge(textures).bit_length() - 1
    level = jnp.clip(level, 0.0, float(last))
    low = jnp.floor(level)
    fine = _bilinear(textures, layer, u, v, low.astype(jnp.int32))
    coarse = _bilinear(textures, layer, u, v, jnp.minimum(low.astype(jnp.int32) + 1, last))
    return _mix(fine, coarse, level - low)


def mip_level(texels: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """Return the mip level whose texels are as large as a footprint of `texels` texels of level 0; negative below one.

    Source: T. Akenine-Möller et al., "Texture level of detail strategies for real-time ray tracing", Ray Tracing Gems
    2019: half the binary logarithm of the area, in texels of the largest level.

    Example:
        >>> mip_level(jnp.array([1.0, 4.0, 64.0])).tolist()
        [0.0, 1.0, 3.0]
    """
    return 0.5 * jnp.log2(jnp.maximum(texels, 1e-20))


def _bilinear(
    textures: UInt32[Array, "l p"],
    layer: Int[Array, "*rays"],
    u: Float[Array, "*rays"],
    v: Float[Array, "*rays"],
    level: Int[Array, "*rays"],
) -> Vec:
    """Interpolate between the four nearest texels of an integer mip level, with wrap-around; return linear light."""
    edge = texture_edge(textures)
    size = edge >> level
    start = (edge * edge - size * size) * 4 // 3  # texels of all larger levels
    # Texel centres are at half integers; rows count down from v = 1.
    span = size.astype(jnp.float32)
    column, row = (u - jnp.floor(u)) * span - 0.5, (1 - (v - jnp.floor(v))) * span - 0.5
    left, top = jnp.floor(column), jnp.floor(row)

    def texel(dx: int, dy: int) -> Vec:
        """Return the texel (dx, dy) from the upper left one, in linear light."""
        # Edges are powers of two, so the mask computes the remainder.
        x, y = (left.astype(jnp.int32) + dx) & (size - 1), (top.astype(jnp.int32) + dy) & (size - 1)
        return linear_approx(_pick(textures, layer, start + y * size + x))

    upper = _mix(texel(0, 0), texel(1, 0), column - left)
    lower = _mix(texel(0, 1), texel(1, 1), column - left)
    return _mix(upper, lower, row - top)


def _pick(
    textures: UInt32[Array, "l p"], layer: Int[Array, "*rays"], texel: Int[Array, "*rays"]
) -> UInt32[Array, "*rays"]:
    """Return packed texels by layer and index within the layer's mip chain."""
    return take(textures.reshape(-1), layer * textures.shape[1] + texel)


def _mix(first: Vec, second: Vec, share: Float[Array, "*rays"]) -> Vec:
    """Interpolate linearly; `share` 0 is `first`, 1 is `second`."""
    return first + (second - first) * share
