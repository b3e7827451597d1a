"""Surfaces at hits in compiled code: frame, material and filtered colour of one ray's end; counterpart of `lit`."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

import math
from typing import Any, NamedTuple, no_type_check

import numpy as np

from home_mjx.core.native.inner import compile_inner
from home_mjx.raycast_render.lighting import texture
from home_mjx.raycast_render.lighting.gloss import MAX_EDGE
from home_mjx.raycast_render.scene import appearance
from home_mjx.raycast_render.scene.appearance import (
    BLUE,
    GOLDEN,
    GREEN,
    LAYER,
    MULTIPLIER_1,
    MULTIPLIER_2,
    RED,
    SHIFTS,
    SWAP,
)
from home_mjx.schema.semantic import Semantic

ZERO, HALF, ONE, TWO = (np.float32(x) for x in (0, 0.5, 1, 2))
TINY_SQUARE, TINY_VOLUME, MAX_DENSITY, LEAST_FACING = (np.float32(x) for x in (1e-37, 1e-30, 1e12, 0.05))
LINEAR = texture.SRGB_TO_LINEAR
LEAST_SPECULAR = np.float32(1 / MAX_EDGE)
ROOM = int(Semantic.ROOM)
MASK = 0xFFFFFFFF  # of 32 bits
UNIT_SCALE = np.float32(appearance.UNIT_SCALE)

Pointer = Any
compiled = compile_inner()


class Tables(NamedTuple):
    """Pointers to the arrays of a bank that describe surfaces, and their numbers of rows."""

    triangle: Pointer
    uv: Pointer
    normal: Pointer
    slot: Pointer
    part: Pointer
    inverse: Pointer
    instance_material: Pointer
    instance_semantic: Pointer
    semantics: Pointer
    albedo: Pointer
    specular: Pointer
    shininess: Pointer
    texture: Pointer
    textures: Pointer
    instances: np.int64
    columns: np.int64  # of `semantics`
    layers: np.int64
    texels: np.int64  # per layer, all mip levels
    edge: np.int64  # of the largest level


class Episode(NamedTuple):
    """Pointers to what differs between environments: moving instances and overrides of the appearance."""

    house: np.int64
    slot: Pointer  # row of the moving instances by instance; -1 for fixed ones
    inverse: Pointer
    material: Pointer
    semantic: Pointer
    growth: np.float32  # of footprints [m] per unit of t
    tint: np.float32
    swap: np.float32
    seed: np.int64
    last_layer: np.int64  # of textures that may be swapped in


class Point(NamedTuple):
    """Surface at the end of a ray; see `gloss.ShadingPoint`."""

    px: np.float32
    py: np.float32
    pz: np.float32
    nx: np.float32
    ny: np.float32
    nz: np.float32
    sx: np.float32
    sy: np.float32
    sz: np.float32
    vx: np.float32
    vy: np.float32
    vz: np.float32
    red: np.float32
    green: np.float32
    blue: np.float32
    row: np.int64
    instance: np.int64
    moves: np.bool_
    room: np.int64


@compiled
@no_type_check
def inverse_norm(x, y, z):
    """Return 1 / length; large, but finite, for zero vectors."""
    return ONE / np.sqrt(max(x * x + y * y + z * z, TINY_SQUARE))


@compiled
@no_type_check
def describe_surface(tables, episode, ray, hit):
    """Return the `Point` of a hit `(t, instance, triangle, u, v)` of a ray `(origin, direction, footprint)`."""
    ox, oy, oz, dx, dy, dz, width = ray
    t, instance, triangle, u, v = hit
    inverse, at, material, semantic = _find_instance(tables, episode, instance)
    row = max(np.int64(material) + np.int64(tables.slot[triangle]), 0)
    turn = _normal_map(inverse, at)
    ax, ay, az = _area_vector(tables, turn, triangle, dx, dy, dz)
    sx, sy, sz = _smooth_normal(tables, turn, triangle, u, v, ax, ay, az)
    inverse_length, per = inverse_norm(dx, dy, dz), inverse_norm(ax, ay, az)
    facing = abs(ax * dx + ay * dy + az * dz) * per * inverse_length
    width = width + episode.growth * t
    footprint = width * width / max(facing, LEAST_FACING)
    red, green, blue = _filtered_color(tables, episode, triangle, row, u, v, footprint * min(per, MAX_DENSITY))
    part = np.int64(semantic) + np.int64(tables.part[triangle])
    return Point(
        ox + dx * t,
        oy + dy * t,
        oz + dz * t,
        ax * per,
        ay * per,
        az * per,
        sx,
        sy,
        sz,
        -dx * inverse_length,
        -dy * inverse_length,
        -dz * inverse_length,
        red,
        green,
        blue,
        row,
        np.int64(instance),
        episode.slot[instance] >= 0,
        np.int64(tables.semantics[part * tables.columns + ROOM]),
    )


@compiled
@no_type_check
def _find_instance(tables, episode, instance):
    """Return the table and offset of an instance's inverse pose, its first material row and first semantic row."""
    slot = np.int64(episode.slot[instance])
    if slot >= 0:
        return episode.inverse, 12 * slot, episode.material[slot], episode.semantic[slot]
    at = episode.house * tables.instances + np.int64(instance)
    return tables.inverse, 12 * at, tables.instance_material[at], tables.instance_semantic[at]


@compiled
@no_type_check
def _normal_map(inverse, at):
    """Return the matrix, by rows, that maps cross products of model vectors to the world."""
    a, b, c = inverse[at], inverse[at + 1], inverse[at + 2]
    d, e, f = inverse[at + 4], inverse[at + 5], inverse[at + 6]
    g, h, i = inverse[at + 8], inverse[at + 9], inverse[at + 10]
    volume = ONE / max(abs(a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)), TINY_VOLUME)
    return a * volume, b * volume, c * volume, d * volume, e * volume, f * volume, g * volume, h * volume, i * volume


@compiled
@no_type_check
def _to_world(turn, x, y, z):
    """Map a cross product of two model vectors to the world."""
    a, b, c, d, e, f, g, h, i = turn
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


@compiled
@no_type_check
def _area_vector(tables, turn, triangle, dx, dy, dz):
    """Return the normal of a triangle in the world, as long as twice its area [m^2], facing the ray."""
    p, at = tables.triangle, 9 * np.int64(triangle)
    ex, ey, ez = p[at + 3] - p[at], p[at + 4] - p[at + 1], p[at + 5] - p[at + 2]
    fx, fy, fz = p[at + 6] - p[at], p[at + 7] - p[at + 1], p[at + 8] - p[at + 2]
    x, y, z = _to_world(turn, ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx)
    side = -ONE if x * dx + y * dy + z * dz > ZERO else ONE
    return x * side, y * side, z * side


@compiled
@no_type_check
def _smooth_normal(tables, turn, triangle, u, v, ax, ay, az):
    """Return the unit smooth normal on the side of the area vector, which replaces missing ones."""
    n, at, w = tables.normal, 9 * np.int64(triangle), ONE - u - v
    x = n[at] * w + n[at + 3] * u + n[at + 6] * v
    y = n[at + 1] * w + n[at + 4] * u + n[at + 7] * v
    z = n[at + 2] * w + n[at + 5] * u + n[at + 8] * v
    x, y, z = _to_world(turn, x, y, z)
    side = -ONE if x * ax + y * ay + z * az < ZERO else ONE
    if not x * x + y * y + z * z > ZERO:
        x, y, z, side = ax, ay, az, ONE
    per = side * inverse_norm(x, y, z)
    return x * per, y * per, z * per


@compiled
@no_type_check
def _filtered_color(tables, episode, triangle, row, u, v, density):
    """Return the material's colour times its texture, filtered over a footprint; `density` is that per area."""
    red, green, blue = tables.albedo[4 * row], tables.albedo[4 * row + 1], tables.albedo[4 * row + 2]
    if episode.tint > ZERO:
        red, green = _tinted(episode, row, RED, red), _tinted(episode, row, GREEN, green)
        blue = _tinted(episode, row, BLUE, blue)
    layer = _swapped_layer(tables, episode, row)
    if layer < 0:
        return red, green, blue
    c, at = tables.uv, 6 * np.int64(triangle)
    area = abs((c[at + 2] - c[at]) * (c[at + 5] - c[at + 1]) - (c[at + 3] - c[at + 1]) * (c[at + 4] - c[at]))
    texels = density * area * np.float32(tables.edge * tables.edge)
    level = HALF * np.float32(math.log2(max(texels, np.float32(1e-20))))
    w = ONE - u - v
    x, y = c[at] * w + c[at + 2] * u + c[at + 4] * v, c[at + 1] * w + c[at + 3] * u + c[at + 5] * v
    r, g, b = _trilinear(tables, min(layer, tables.layers - 1), x, y, level)
    return red * r, green * g, blue * b


@compiled
@no_type_check
def _trilinear(tables, layer, u, v, level):
    """Interpolate between texels and mip levels of a repeating texture; return linear light."""
    last, edge = 0, tables.edge
    while edge > 1:
        last, edge = last + 1, edge >> 1
    level = min(max(level, ZERO), np.float32(last))
    low = np.int64(level)
    share = level - np.float32(low)
    red, green, blue = _bilinear(tables, layer, u, v, low)
    if share > ZERO:
        r, g, b = _bilinear(tables, layer, u, v, min(low + 1, last))
        red, green, blue = red + (r - red) * share, green + (g - green) * share, blue + (b - blue) * share
    return red, green, blue


@compiled
@no_type_check
def _bilinear(tables, layer, u, v, level):
    """Interpolate between the four nearest texels of a mip level, with wrap-around; return linear light."""
    edge = tables.edge
    size = edge >> level
    start = layer * tables.texels + (edge * edge - size * size) * 4 // 3
    span = np.float32(size)
    column = (u - np.floor(u)) * span - HALF
    line = (ONE - (v - np.floor(v))) * span - HALF
    left, top = np.floor(column), np.floor(line)
    right_share, low_share = column - left, line - top
    x0, y0 = np.int64(left) & (size - 1), np.int64(top) & (size - 1)
    x1, y1 = (x0 + 1) & (size - 1), (y0 + 1) & (size - 1)
    t = tables.textures
    a, b = np.int64(t[start + y0 * size + x0]), np.int64(t[start + y0 * size + x1])
    c, d = np.int64(t[start + y1 * size + x0]), np.int64(t[start + y1 * size + x1])
    shares = ((ONE - right_share) * (ONE - low_share), right_share * (ONE - low_share))
    others = ((ONE - right_share) * low_share, right_share * low_share)
    red = _decode(a) * shares[0] + _decode(b) * shares[1] + _decode(c) * others[0] + _decode(d) * others[1]
    a, b, c, d = a >> 8, b >> 8, c >> 8, d >> 8
    green = _decode(a) * shares[0] + _decode(b) * shares[1] + _decode(c) * others[0] + _decode(d) * others[1]
    a, b, c, d = a >> 8, b >> 8, c >> 8, d >> 8
    blue = _decode(a) * shares[0] + _decode(b) * shares[1] + _decode(c) * others[0] + _decode(d) * others[1]
    return red, green, blue


@compiled
@no_type_check
def _decode(packed):
    """Return the linear light of the lowest byte, in sRGB."""
    return LINEAR[packed & 255]


@compiled
@no_type_check
def _tinted(episode, row, channel, color):
    """Scale a channel by the random factor of a material row, clipped to [0, 1]."""
    factor = ONE + episode.tint * (TWO * _hash_uniform(episode.seed, row, channel) - ONE)
    return min(max(color * factor, ZERO), ONE)


@compiled
@no_type_check
def _swapped_layer(tables, episode, row):
    """Return the texture layer of a material row, or by chance a random one; -1 none."""
    layer = np.int64(tables.texture[row])
    if layer < 0 or not episode.swap > ZERO or _hash_uniform(episode.seed, row, SWAP) >= episode.swap:
        return layer
    count = episode.last_layer + 1
    return min(np.int64(_hash_uniform(episode.seed, row, LAYER) * np.float32(count)), count - 1)


@compiled
@no_type_check
def _hash_uniform(seed, row, what):
    """Return the pseudorandom number in [0, 1) of a seed, a row and a channel, as `appearance.hash_uniform` does."""
    own = _mix_bits((row * GOLDEN + what) & MASK)
    return np.float32(_mix_bits(own ^ seed) >> 8) * UNIT_SCALE


@compiled
@no_type_check
def _mix_bits(x):
    """Apply MurmurHash3's 32-bit finaliser to a number in 64 bits."""
    x = ((x ^ (x >> SHIFTS[0])) * MULTIPLIER_1) & MASK
    x = ((x ^ (x >> SHIFTS[1])) * MULTIPLIER_2) & MASK
    return x ^ (x >> SHIFTS[2])
