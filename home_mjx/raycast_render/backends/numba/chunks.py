"""Ray casts in chunks of packets, as C functions for `core.native.handler`: no Python, no lock, no copies."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import numpy as np
from numba import cfunc, types

from home_mjx.core.native import ffi
from home_mjx.core.native import memory as native_memory
from home_mjx.core.native import simd as lanes
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.raycast_render.backends.numba import cutouts as native_cutouts
from home_mjx.raycast_render.backends.numba import intersect as native_intersect
from home_mjx.raycast_render.backends.numba import packet as native_packet
from home_mjx.raycast_render.backends.numba import traverse as native
from home_mjx.raycast_render.scene import types as scene_types

ANY_HIT, WIDTH = 0, 1  # indices of attributes, which are sorted by name
NUM_OPERANDS, NUM_RESULTS = 26, 6
# Operands whose shapes define the numbers of rows
NODE, TRIANGLE, MODEL, HOUSE, INSTANCE_MODEL, MATERIAL, CUTOUT, MOVING_INSTANCE = 1, 2, 4, 5, 6, 10, 12, 14
NUM_RAY_FIELDS = NUM_OPERANDS - native_packet.FIRST_RAY_OPERAND
CHUNK = 16  # packets per chunk of work

operand_words, result_words = stack_of(types.int64, NUM_OPERANDS), stack_of(types.int64, NUM_RESULTS)
ray_words = stack_of(types.int64, NUM_RAY_FIELDS)
compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Return the C functions `count` (chunks of a call) and `work` (of a job), compiled or from Numba's disk cache."""
    # The cache checks this file only. The functions refer to the digest, so that a change of the others invalidates it.
    parts: tuple[Any, ...] = (
        ffi,
        lanes,
        native,
        native_cutouts,
        native_intersect,
        native_memory,
        native_packet,
        scene_types,
    )
    digest = ffi.hash_sources(*(part.__file__ for part in parts))

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of chunks of a call, `CHUNK` packets each, the last maybe fewer."""
        _ = digest
        return -(-_num_packets(frame) // CHUNK)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Cast chunks of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _cast_chunk)
        return 0

    return count, work


@compiled
@no_type_check
def _cast_chunk(frame, chunk):
    """Cast the packets of the chunk with this index: `CHUNK`, or those that are left for the last."""
    operands, counts, results = operand_words(), ray_words(), result_words()
    for i in range(NUM_OPERANDS):
        operands[i] = ffi.data(frame, ffi.OPERANDS, i)
    for i in range(NUM_RAY_FIELDS):
        counts[i] = ffi.dim(frame, ffi.OPERANDS, native_packet.FIRST_RAY_OPERAND + i, 1)
    for i in range(NUM_RESULTS):
        results[i] = ffi.data(frame, ffi.RESULTS, i)
    sizes, tiles, any_hit = _sizes(frame), _tiling(frame), ffi.attribute(frame, ANY_HIT) != 0
    for packet in range(chunk * CHUNK, min((chunk + 1) * CHUNK, _num_packets(frame))):
        native.cast_packet(operands, counts, results, sizes, tiles, any_hit, packet)


@compiled
@no_type_check
def _sizes(frame):
    """Return the `RowCounts` of the operands' shapes."""
    return native_packet.RowCounts(
        ffi.dim(frame, ffi.OPERANDS, NODE, 0),
        ffi.dim(frame, ffi.OPERANDS, TRIANGLE, 0),
        ffi.dim(frame, ffi.OPERANDS, MODEL, 0),
        ffi.dim(frame, ffi.OPERANDS, HOUSE, 0),
        ffi.dim(frame, ffi.OPERANDS, MATERIAL, 0),
        ffi.dim(frame, ffi.OPERANDS, CUTOUT, 0),
        ffi.dim(frame, ffi.OPERANDS, CUTOUT, 1),
        ffi.dim(frame, ffi.OPERANDS, INSTANCE_MODEL, 1),
        ffi.dim(frame, ffi.OPERANDS, MOVING_INSTANCE, 1),
    )


@compiled
@no_type_check
def _num_packets(frame):
    """Return the number of packets of all environments."""
    return ffi.dim(frame, ffi.RESULTS, 0, 0) * _tiling(frame).packets


@compiled
@no_type_check
def _tiling(frame):
    """Return the `Tiling` of each environment's rays."""
    return native_packet.make_tiling(ffi.dim(frame, ffi.RESULTS, 0, 1), np.int64(ffi.attribute(frame, WIDTH)))
