"""Time grid of baked reverberation: spans after the first arrival, and knots of piecewise exponential decays."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

SPAN_STARTS = (0, 2, 6, 14, 30)  # [bins] after the first arrival, start of each span; the last span has no end
FINE_BINS = 14  # [bins], up to which every bin is a knot and no slope is fitted
NUM_BINS = 500  # baked time bins
MIN_ENERGY = 1e-12  # minimum energy in logarithms and ratios
KNOT_BINS: Int[np.ndarray, " knots"] = np.unique(
    np.concatenate(
        [
            np.arange(FINE_BINS + 1),
            np.geomspace(FINE_BINS, NUM_BINS - 1, 28).round(),
            SPAN_STARTS,
            np.subtract(SPAN_STARTS[1:], 1),
        ]
    )
).astype(int)  # with knots on both sides of each span's start, so that no interpolation crosses it


def fit_knots(shape: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... knots"]:
    """Fit natural logs at `KNOT_BINS` to energies per bin; exp of `knot_weights` times them sums to 1 in each span.

    The value at a knot is derived from the mean energy up to halfway to its neighbours. That mean is treated as the
    mean of an exponential with the decay's local slope.
    """
    edges = np.append(0, (KNOT_BINS[1:] + KNOT_BINS[:-1]) // 2 + 1)
    width = np.diff([*edges, shape.shape[-1]])
    knots = np.log(np.maximum(np.add.reduceat(shape, edges, axis=-1) / width, MIN_ENERGY))
    middle, weight = edges + (width - 1) / 2, knot_weights(shape.shape[-1])
    for first, end in pairwise([*SPAN_STARTS, shape.shape[-1]]):
        inside = (first <= KNOT_BINS) & (end > KNOT_BINS)
        here = knots[..., inside]
        if first >= FINE_BINS:
            slope = np.gradient(here, middle[inside], axis=-1)
            half = np.clip(np.abs(slope) * width[inside] / 2, 1e-3, 5)
            here += slope * (KNOT_BINS - middle)[inside] - np.log(np.sinh(half) / half)
        read = np.exp(here @ weight[first:end, inside].T)
        knots[..., inside] = here - np.log(np.maximum(read.sum(axis=-1, keepdims=True), MIN_ENERGY))
    return knots


def knot_weights(bins: int) -> Float[np.ndarray, "k knots"]:
    """Return the weights of `KNOT_BINS` at bins 0, 1, ...: linear interpolation, extrapolation after the last knot."""
    at = np.arange(bins)
    left = np.clip(np.searchsorted(KNOT_BINS, at, side="right") - 1, 0, len(KNOT_BINS) - 2)
    share = (at - KNOT_BINS[left]) / (KNOT_BINS[left + 1] - KNOT_BINS[left])
    weight = np.zeros((bins, len(KNOT_BINS)))
    weight[at, left], weight[at, left + 1] = 1 - share, share
    return weight


def span_index(bins: int) -> Int[np.ndarray, " k"]:
    """Return the index into `SPAN_STARTS` of the span of bins 0, 1, ... `bins` - 1 after the first arrival."""
    return np.searchsorted(SPAN_STARTS, np.arange(bins), side="right") - 1
