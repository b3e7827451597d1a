"""Cut-out texels of ray packets, one ray per lane, rounded as in `cuda`; called for materials with cut-outs only."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import no_type_check

import numpy as np
from numba import types

from home_mjx.bank.records.geometry import CUTOUT_SHIFT
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of
from home_mjx.core.native.simd import LANES, broadcast, load, select, store
from home_mjx.schema.compiled import RayKind

ALL_KINDS, SOUND = np.int32(RayKind.ALL), np.int32(RayKind.SOUND)
WORD_BITS = 32  # texels per word of `Geometry.cutout`
ZERO, ONE = np.float32(0), np.float32(1)

weights, flags = stack_of(types.float32, 2 * LANES), stack_of(types.int32, 2 * LANES)


@compile_inner()  # rarely called, too large to inline
@no_type_check
def drop_cut_outs(world, triangle, stops, mask, u, v, wins):
    """Return the lanes of `wins` without rays that pass through a cut-out texel of a triangle.

    Rays whose `mask` shares `RayKind.SOUND` with `stops` never pass.

    `stops` is the triangle's entry of `Geometry.material_mask`: `RayKind` bits, and the cut-out layer above them.
    `mask` has the rays' `RayKind` bits; `u` and `v` are barycentric weights of corners 1 and 2 at their hits.
    """
    weight, flag = weights(), flags()
    store(weight, 0, u)
    store(weight, LANES, v)
    store(flag, 0, select(wins, broadcast(np.int32(1)), np.int32(0)))
    store(flag, LANES, mask)
    layer = np.int64(stops) >> CUTOUT_SHIFT
    for lane in range(LANES):
        may_pass = flag[lane] != 0 and (flag[LANES + lane] & stops & SOUND) == 0
        if may_pass and _is_cut_out(world, np.int64(triangle), layer, weight[lane], weight[LANES + lane]):
            flag[lane] = 0
    return ~(load(flag, 0) == np.int32(0))


@compile_inner()
@no_type_check
def _is_cut_out(world, triangle, layer, u, v):
    """Return whether the texel around weights u, v of corners 1, 2 is cut out; `layer` counts from 1, clipped."""
    edge = world.sizes.edge
    column = _texel(world.triangle_uv, 6 * triangle, u, v, edge)
    row = edge - 1 - _texel(world.triangle_uv, 6 * triangle + 1, u, v, edge)
    words = (edge + WORD_BITS - 1) // WORD_BITS
    layer = min(max(layer - 1, np.int64(0)), world.sizes.layers - 1)
    word = world.cutout[(layer * edge + row) * words + column // WORD_BITS]
    return (np.int64(word) >> (column % WORD_BITS)) & 1 == 1


@compile_inner()
@no_type_check
def _texel(uv, at, u, v, edge):
    """Return the texel index, 0 .. edge - 1 (NaN: 0), at weights u, v of corners 1, 2; `uv[at + 2 k]` is corner k's.

    Texture coordinates outside [0, 1) repeat.
    """
    x = (ONE - u - v) * uv[at] + u * uv[at + 2] + v * uv[at + 4]
    place = (x - np.floor(x)) * np.float32(edge)
    return min(np.int64(place), edge - 1) if place >= ZERO else np.int64(0)
