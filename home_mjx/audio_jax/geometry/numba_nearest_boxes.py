"""Boxes nearest to the line from source to listener on CPUs, as C functions for `core.native.handler`.

The algorithm is that of `box_lengths.py`, for `LANES` boxes side by side. Boxes without exposed edges, most of the
padded ones, are skipped.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import cfunc, types

from home_mjx.audio_jax.geometry import box_lengths
from home_mjx.audio_jax.geometry.box_lengths import (
    MAX_STACK_RESULTS,
    MIN_LINE_LENGTH,
    NUM_FIELDS,
    NUM_PROJECTIONS,
    WITHOUT_EDGES,
)
from home_mjx.core.native import ffi, memory, simd
from home_mjx.core.native.ffi import float_row, int_result, int_row, operand_dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.core.native.simd import LANES, load, maximum, minimum, store

# Operands; those from `HOUSE` on have a leading axis of environments.
FIXED, FIXED_OWNER, HOUSE, MOVING, MOVING_OWNER, ENDS, BODIES = range(7)
MIN_SQUARE, INF = np.float32(MIN_LINE_LENGTH**2), np.float32(np.inf)
ZERO, ONE = np.float32(0), np.float32(1)

field_memory, square_memory = stack_of(types.float32, NUM_FIELDS * LANES), stack_of(types.float32, 2 * LANES)
length_memory = stack_of(types.float32, MAX_STACK_RESULTS)
compiled = compile_inner()


class Best(NamedTuple):
    """The best boxes so far, shortest first."""

    length: Any  # pointer to float32, [m]; inf where there is none yet
    index: Any  # pointer to int32
    count: np.int64


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk."""
    # Numba's cache checks this file only. The functions refer to the digest, so that a change of others invalidates it.
    digest = ffi.hash_sources(ffi.__file__, memory.__file__, simd.__file__, box_lengths.__file__)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of environments."""
        _ = digest
        return operand_dim(frame, HOUSE, 0)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Compute environments of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _find_nearest)
        return 0

    return count, work


@compiled
@no_type_check
def _find_nearest(frame, env):
    """Write the nearest boxes of one environment, those that do not count last, by their index."""
    num_fixed, num_moving = operand_dim(frame, FIXED_OWNER, 1), operand_dim(frame, MOVING_OWNER, 1)
    houses = operand_dim(frame, FIXED_OWNER, 0)
    house = min(max(np.int64(int_row(frame, HOUSE, env)[0]), np.int64(0)), houses - 1)
    fixed, owner = float_row(frame, FIXED, house), int_row(frame, FIXED_OWNER, house)
    moving, moving_owner = float_row(frame, MOVING, env), int_row(frame, MOVING_OWNER, env)
    ends, bodies = float_row(frame, ENDS, env), int_row(frame, BODIES, env)
    best = Best(length_memory(), int_result(frame, 0, env), ffi.dim(frame, ffi.RESULTS, 0, 1))
    for i in range(best.count):
        best.length[i] = INF
    _add_boxes(best, fixed, owner, num_fixed, 0, ends, bodies)
    _add_boxes(best, moving, moving_owner, num_moving, num_fixed, ends, bodies)
    place = 0
    while place < best.count and best.length[place] < INF:
        place += 1
    for i in range(num_fixed + num_moving):
        own = owner[i] if i < num_fixed else moving_owner[i - num_fixed]
        if place < best.count and not _counts(own, bodies):
            best.index[place] = i
            place += 1


@compiled
@no_type_check
def _counts(owner, bodies):
    """Return whether a box of an owner counts: it has exposed edges, and is not of one of the two bodies."""
    return owner > WITHOUT_EDGES and (owner < 0 or (owner != bodies[0] and owner != bodies[1]))


@compiled
@no_type_check
def _add_boxes(best, boxes, owner, num_boxes, first, ends, bodies):
    """Insert the boxes (`NUM_FIELDS`, `num_boxes`) that count into the best ones; their indices begin at `first`."""
    fields, squares = field_memory(), square_memory()
    for begin in range(0, num_boxes, LANES):
        count, has_any = min(LANES, num_boxes - begin), False
        for lane in range(count):
            has_any = has_any or _counts(owner[begin + lane], bodies)
        if not has_any:
            continue
        for field in range(NUM_FIELDS):
            for lane in range(LANES):
                at = field * num_boxes + begin + lane
                fields[field * LANES + lane] = boxes[at] if lane < count else ZERO
        _square_distances(fields, ends, squares)
        for lane in range(count):
            if _counts(owner[begin + lane], bodies):
                length = np.sqrt(squares[lane]) + np.sqrt(squares[LANES + lane])
                if length < best.length[best.count - 1]:
                    _insert(best, length, np.int32(first + begin + lane))


@compiled
@no_type_check
def _insert(best, length, index):
    """Insert a box before all longer ones, and drop the last."""
    place = best.count - 1
    while place > 0 and best.length[place - 1] > length:
        best.length[place], best.index[place] = best.length[place - 1], best.index[place - 1]
        place -= 1
    best.length[place], best.index[place] = length, index


@compiled
@no_type_check
def _square_distances(fields, ends, squares):
    """Write the squared distances [m^2] of each box's point from source and listener, see `path_lengths`."""
    way_x, way_y, way_z = ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]
    square = max(way_x * way_x + way_y * way_y + way_z * way_z, MIN_SQUARE)
    x, y, z = load(fields, 0), load(fields, LANES), load(fields, 2 * LANES)
    at_x, at_y, at_z = x, y, z
    for _ in range(NUM_PROJECTIONS):
        share = ((at_x - ends[0]) * way_x + (at_y - ends[1]) * way_y + (at_z - ends[2]) * way_z) / square
        share = minimum(maximum(share, ZERO), ONE)
        off_x, off_y, off_z = share * way_x + ends[0] - x, share * way_y + ends[1] - y, share * way_z + ends[2] - z
        at_x, at_y, at_z = x, y, z
        for axis in range(3):
            row = (3 + 3 * axis) * LANES
            one, two, three = load(fields, row), load(fields, row + LANES), load(fields, row + 2 * LANES)
            half = load(fields, (12 + axis) * LANES)
            local = one * off_x + two * off_y + three * off_z
            local = minimum(maximum(local, ZERO - half), half)
            at_x, at_y, at_z = at_x + one * local, at_y + two * local, at_z + three * local
    for end in range(2):
        x, y, z = at_x - ends[3 * end], at_y - ends[3 * end + 1], at_z - ends[3 * end + 2]
        store(squares, end * LANES, x * x + y * y + z * z)
