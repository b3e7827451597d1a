"""Energy decay in coupled rooms on CPUs, as C functions for `core.native.handler`.

The algorithm is that of `coupled_decay.cu`, on the first rooms of a house only. A vector holds one element of `LANES`
matrices: octaves and door states of one environment are computed side by side.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import numpy as np
from numba import cfunc, types

from home_mjx.audio_jax.late_reverb.lookup import room_matrices
from home_mjx.audio_jax.late_reverb.lookup.room_matrices import HALVINGS, MAX_STACK_ROOMS, SERIES_TERMS
from home_mjx.core.native import ffi, memory, simd
from home_mjx.core.native.ffi import float_result, float_row, int_row, operand_dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.core.native.simd import LANES, broadcast, load, multiply_add, store

RATES, START, LISTENER, COUNT = range(4)  # operands, with a leading axis of environments
DOUBLINGS = 3  # as in coupled_decay.cu
RUN = 1 << DOUBLINGS
BLOCK = 4  # columns of a product that are summed at once
ZERO, ONE = np.float32(0), np.float32(1)

matrix_memory = stack_of(types.float32, MAX_STACK_ROOMS * MAX_STACK_ROOMS * LANES)
row_memory = stack_of(types.float32, MAX_STACK_ROOMS * LANES)
rows_memory = stack_of(types.float32, RUN * MAX_STACK_ROOMS * LANES)
compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk."""
    # Numba's cache checks this file only. The functions refer to the digest, so that a change of others invalidates it.
    digest = ffi.hash_sources(ffi.__file__, memory.__file__, simd.__file__, room_matrices.__file__)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of environments."""
        _ = digest
        return operand_dim(frame, RATES, 0)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Compute environments of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _compute_decay)
        return 0

    return count, work


@compiled
@no_type_check
def _compute_decay(frame, env):
    """Compute the energies of one environment, `LANES` matrices at a time."""
    states, octaves, rooms = (operand_dim(frame, RATES, 1), operand_dim(frame, RATES, 2), operand_dim(frame, RATES, 3))
    size = max(min(np.int64(int_row(frame, COUNT, env)[0]), rooms), np.int64(1))
    matrix, other, row, rows = matrix_memory(), matrix_memory(), row_memory(), rows_memory()
    for first in range(0, states * octaves, LANES):
        count = min(LANES, states * octaves - first)
        _read_rates(frame, env, first, count, size, rooms, matrix, other)
        _exponentiate(matrix, other, row, size)
        _write_energies(frame, env, first, count, size, octaves, matrix, other, row, rows)


@compiled
@no_type_check
def _read_rates(frame, env, first, count, size, rooms, matrix, other):
    """Write matrices from number `first` on, times the step of the series, to `matrix` and `other`; unused lanes 0."""
    rates = float_row(frame, RATES, env)
    scale = np.float32(-1.0 / (1 << HALVINGS))
    for i in range(size):
        for k in range(size):
            at = (i * size + k) * LANES
            for lane in range(LANES):
                value = rates[((first + lane) * rooms + i) * rooms + k] * scale if lane < count else ZERO
                matrix[at + lane] = value
                other[at + lane] = value


@compiled
@no_type_check
def _exponentiate(matrix, other, row, size):
    """Replace `matrix`, equal to `other`, by its exponential to the power of 2**`HALVINGS`: the step of one bin."""
    for i in range(size):
        for k in range(size):
            at = (i * size + k) * LANES
            value = load(matrix, at) * np.float32(1.0 / (SERIES_TERMS - 1))
            store(matrix, at, value + ONE if i == k else value)
    for term in range(SERIES_TERMS - 2, 0, -1):
        _multiply(matrix, other, row, size, ONE, np.float32(1.0 / term))
    for _ in range(HALVINGS):
        _square(matrix, other, row, size)


@compiled
@no_type_check
def _square(matrix, other, row, size):
    """Replace `matrix` by its square; `other` becomes a copy of it before."""
    for i in range(size * size * LANES):
        other[i] = matrix[i]
    _multiply(matrix, other, row, size, ZERO, ONE)


@compiled
@no_type_check
def _multiply(matrix, other, row, size, unit, scale):
    """Replace `matrix` by `unit` times the identity plus `scale` times its product with `other`, row by row."""
    whole = size - size % BLOCK
    for i in range(size):
        here = i * size * LANES
        for j in range(0, whole, BLOCK):
            a, b, c, d = broadcast(ZERO), broadcast(ZERO), broadcast(ZERO), broadcast(ZERO)
            for k in range(size):
                value, at = load(matrix, here + k * LANES), (k * size + j) * LANES
                a = multiply_add(value, load(other, at), a)
                b = multiply_add(value, load(other, at + LANES), b)
                c = multiply_add(value, load(other, at + 2 * LANES), c)
                d = multiply_add(value, load(other, at + 3 * LANES), d)
            store(row, j * LANES, a)
            store(row, (j + 1) * LANES, b)
            store(row, (j + 2) * LANES, c)
            store(row, (j + 3) * LANES, d)
        for j in range(whole, size):
            a = broadcast(ZERO)
            for k in range(size):
                a = multiply_add(load(matrix, here + k * LANES), load(other, (k * size + j) * LANES), a)
            store(row, j * LANES, a)
        for j in range(size):
            value = load(row, j * LANES) * scale
            store(matrix, here + j * LANES, value + unit if i == j else value)


@compiled
@no_type_check
def _write_energies(frame, env, first, count, size, octaves, matrix, other, row, rows):
    """Write the energies at the listener after 0, 1, ... bins, from `matrix`, the step of one bin.

    The energy after a `RUN` + b bins is the product of a row, the listener propagated by b bins, and a column, the
    start propagated by a `RUN` bins.
    """
    bins = ffi.dim(frame, ffi.RESULTS, 0, 2)
    start, listener = float_row(frame, START, env), float_row(frame, LISTENER, env)
    for k in range(size):
        store(rows, k * LANES, broadcast(listener[k]))
    for b in range(1, RUN):
        before, here = (b - 1) * size * LANES, b * size * LANES
        for j in range(size):
            a = broadcast(ZERO)
            for k in range(size):
                a = multiply_add(load(rows, before + k * LANES), load(matrix, (k * size + j) * LANES), a)
            store(rows, here + j * LANES, a)
    for _ in range(DOUBLINGS):
        _square(matrix, other, row, size)
    for k in range(size):
        store(other, k * LANES, broadcast(start[k]))  # the column; `other` is not needed any more
    energies, sums = float_result(frame, 0, env), row
    for begin in range(0, bins, RUN):
        for b in range(min(RUN, bins - begin)):
            a = broadcast(ZERO)
            for k in range(size):
                a = multiply_add(load(rows, (b * size + k) * LANES), load(other, k * LANES), a)
            store(sums, 0, a)
            for lane in range(count):
                number = first + lane
                energies[((number // octaves) * bins + begin + b) * octaves + number % octaves] = sums[lane]
        for i in range(size):
            a = broadcast(ZERO)
            for k in range(size):
                a = multiply_add(load(matrix, (i * size + k) * LANES), load(other, k * LANES), a)
            store(sums, i * LANES, a)
        for i in range(size):
            store(other, i * LANES, load(sums, i * LANES))
