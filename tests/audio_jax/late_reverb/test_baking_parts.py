"""Cells, tallies and spans, on data made by hand."""

from itertools import pairwise

import jax.numpy as jnp
import numpy as np
import pytest
from acoustic_rooms import coupled
from handmade import shoebox

from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator, factor_hidden_pairs, smooth_octaves, weigh_cells
from home_mjx.audio_jax.late_reverb.bake.pair_sums import sum_pairs
from home_mjx.audio_jax.late_reverb.lookup.lookup import _delay
from home_mjx.audio_jax.late_reverb.lookup.time_grid import (
    FINE_BINS,
    KNOT_BINS,
    NUM_BINS,
    SPAN_STARTS,
    fit_knots,
    knot_weights,
    span_index,
)
from home_mjx.audio_jax.late_reverb.trace.cells import CELL_CEILING_GAP, CELL_FLOOR_GAP, MAX_CELLS, divide_rooms


def test_cells_fill_the_rooms():
    cells = divide_rooms(shoebox((6.0, 5.0, 3.0)), 1.0)
    assert len(cells.room) == 30
    height = 3.0 - CELL_FLOOR_GAP - CELL_CEILING_GAP
    assert cells.volume.sum() == pytest.approx(30 * height, rel=0.05)
    np.testing.assert_allclose(cells.volume, height, rtol=0.15)
    assert np.array_equal(np.unique(cells.lookup[cells.lookup >= 0]), np.arange(30))


def test_no_cell_lies_in_two_rooms_and_there_are_never_too_many():
    cells = divide_rooms(coupled().house, 1.0)
    assert set(cells.room[cells.center[:, 0] < 6]) == {0}
    assert set(cells.room[cells.center[:, 0] > 6]) == {1}
    assert len(divide_rooms(shoebox((12.0, 12.0, 3.0)), 0.4).room) <= MAX_CELLS


def exponentials(rates: np.ndarray, flown: int, bins: int = 400) -> Accumulator:
    """A tally of one room of four cells that hear a decay per octave, only as long as rays flew."""
    tally = Accumulator(np.zeros(4, int), np.zeros((4, 4)), len(rates), bins, 1.0)
    decay = np.exp(-rates * np.arange(bins)[:, None]) * (np.arange(bins) < flown)[:, None]
    add(tally, np.tile(decay, (4, 4, 1, 1)), float(flown))
    return tally


def add(tally: Accumulator, own: np.ndarray, flown: float) -> None:
    """Decays (n, n, bins, octaves) without any gate."""
    count, bins, octaves = own.shape[1:]
    tally.add(own, np.zeros((octaves, count, 0, 1)), np.zeros((octaves, 0, count, bins)), flown)


def test_a_decay_goes_on_beyond_the_traced_time():
    rates = np.array([0.02, 0.05])
    level, shape = exponentials(rates, flown=150).finish()
    assert level.shape == (4, 4, len(SPAN_STARTS), 2)
    spans = [*SPAN_STARTS, 400]
    for band, rate in enumerate(rates):
        exact = [np.exp(-rate * np.arange(a, b)).sum() for a, b in pairwise(spans)]
        np.testing.assert_allclose(np.exp(level[0, 3, :, band]), exact, rtol=0.01)
        late = shape[0, 0, band, SPAN_STARTS[-1] :]
        np.testing.assert_allclose(late, np.exp(-rate * np.arange(SPAN_STARTS[-1], 400)) / exact[-1], rtol=0.01)


def test_a_late_slope_is_as_loud_as_between_its_own_cells():
    """Of a room beside one that decays slowly: cells at its door hear twice as much of that as those far away.

    When all that is later than 56 ms was one span the slow slope was as loud everywhere: 1.9 dB off here, and in
    coupled rooms T30 was 4 to 10 % long.
    """
    time, near = np.arange(NUM_BINS), np.array([1.0, 1.0, 2.0, 2.0])
    decay = np.exp(-0.22 * time) + 0.003 * np.outer(near, near)[:, :, None] * np.exp(-0.045 * time)
    tally = Accumulator(np.zeros(4, int), np.zeros((4, 4)), 1, NUM_BINS, 1.0)
    add(tally, decay[..., None], float(NUM_BINS))
    level, shape = tally.finish()
    read = np.exp(level[..., span_index(NUM_BINS), 0]) * shape[0, 0, 0]
    late = slice(2 * FINE_BINS, 200)
    error = 10 * np.log10(read[..., late].sum(axis=2) / decay[..., late].sum(axis=2))
    np.testing.assert_allclose(error, 0, atol=0.5)


def test_each_span_of_a_shape_holds_one():
    _, shape = exponentials(np.array([0.03]), flown=200).finish()
    np.testing.assert_allclose(np.add.reduceat(shape[0, 0, 0], SPAN_STARTS), 1, rtol=1e-6)


def test_knots_give_back_two_slopes():
    """A bend at -20 dB: between knots within 0.2 dB, and every span holds 1."""
    time = np.arange(NUM_BINS)
    decay = np.exp(-0.06 * time) + 0.01 * np.exp(-0.012 * time)
    spans = np.add.reduceat(decay, SPAN_STARTS)
    decay /= np.repeat(spans, np.diff([*SPAN_STARTS, NUM_BINS]))
    read = np.exp(knot_weights(NUM_BINS) @ fit_knots(decay))
    np.testing.assert_allclose(np.add.reduceat(read, SPAN_STARTS), 1, rtol=1e-6)
    np.testing.assert_allclose(10 * np.log10(read / decay)[FINE_BINS:], 0, atol=0.2)
    assert len(KNOT_BINS) < 48


def test_the_last_slope_goes_on_after_the_last_knot():
    read = np.exp(knot_weights(700) @ fit_knots(np.exp(-0.02 * np.arange(NUM_BINS))))
    np.testing.assert_allclose(read[650] / read[550], np.exp(-2), rtol=0.03)


def test_arrivals_count_from_the_first_possible_one():
    """What comes 30 bins late between cells 30 bins apart is in the first span."""
    tally = Accumulator(np.zeros(2, int), np.array([[0.0, 30.0], [30.0, 0.0]]), 1, 100, 1.0)
    heard = np.zeros((2, 2, 100, 1))
    heard[0, 1, 31] = 5.0
    add(tally, heard, 100.0)
    assert tally.pair[0, 1].ravel().tolist() == [5, 0, 0, 0, 0]


def test_sums_are_those_of_convolutions():
    """Over spans and pairs of rooms, counted from arrivals; what is too early counts to the first bin."""
    rng = np.random.default_rng(0)
    cells, gates, bins, room = 5, 3, 60, np.array([0, 0, 1, 1, 1])
    own, after = rng.random((cells, cells, 20, 2)), rng.random((2, gates, cells, bins))
    emitted = rng.random((2, cells, gates, 12)) * (rng.random((2, cells, gates, 12)) < 0.5)
    arrival = rng.integers(0, 9, (cells, cells))
    pair, shape = sum_pairs(own, emitted, after, arrival, room)
    whole = np.zeros((cells, cells, bins, 2))
    whole[:, :, :20] = own
    for lag in range(12):
        whole[:, :, lag:] += np.einsum("big,bgjk->ijkb", emitted[..., lag], after[..., : bins - lag])
    exact = np.zeros((2, 2, 2, bins))
    for i, j in np.ndindex(cells, cells):
        since = np.maximum(np.arange(bins) - arrival[i, j], 0)
        decay = np.stack([np.bincount(since, whole[i, j, :, b], bins) for b in range(2)])
        exact[room[i], room[j]] += decay
        np.testing.assert_allclose(pair[i, j], np.add.reduceat(decay, SPAN_STARTS, axis=1).T, rtol=1e-5)
    known = slice(bins - arrival.max())  # later decays are extrapolated
    np.testing.assert_allclose(shape[..., known], exact[..., known], rtol=1e-5)


def test_rooms_apart_are_smoothed_without_losing_energy():
    """Noise of a block of equal factors falls; its sum stays, and blocks in view stay as they are."""
    rng = np.random.default_rng(0)
    room = np.repeat([0, 1], 10)
    exact = np.outer(rng.uniform(1, 2, 20), np.ones(20))
    exact = (exact * exact.T)[:, :, None, None]
    noisy = exact * rng.exponential(size=exact.shape)
    noisy = (noisy + noisy.swapaxes(0, 1)) / 2
    seen = room[:, None] == room[None]
    out = factor_hidden_pairs(noisy, room, seen)
    far = np.ix_(room == 0, room == 1)
    assert np.array_equal(out[:10, :10], noisy[:10, :10])
    np.testing.assert_allclose(out[far].sum(), noisy[far].sum(), rtol=1e-9)
    assert np.std(out[far] / exact[far]) < 0.6 * np.std(noisy[far] / exact[far])
    np.testing.assert_allclose(out, out.swapaxes(0, 1))
    assert np.array_equal(factor_hidden_pairs(noisy, room, np.ones((20, 20), bool)), noisy)


def test_octaves_share_the_pattern_of_cells_and_keep_the_energy_of_rooms():
    """Noise falls where the pattern is the same; a room pair's energy in each octave is what it was."""
    rng = np.random.default_rng(1)
    room = np.repeat([0, 1], 8)
    pattern = rng.uniform(0.5, 2, (16, 16, 1, 1)) * np.array([1.0, 2.0, 5.0, 9.0])
    noisy = pattern * rng.gamma(5, 0.2, pattern.shape)
    out = smooth_octaves(noisy, room)
    for block in (np.ix_(room == 0, room == 0), np.ix_(room == 0, room == 1)):
        np.testing.assert_allclose(out[block].sum(axis=(0, 1)), noisy[block].sum(axis=(0, 1)))
    assert np.std((out / pattern)[..., 1:3]) < 0.7 * np.std((noisy / pattern)[..., 1:3])
    np.testing.assert_allclose(smooth_octaves(pattern, room), pattern)


def test_weights_are_those_of_cells_in_view():
    center = np.array([[0.0, 0, 1], [1, 0, 1], [2, 0, 1], [0, 0, 4]])
    place = np.array([[0.4, 0, 1.4], [9, 0, 1.4]])
    seen = np.array([[True, False, True, True], [False, False, False, False]])
    near, weight = weigh_cells(center, place, seen, 1.7, 3)
    np.testing.assert_allclose(weight.sum(axis=1), 1)
    assert near[0, :2].tolist() == [0, 2]
    np.testing.assert_allclose(weight[0, 1] / weight[0, 0], (0.1 / 1.3) ** 2, rtol=1e-6)
    assert near[1, 0] == 2  # sees nothing: the nearest one


def test_a_delay_moves_energy_and_keeps_it():
    energy = jnp.zeros((20, 7)).at[3].set(1.0)
    later = np.asarray(_delay(energy, jnp.float32(4.25)))
    np.testing.assert_allclose(later[7:9, 0], [0.75, 0.25], rtol=1e-5)
    assert later.sum() == pytest.approx(7)


@pytest.mark.parametrize("bins", [3.5, 4.0, 19.0, 20.0, 30.0])
def test_a_delay_drops_what_is_later_than_the_end(bins):
    later = np.asarray(_delay(jnp.ones((4, 1)), jnp.float32(bins)))[:, 0]
    np.testing.assert_allclose(later, [0.0, 0.0, 0.0, max(4.0 - bins, 0.0)])
