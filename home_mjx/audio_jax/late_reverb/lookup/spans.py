"""Time grid of baked reverberation: spans after the first arrival, and knots of piecewise exponential decays."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

SPANS = (0, 2, 6, 14, 30)  # [bins] after the first arrival, start of each span; the last span has no end
FINE = 14  # [bins], up to which every bin is a knot and no slope is fitted
BINS = 500  # baked time bins
SILENT = 1e-12  # minimum energy in logarithms and ratios
KNOTS: Int[np.ndarray, " knots"] = np.unique(
    np.concatenate([np.arange(FINE + 1), np.geomspace(FINE, BINS - 1, 28).round(), SPANS, np.subtract(SPANS[1:], 1)])
).astype(int)  # with knots on both sides of each span's start, so that no interpolation crosses it


def at_knots(shape: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... knots"]:
    """Compute log decays at the knots, normalised so that each span sums to 1 after interpolation.

    The value at a knot is derived from the mean energy up to halfway to its neighbours. That mean is treated as the
    mean of an exponential with the decay's local slope.
    """
    edges = np.append(0, (KNOTS[1:] + KNOTS[:-1]) // 2 + 1)
    width = np.diff([*edges, shape.shape[-1]])
    knots = np.log(np.maximum(np.add.reduceat(shape, edges, axis=-1) / width, SILENT))
    middle, weight = edges + (width - 1) / 2, between(shape.shape[-1])
    for first, end in pairwise([*SPANS, shape.shape[-1]]):
        inside = (first <= KNOTS) & (end > KNOTS)
        here = knots[..., inside]
        if first >= FINE:
            slope = np.gradient(here, middle[inside], axis=-1)
            half = np.clip(np.abs(slope) * width[inside] / 2, 1e-3, 5)
            here += slope * (KNOTS - middle)[inside] - np.log(np.sinh(half) / half)
        read = np.exp(here @ weight[first:end, inside].T)
        knots[..., inside] = here - np.log(np.maximum(read.sum(axis=-1, keepdims=True), SILENT))
    return knots


def between(bins: int) -> Float[np.ndarray, "k knots"]:
    """Return the weights of the knots at each bin: linear interpolation, and extrapolation after the last knot."""
    at = np.arange(bins)
    left = np.clip(np.searchsorted(KNOTS, at, side="right") - 1, 0, len(KNOTS) - 2)
    share = (at - KNOTS[left]) / (KNOTS[left + 1] - KNOTS[left])
    weight = np.zeros((bins, len(KNOTS)))
    weight[at, left], weight[at, left + 1] = 1 - share, share
    return weight


def span_of(bins: int) -> Int[np.ndarray, " k"]:
    """Return the span index of each bin."""
    return np.searchsorted(SPANS, np.arange(bins), side="right") - 1
