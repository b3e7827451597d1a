"""How time is divided in what is baked: spans after the first arrival, and knots between which decays are straight."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

SPANS = (0, 2, 6, 14, 30)  # bins after the first arrival at which a span of time begins; the last one never ends
FINE = 14  # bins up to which there is a knot at each, and of which no decay's slope is told
BINS = 500  # that are baked
SILENT = 1e-12  # energy below which nothing is told apart
KNOTS: Int[np.ndarray, " knots"] = np.unique(
    np.concatenate([np.arange(FINE + 1), np.geomspace(FINE, BINS - 1, 28).round(), SPANS, np.subtract(SPANS[1:], 1)])
).astype(int)  # on both sides of where a span begins: what is read of one knows nothing of the others


def at_knots(shape: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... knots"]:
    """Logarithms of a decay at the knots, such that what is read between them holds 1 in each span.

    The value at a knot is the mean around it, over half the way to its neighbours, which is then taken as that of an
    exponential as steep as the decay is there.
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
    """Weights of the knots at each bin: linear in between; after the last one it goes on as before."""
    at = np.arange(bins)
    left = np.clip(np.searchsorted(KNOTS, at, side="right") - 1, 0, len(KNOTS) - 2)
    share = (at - KNOTS[left]) / (KNOTS[left + 1] - KNOTS[left])
    weight = np.zeros((bins, len(KNOTS)))
    weight[at, left], weight[at, left + 1] = 1 - share, share
    return weight


def span_of(bins: int) -> Int[np.ndarray, " k"]:
    """Which span each bin is in."""
    return np.searchsorted(SPANS, np.arange(bins), side="right") - 1
