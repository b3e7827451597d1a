"""Grouping of rays into packets; input of packets and output of hits."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import NamedTuple, no_type_check

import numpy as np
from numba import types

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to, stack_of
from home_mjx.core.native.simd import LANES, broadcast, load, select, store
from home_mjx.raycast_render.backends.numba.intersect import INF, ONE, ZERO, Lane
from home_mjx.raycast_render.scene import types as scene_types

TILE_WIDTH = 4  # [px], width of the image tile of a packet
FIRST_RAY_OPERAND = 20  # index of the first operand that is a field of `types.Rays`

MISS = np.float32(scene_types.MISS)
float_pointer, int_pointer, byte_pointer = map(pointer_to, (types.float32, types.int32, types.uint8))
lane_floats, lane_ints = stack_of(types.float32, 8 * LANES), stack_of(types.int32, 2 * LANES)
lane_rows = stack_of(types.int64, LANES)
compiled = compile_inner(forceinline=True)


class Tiling(NamedTuple):
    """Grouping of an environment's rays into packets: tiles of an image, or consecutive rays."""

    count: np.int64  # rays
    width: np.int64  # of the image; number of rays if there is none
    tile_width: np.int64
    across: np.int64  # packets per row of tiles
    packets: np.int64


class RowCounts(NamedTuple):
    """Numbers of rows of the arrays: instances per house, moving ones per environment."""

    nodes: np.int64
    triangles: np.int64
    models: np.int64
    houses: np.int64
    materials: np.int64
    layers: np.int64
    edge: np.int64  # texels along the side of a layer
    instances: np.int64
    moving: np.int64


class Packet(NamedTuple):
    """Rays of a packet as given by the caller."""

    ox: Lane
    oy: Lane
    oz: Lane
    dx: Lane
    dy: Lane
    dz: Lane
    t_min: Lane
    t_max: Lane
    exclude: Lane
    mask: Lane


@compiled
@no_type_check
def clip_row(row, count):
    """Clip a row index to 0 .. count - 1, as int64."""
    return min(max(np.int64(row), np.int64(0)), count - 1)


@compiled
@no_type_check
def make_tiling(rays, width):
    """Return the tiling of `rays` rays by tiles of an image of `width` [px].

    Consecutive rays form packets if `width` is below `TILE_WIDTH`, such as 0 (no image), or does not divide `rays`.
    """
    if width < TILE_WIDTH or rays % width != 0:
        across = (rays + LANES - 1) // LANES
        return Tiling(rays, rays, LANES, across, across)
    across, rows = (width + TILE_WIDTH - 1) // TILE_WIDTH, rays // width
    return Tiling(rays, width, TILE_WIDTH, across, across * ((rows + LANES // TILE_WIDTH - 1) // (LANES // TILE_WIDTH)))


@compiled
@no_type_check
def assign_lanes(tiles, packet, rows):
    """Write each lane's ray index within its environment, -1 if none, into `rows`; `packet` counts within it too."""
    x0, y0 = packet % tiles.across * tiles.tile_width, packet // tiles.across * (LANES // tiles.tile_width)
    for lane in range(LANES):
        x, start = x0 + lane % tiles.tile_width, (y0 + lane // tiles.tile_width) * tiles.width
        rows[lane] = start + x if x < tiles.width and start < tiles.count else -1


@compiled
@no_type_check
def read_packet(operands, counts, env, rows):
    """Return rays `rows`, see `assign_lanes`, of `env`, with t_max clipped to at most `MISS`.

    Lanes with row -1 have t_min infinity, and the other fields of ray 0.
    """
    origin, direction = float_pointer(operands[FIRST_RAY_OPERAND]), float_pointer(operands[FIRST_RAY_OPERAND + 1])
    t_min, t_max = float_pointer(operands[FIRST_RAY_OPERAND + 2]), float_pointer(operands[FIRST_RAY_OPERAND + 3])
    exclude, mask = int_pointer(operands[FIRST_RAY_OPERAND + 4]), int_pointer(operands[FIRST_RAY_OPERAND + 5])
    floats, ints = lane_floats(), lane_ints()
    for lane in range(LANES):
        row = max(rows[lane], 0)
        o, d = 3 * _index(counts, 0, env, row), 3 * _index(counts, 1, env, row)
        for axis in range(3):
            floats[axis * LANES + lane] = origin[o + axis]
            floats[(axis + 3) * LANES + lane] = direction[d + axis]
        floats[6 * LANES + lane] = t_min[_index(counts, 2, env, row)] if rows[lane] >= 0 else INF
        floats[7 * LANES + lane] = min(t_max[_index(counts, 3, env, row)], MISS)
        ints[lane], ints[LANES + lane] = exclude[_index(counts, 4, env, row)], mask[_index(counts, 5, env, row)]
    return Packet(
        load(floats, 0),
        load(floats, LANES),
        load(floats, 2 * LANES),
        load(floats, 3 * LANES),
        load(floats, 4 * LANES),
        load(floats, 5 * LANES),
        load(floats, 6 * LANES),
        load(floats, 7 * LANES),
        load(ints, 0),
        load(ints, LANES),
    )


@compiled
@no_type_check
def _index(counts, field, env, row):
    """Return the flat index of ray `row` of `env` in a field with `counts[field]` rows per environment, one or all."""
    return env * counts[field] + (row if counts[field] > 1 else 0)


@compiled
@no_type_check
def write_hits(results, first, rows, best):
    """Write hits of lanes to `first` (the environment's first ray) + `rows`; skip row -1. Misses get t = `MISS`."""
    t, instance, triangle = float_pointer(results[0]), int_pointer(results[1]), int_pointer(results[2])
    u, v, front = float_pointer(results[3]), float_pointer(results[4]), byte_pointer(results[5])
    floats, ints = lane_floats(), lane_ints()
    store(floats, 0, select(best.instance >= np.int32(0), best.t, MISS))
    store(floats, LANES, best.u)
    store(floats, 2 * LANES, best.v)
    store(floats, 3 * LANES, select(best.front, broadcast(ONE), ZERO))
    store(ints, 0, best.instance)
    store(ints, LANES, best.triangle)
    for lane in range(LANES):
        if rows[lane] >= 0:
            row = first + rows[lane]
            t[row], u[row], v[row] = floats[lane], floats[LANES + lane], floats[2 * LANES + lane]
            instance[row], triangle[row], front[row] = ints[lane], ints[LANES + lane], floats[3 * LANES + lane] > ZERO
