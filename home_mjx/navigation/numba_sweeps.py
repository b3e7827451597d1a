"""Sweeps of distance fields on CPUs, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import numpy as np
from numba import cfunc

from home_mjx.core.native import ffi, memory
from home_mjx.core.native.ffi import float_result, float_row, int_row, operand_dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.core.native.numba_cache import verify_cache

START, STEP, MOVES = range(3)  # operands: a grid (ny, nx) for each field
STRAIGHT, RIGHT, LEFT, ALONG = 1, 2, 4, 8  # bits of `MOVES`, as the fields of `distance_fields._GridMoves`
DIAGONAL = np.float32(2**0.5)

compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk."""
    # Numba's cache checks this file only. The functions refer to the digest, so that a change of others invalidates it.
    digest = ffi.hash_sources(ffi.__file__, memory.__file__)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of fields."""
        _ = digest
        return operand_dim(frame, START, 0)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Compute fields of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _compute_field)
        return 0

    return count, work


@compiled
@no_type_check
def _compute_field(frame, field):
    """Sweep the rows of one field down and up until a round lowers no distance."""
    rows, columns = operand_dim(frame, START, 1), operand_dim(frame, START, 2)
    start, step, moves = float_row(frame, START, field), float_row(frame, STEP, field), int_row(frame, MOVES, field)
    found = float_result(frame, 0, field)
    for i in range(rows * columns):
        found[i] = start[i]
    is_lower = True
    while is_lower:
        is_lower = False
        for y in range(rows):
            is_lower = _relax_row(found, step, moves, y, -1, rows, columns) or is_lower
        for y in range(rows - 1, -1, -1):
            is_lower = _relax_row(found, step, moves, y, 1, rows, columns) or is_lower


@compiled
@no_type_check
def _relax_row(found, step, moves, y, side, rows, columns):
    """Lower the distances of row `y` from those of row `y + side`, then along the row; return whether one is lower.

    `side` is -1 or 1. Bits of a cell tell of moves to the row above it, so those to the row below are of its cells.
    """
    is_lower = False
    here, there = y * columns, (y + side) * columns
    if 0 <= y + side < rows:
        own = offset_pointer(moves, max(here, there))
        first, second = (RIGHT, LEFT) if side < 0 else (LEFT, RIGHT)
        for x in range(columns):
            best, length = found[here + x], step[here + x]
            if own[x] & STRAIGHT:
                best = min(best, found[there + x] + length)
            # A move of row y from column x - 1 is of cell x if it leads down, and of cell x - 1 if it leads up.
            if x > 0 and own[x if side < 0 else x - 1] & first:
                best = min(best, found[there + x - 1] + length * DIAGONAL)
            if x + 1 < columns and own[x if side < 0 else x + 1] & second:
                best = min(best, found[there + x + 1] + length * DIAGONAL)
            if best < found[here + x]:
                found[here + x] = best
                is_lower = True
    own, known, length = offset_pointer(moves, here), offset_pointer(found, here), offset_pointer(step, here)
    for x in range(1, columns):
        if own[x] & ALONG and known[x - 1] + length[x] < known[x]:
            known[x] = known[x - 1] + length[x]
            is_lower = True
    for x in range(columns - 2, -1, -1):
        if own[x + 1] & ALONG and known[x + 1] + length[x] < known[x]:
            known[x] = known[x + 1] + length[x]
            is_lower = True
    return is_lower
