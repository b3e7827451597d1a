"""Texels of mip-mapped textures, in linear light."""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8

from home_mjx.scene_compile.textures import mip_sizes


def _decode_table() -> Float[np.ndarray, "256"]:
    """Linear light of each sRGB byte (IEC 61966-2-1)."""
    value = np.arange(256) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)


DECODE = _decode_table()


def edge_of(textures: UInt8[Array, "l p 4"]) -> int:
    """Edge of the largest mip level [px]: a square texture of edge s has (4 s^2 - 1) / 3 texels in all levels."""
    return math.isqrt((3 * textures.shape[1] + 1) // 4)


def nearest(
    textures: UInt8[Array, "l p 4"], layer: Int[Array, "*rays"], uv: Float[Array, "*rays 2"]
) -> UInt8[Array, "*rays 4"]:
    """The nearest texel of the largest level, the texture repeating; v = 0 is the bottom row.

    Nearest, because at 64x64 pixels textures are minified and bilinear taps would cost four gathers and still alias.
    """
    size = edge_of(textures)
    texel = jnp.floor((uv - jnp.floor(uv)) * size).astype(jnp.int32)
    column, row = (jnp.minimum(texel[..., i], size - 1) for i in range(2))
    return textures[layer, (size - 1 - row) * size + column]


def trilinear(
    textures: UInt8[Array, "l p 4"],
    layer: Int[Array, "*rays"],
    uv: Float[Array, "*rays 2"],
    level: Float[Array, "*rays"],
) -> Float[Array, "*rays 3"]:
    """Colours between texels and between mip levels, in linear light; the texture repeats.

    Args:
        textures: Layers with all their levels.
        layer: Which.
        uv: Where; v = 0 is the bottom row.
        level: 0 is the largest level, 1 half of it; beyond both ends the nearest is taken.
    """
    last = edge_of(textures).bit_length() - 1
    level = jnp.clip(level, 0.0, float(last))
    low = jnp.floor(level)
    part = (level - low)[..., None]
    low = low.astype(jnp.int32)
    fine = _bilinear(textures, layer, uv, low)
    coarse = _bilinear(textures, layer, uv, jnp.minimum(low + 1, last))
    return fine + part * (coarse - fine)


def mip_level(texels: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """The level whose texels are as large as the footprint of a pixel.

    Source: T. Akenine-Möller et al., "Texture level of detail strategies for real-time ray tracing", Ray Tracing Gems
    2019: half the binary logarithm of the area, in texels of the largest level.

    Args:
        texels: Area of the footprint in texels of level 0.

    Example:
        >>> mip_level(jnp.array([1.0, 4.0, 64.0])).tolist()
        [0.0, 1.0, 3.0]
    """
    return 0.5 * jnp.log2(jnp.maximum(texels, 1e-20))


def _bilinear(
    textures: UInt8[Array, "l p 4"],
    layer: Int[Array, "*rays"],
    uv: Float[Array, "*rays 2"],
    level: Int[Array, "*rays"],
) -> Float[Array, "*rays 3"]:
    sizes = mip_sizes(edge_of(textures))
    start = jnp.asarray(np.cumsum([0, *sizes[:-1]]), jnp.int32)[level]
    size = jnp.asarray([math.isqrt(n) for n in sizes], jnp.int32)[level]
    # Texel centres lie at half integers; rows count down from v = 1.
    span = size.astype(jnp.float32)
    column = (uv[..., 0] - jnp.floor(uv[..., 0])) * span - 0.5
    row = (1 - (uv[..., 1] - jnp.floor(uv[..., 1]))) * span - 0.5
    left, top = jnp.floor(column), jnp.floor(row)
    across, down = (column - left)[..., None], (row - top)[..., None]

    def texel(dx: int, dy: int) -> Float[Array, "*rays 3"]:
        x = (left.astype(jnp.int32) + dx) % size
        y = (top.astype(jnp.int32) + dy) % size
        color = textures[layer, start + y * size + x]
        return jnp.asarray(DECODE)[color[..., :3].astype(jnp.int32)]

    upper = texel(0, 0) * (1 - across) + texel(1, 0) * across
    lower = texel(0, 1) * (1 - across) + texel(1, 1) * across
    return upper * (1 - down) + lower * down
