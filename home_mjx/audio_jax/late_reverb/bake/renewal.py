"""Renewal equation of portal states, solved bin by bin in Numba.

U = H + K U is the energy that cells receive from a state, including transfer through others. H is the energy that cells
receive from a state before the next one, and K the transfer between states; products are convolutions over time. Each
bin follows from earlier ones, and transfer within one bin from a few iterations. Few pairs of states exchange energy,
and most of them for a short time, so K is a list of pairs with their time ranges.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from functools import cache
from typing import Any, no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit, types

from home_mjx.core.native import ffi, memory, simd
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.core.native.simd import LANES, absolute, broadcast, load, multiply_add, select, store

SWEEPS = 6  # iterations of the transfer within one bin, which is small
UNROLLED = 4  # lags that are summed independently
ZERO, MIN_ENERGY = np.float32(0), np.float32(1e-25)  # smaller energies are zero: subnormal numbers are slow
floats = pointer_to(types.float32)
compiled = compile_inner()


def solve_renewal(
    source: Int[np.ndarray, " p"],
    target: Int[np.ndarray, " p"],
    transfer: Float[np.ndarray, "p k"],
    received: Float[np.ndarray, "g c k"],
    states: slice,
) -> Float[np.ndarray, "s c k"]:
    """Compute the energy over time that cells receive from some states, including transfer through others.

    Energies of at most 1e-25 in magnitude become 0.

    Args:
        source: States from which energy goes to another one, in ascending order.
        target: That state.
        transfer: Energy of each such pair over time.
        received: Energy that cells receive from each state before the next one.
        states: Indices of the states of the result.
    """
    count, cells, bins = received.shape
    padded = np.pad(received, ((0, 0), (0, -cells % LANES), (0, 0))).reshape(count, -1, LANES, bins)
    found = np.ascontiguousarray(np.moveaxis(padded, (0, 1, 2, 3), (1, 0, 3, 2)), np.float32)
    values = np.ascontiguousarray(transfer, np.float32)
    some = values != 0
    last = bins - np.argmax(some[:, ::-1], axis=1)
    pairs = np.stack([target, np.maximum(np.argmax(some, axis=1), 1), last], axis=1).astype(np.int64)
    _solve(found, np.searchsorted(source, np.arange(count + 1)), pairs, values)
    back = np.moveaxis(found[:, states], (0, 1, 2, 3), (1, 0, 3, 2))
    return back.reshape(back.shape[0], -1, bins)[:, :cells]


@verify_cache_once
@no_type_check
def _solve(found, ends, pairs, values):
    """Call the compiled `_solve_bins`; verifies Numba's disk cache once."""
    _compiled_solve()(found, ends, pairs, values)


@cache
def _compiled_solve() -> Any:
    """Return the compiled `solve`, from Numba's disk cache if it is there."""
    # Numba's cache checks this file and the values that a function closes over: the digest stands for other files.
    digest = ffi.hash_sources(ffi.__file__, memory.__file__, simd.__file__)

    @njit(error_model="numpy", nogil=True, cache=True)
    @no_type_check
    def solve(found, ends, pairs, values):
        """Add the transfer, see `_solve_bins`."""
        _ = digest
        _solve_bins(found, ends, pairs, values)

    return solve


@compiled
@no_type_check
def _solve_bins(found, ends, pairs, values):
    """Add the transfer to `found` in place, which holds the energy before the next state; return used scratch.

    Args:
        found: Energies (blocks, g, k, lanes). A block of cells at a time, recent bins stay in the processor's cache.
        ends: Range of rows of `pairs` for each state.
        pairs: Next state, first bin (at least 1) and one past the last bin of nonzero transfer to it.
        values: Transfer in each bin.
    """
    blocks, count, bins, _ = found.shape
    length, before = values.shape[1], np.empty((count, LANES), np.float32)
    energy, share, base = floats(found.ctypes.data), floats(values.ctypes.data), floats(before.ctypes.data)
    for block in range(blocks):
        for k in range(bins):
            for g in range(count):
                here = ((block * count + g) * bins + k) * LANES
                total = load(energy, here)
                for pair in range(ends[g], ends[g + 1]):
                    lag, last = pairs[pair, 1], min(pairs[pair, 2], k + 1)
                    past = ((block * count + pairs[pair, 0]) * bins + k - lag) * LANES
                    total = _add_lags(energy, past, share, pair * length + lag, last - lag, total)
                total = select(absolute(total) > MIN_ENERGY, total, ZERO)
                store(energy, here, total)
                store(base, g * LANES, total)
            for _ in range(SWEEPS):
                for g in range(count):
                    total = load(base, g * LANES)
                    for pair in range(ends[g], ends[g + 1]):
                        past = ((block * count + pairs[pair, 0]) * bins + k) * LANES
                        total = multiply_add(share[pair * length], load(energy, past), total)
                    store(energy, ((block * count + g) * bins + k) * LANES, total)
    return before


@compiled
@no_type_check
def _add_lags(energy, past, share, weight, count, a):
    """Return `a` plus `count` products of `share`, from `weight` on, and `energy`, from `past` one bin back each."""
    b, c, d = broadcast(ZERO), broadcast(ZERO), broadcast(ZERO)
    while count >= UNROLLED:
        a = multiply_add(share[weight], load(energy, past), a)
        b = multiply_add(share[weight + 1], load(energy, past - LANES), b)
        c = multiply_add(share[weight + 2], load(energy, past - 2 * LANES), c)
        d = multiply_add(share[weight + 3], load(energy, past - 3 * LANES), d)
        count, weight, past = count - UNROLLED, weight + UNROLLED, past - UNROLLED * LANES
    while count > 0:
        a = multiply_add(share[weight], load(energy, past), a)
        count, weight, past = count - 1, weight + 1, past - LANES
    return (a + b) + (c + d)
