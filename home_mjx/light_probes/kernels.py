"""Compiled loops of the bake: ray casts, and one pass of reflected light."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import njit, types

from home_mjx.core.native import ffi, memory, simd
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.raycast_render.backends.numba import cutouts, intersect, packet, traverse
from home_mjx.raycast_render.backends.numba.packet import RowCounts, make_tiling
from home_mjx.raycast_render.backends.numba.traverse import cast_packet

CAST_MODULES: tuple[Any, ...] = ffi, memory, simd, cutouts, intersect, packet, traverse  # that compile into a cast
LANES = 3  # colour channels of a light group
INVERSE_PI = np.float32(1 / np.pi)
PI, ZERO, ONE = np.float32(np.pi), np.float32(0), np.float32(1)
TINY = np.float32(1e-12)

words = pointer_to(types.int64)


class Kernels(NamedTuple):
    """Compiled functions; see those of the same names below."""

    cast: Callable[..., None]
    reflect: Callable[..., None]
    gather: Callable[..., None]


@functools.cache
@verify_cache
def compile_kernels() -> Kernels:
    """Return the compiled functions, from Numba's disk cache if they are there."""
    # Numba's cache checks this file and the values that a function closes over: the digest stands for other files.
    digest = ffi.hash_sources(*(part.__file__ for part in CAST_MODULES))
    sizes = types.NamedUniTuple(types.int64, len(RowCounts._fields), RowCounts)

    @no_type_check
    def cast(operands, counts, results, sizes, count, any_hit):
        """Cast `count` rays; the first three are addresses of the arrays that `cast_packet` takes."""
        _ = digest
        tiles = make_tiling(count, 0)
        for number in range(tiles.packets):
            cast_packet(words(operands), words(counts), words(results), sizes, tiles, any_hit, number)

    word, flag, real, number = types.int64, types.boolean, types.float32, types.int64
    options: dict[str, Any] = {"error_model": "numpy", "nogil": True, "cache": True}
    surfaces = real[:, :, ::1], number[::1], real[:, ::1], number[:, ::1], real[:, ::1], number[::1], real[:, ::1]
    made = njit(types.void(word, word, word, sizes, word, flag), **options)(cast)
    options["fastmath"] = True
    return Kernels(
        made,
        njit(types.void(*surfaces, real[:, ::1], real[:, ::1], real[::1], real[:, :, ::1]), **options)(reflect),
        njit(types.void(*surfaces, real[:, ::1], real[::1], number[::1], real[:, ::1], real[:, ::1]), **options)(
            gather
        ),
    )


@no_type_check
def reflect(light, cell, fraction, stride, normal, place, known, albedo, way, shared, out):
    """Write to `out` (probes, 6, lanes) the irradiance by surfaces around probes, given that of all probes.

    `light` (all probes, 6, lanes) has the irradiance on faces +x, -x, +y, -y, +z and -z. Other arrays have a row per
    ray, probe by probe: the first of the eight probes around its hit (-1 none), fractions to the next ones, their
    strides along x and y, normal, row of `known` (rows, lanes), which has the hit's irradiance (-1: that of the probes
    counts), reflectance, the ray's direction, and the argument of `change_room`.
    """
    lanes, rays = light.shape[2], len(cell) // len(out)
    sent, total = np.empty(lanes, np.float32), np.empty(6, np.float32)
    for p in range(len(out)):
        out[p] = ZERO
        total[:] = ZERO
        for i in range(p * rays, (p + 1) * rays):
            if cell[i] >= 0:
                receive(light, cell[i], fraction[i], stride[i], normal[i], place[i], known, sent)
                for j in range(lanes):
                    sent[j] *= albedo[i, j % LANES] * INVERSE_PI
                change_room(sent, shared[i])
            for axis in range(3):
                face = 2 * axis + (way[i, axis] < ZERO)
                cosine = abs(way[i, axis])
                total[face] += cosine
                if cell[i] >= 0:
                    for j in range(lanes):
                        out[p, face, j] += cosine * sent[j]
        for face in range(6):
            for j in range(lanes):
                out[p, face, j] *= PI / max(total[face], TINY)


@no_type_check
def gather(light, cell, fraction, stride, normal, place, known, albedo, shared, row, direct, out):
    """Write to `out` (points, lanes) the irradiance at points by surfaces that their rays hit.

    Rays follow each other point by point and are distributed by the cosine. Arguments as of `reflect`, and `direct`
    (rows, lanes), the direct light of hits, with the `row` of each; that of rays without a hit is dark.
    """
    lanes, rays = light.shape[2], len(cell) // len(out)
    sent = np.empty(lanes, np.float32)
    for p in range(len(out)):
        out[p] = ZERO
        for i in range(p * rays, (p + 1) * rays):
            if cell[i] >= 0:
                receive(light, cell[i], fraction[i], stride[i], normal[i], place[i], known, sent)
            else:
                sent[:] = ZERO
            for j in range(lanes):
                sent[j] = (sent[j] + direct[row[i], j]) * albedo[i, j % LANES]
            change_room(sent, shared[i])
            for j in range(lanes):
                out[p, j] += sent[j]
        for j in range(lanes):
            out[p, j] /= np.float32(rays)


@compile_inner()
@no_type_check
def change_room(sent, shared):
    """Exchange light of the room's own lamps and of other rooms' lamps, the first groups of `sent`, on the way out.

    `shared` is the part of the latter that comes from lamps of the room where it arrives; negative within one room.
    """
    if shared >= ZERO:
        for j in range(LANES):
            own, others = sent[j], sent[LANES + j]
            sent[j] = shared * others
            sent[LANES + j] = own + (ONE - shared) * others


@compile_inner()
@no_type_check
def receive(light, cell, fraction, stride, normal, place, known, sent):
    """Write to `sent` (lanes) row `place` of `known`, or else the irradiance between the probes from `cell` on."""
    if place >= 0:
        sent[:] = known[place]
    else:
        interpolate(light, cell, fraction, stride, normal, sent)


@compile_inner()
@no_type_check
def interpolate(light, cell, fraction, stride, normal, sent):
    """Write to `sent` (lanes) the irradiance on a unit normal between the eight probes from `cell` on.

    It is the mean of three faces, weighted by squares of the normal's components.
    """
    for j in range(len(sent)):
        sent[j] = ZERO
    for corner in range(8):
        x, y, z = corner & 1, corner >> 1 & 1, corner >> 2
        weight = fraction[0] if x else ONE - fraction[0]
        weight *= fraction[1] if y else ONE - fraction[1]
        weight *= fraction[2] if z else ONE - fraction[2]
        row = cell + x * stride[0] + y * stride[1] + z
        for axis in range(3):
            face = 2 * axis + (normal[axis] < ZERO)
            share = weight * normal[axis] * normal[axis]
            for j in range(len(sent)):
                sent[j] += share * light[row, face, j]
