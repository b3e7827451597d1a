"""Sums over time of the energy between cells, in Numba: before portal states, and through them by convolution.

Only sums are stored: five time spans per pair of cells, and the decay per pair of rooms. The sum of a convolution up to
some time is a product of the emission and the cumulative energy after the portal state. Decays count from the first
possible arrival, so the emissions of all cells of a room are added first, each advanced by its own arrival.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from concurrent.futures import ThreadPoolExecutor
from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from home_mjx.audio_jax.late_reverb.lookup.time_grid import SPAN_STARTS
from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.core.workers import usable_cores

compiled = njit(error_model="numpy", nogil=True, cache=True)


def sum_pairs(
    own: Float[np.ndarray, "n n u b"],
    emitted: Float[np.ndarray, "b n g t"],
    after: Float[np.ndarray, "b g n k"],
    arrival: Int[np.ndarray, "n n"],
    room: Int[np.ndarray, " n"],
) -> tuple[Float[np.ndarray, "n n spans b"], Float[np.ndarray, "r r b k"]]:
    """Sum energies, shifted to the first possible arrival, over spans per pair of cells and over pairs of rooms.

    Energy that is earlier than the first possible arrival counts to that bin.

    Args:
        own: Energy from cells (first axis) to cells before any portal state, per bin.
        emitted: Energy from cells into portal states, per bin.
        after: Energy that cells receive from portal states, per bin since their emission.
        arrival: Bin of the first possible arrival from cell (row) to cell.
        room: Room of each cell.
    """
    count, bins = len(room), after.shape[3]
    starts, rooms = np.array([*SPAN_STARTS[1:], bins]), int(room.max()) + 1

    def run(target: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the sums to one cell."""
        mine = np.ascontiguousarray(own[:, target], np.float32)
        later = np.ascontiguousarray(after[:, :, target], np.float32)
        return _sum_target(mine, emitted, later, arrival[:, target], room, starts, rooms)

    emitted, arrival = np.ascontiguousarray(emitted, np.float32), np.minimum(arrival, bins)
    shape = np.zeros((rooms, rooms, after.shape[0], bins))
    pair = np.zeros((count, count, len(SPAN_STARTS), after.shape[0]))
    run(0)  # compiles, or loads the compiled code
    with ThreadPoolExecutor(usable_cores()) as pool:
        for target, (spans, decay) in enumerate(pool.map(run, range(count))):
            pair[:, target] = spans
            shape[:, room[target]] += decay
    return pair, shape


@verify_cache_once
@no_type_check
def _sum_target(own, emitted, after, arrival, room, ends, rooms):
    """Call `_sum_to_cell`; verifies Numba's disk cache once."""
    return _sum_to_cell(own, emitted, after, arrival, room, ends, rooms)


@compiled
@no_type_check
def _sum_to_cell(own, emitted, after, arrival, room, ends, rooms):
    """Return the spans (n, spans, b) of all cells to one cell, and the decays (rooms, b, k) from rooms.

    Both count time from `arrival` (n), the bin of the first possible arrival. `own` is energy before any
    portal state, `emitted` that into states, `after` that received from them; see `sum_pairs`.
    """
    bands, states, bins = after.shape
    count, late, most = len(own), emitted.shape[3], np.max(arrival)
    spans, decay = np.zeros((count, len(ends), bands)), np.zeros((rooms, bands, bins))
    total, moved = np.empty(bins + 1), np.empty(late + most)
    for b in range(bands):
        for i in range(count):
            _add_own(own, i, b, arrival[i], ends, spans, decay[room[i], b])
        for g in range(states):
            total[0] = 0.0
            for k in range(bins):
                total[k + 1] = total[k] + after[b, g, k]
            if total[bins] == 0.0:
                continue
            for source_room in range(rooms):
                moved[:] = 0.0
                for i in range(count):
                    if room[i] == source_room:
                        _add_emission(emitted[b, i, g], total, arrival[i], most, ends, spans[i, :, b], moved)
                _convolve(moved, most, after[b, g], total, decay[source_room, b])
    return spans, decay


@compiled
@no_type_check
def _add_own(own, i, b, arrival, ends, spans, decay):
    """Add energies `own[i, :, b]` to the spans and the decay of cell `i`, by bin after its first possible arrival.

    `ends` has the end of each span [bins]. Earlier energy counts to bin 0.
    """
    span = 0
    for k in range(own.shape[1]):
        since = max(k - arrival, 0)
        while since >= ends[span]:
            span += 1
        spans[i, span, b] += own[i, k, b]
        decay[since] += own[i, k, b]


@compiled
@no_type_check
def _add_emission(emitted, total, arrival, most, ends, spans, moved):
    """Add the energy of one cell through one state to its spans, and its emission to `moved`, from bin -`most` on.

    `total` is the cumulative energy after the state, from 0 on. Spans end `ends` bins after `arrival`, the last one
    with `total`.
    """
    bins = len(total) - 1
    for k in range(len(emitted)):
        sent = emitted[k]
        if sent != 0.0:
            moved[k - arrival + most] += sent
            before = 0.0
            for span in range(len(ends)):
                end = bins if span == len(ends) - 1 else min(ends[span] + arrival, bins)
                until = total[max(end - k, 0)]
                spans[span] += sent * (until - before)
                before = until


@compiled
@no_type_check
def _convolve(moved, most, after, total, decay):
    """Add the convolution of emission `moved`, from bin -`most` on, with `after` to `decay`; earlier energy: bin 0.

    `total` is the cumulative sum of `after`, from 0 on. Energy beyond the last bin is dropped.
    """
    bins = len(after)
    for k in range(len(moved)):
        sent, shift = moved[k], k - most
        if sent == 0.0:
            continue
        if shift < 0:
            decay[0] += sent * total[min(-shift, bins)]
        for at in range(max(shift, 0), min(bins + shift, bins)):
            decay[at] += sent * after[at - shift]
