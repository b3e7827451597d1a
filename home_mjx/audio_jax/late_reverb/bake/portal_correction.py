"""Correction of portal energies with rays that are not terminated at portals (NumPy, host only).

A portal state represents at most the last two rooms of a path. Sound that passes back and forth between two rooms, or
through three doors, therefore continues like all sound through its last two doors. In one house this raised room levels
by up to 0.3 dB behind one door, 0.4 dB behind two and 0.5 dB behind three. Rays without termination have no such bias.
Few of them reach distant rooms: too few for each cell, but enough for all cells of a room and all octaves together.
"""

import numpy as np
from jaxtyping import Float, Int

INTERVAL_EDGES = (0, 2, 6, 14, 30, 55, 87)  # [bins] after a portal state; energies are summed between edges
NUM_BATCHES = 7  # batches of rays per portal state, from whose variance the noise is estimated
RECORDED_BINS = INTERVAL_EDGES[-1]  # [bins], recorded time of rays without termination
PRIOR_STD = 0.15  # prior relative error of the portal model; weights the Monte Carlo correction
OWN_ROOM_STD = 0.02  # the same in the room of the portal state
MAX_CORRECTION = 3.0  # maximum correction factor, and its reciprocal the minimum
MIN_ENERGY = 1e-30  # minimum energy in ratios


def portal_ratio(
    predicted: Float[np.ndarray, "b g n k"],
    measured: Float[np.ndarray, "m b g n t"],
    room: Int[np.ndarray, " n"],
    entered: Int[np.ndarray, " g"],
) -> Float[np.ndarray, "g n k"]:
    """Return the ratio of measured to predicted energy for each portal state over time, equal in all cells of a room.

    The ratio is the mean over octaves, 1 in those without predicted energy or without any ray. Its noise is estimated
    from the variance over batches of rays and from the share of batches without a ray. Noisy ratios are shrunk towards
    1, and more so in the room of the portal state, where the model hardly errs. Ratios of the intervals of
    `INTERVAL_EDGES` are clipped to `MAX_CORRECTION` and its reciprocal, and interpolated linearly between their
    middles; they are constant before the first and after the last.

    Args:
        predicted: Predicted energy per octave, portal state, cell and bin.
        measured: Energy in the first bins from batches of rays without termination; zeros for states without such rays.
        room: Room of each cell.
        entered: Room that paths of each portal state are in.
    """
    member = np.eye(room.max() + 1)[room]
    modelled, traced = _sum_rooms(predicted, member), np.stack([_sum_rooms(x, member) for x in measured])
    return room_ratio(modelled, traced, entered, predicted.shape[3])[:, room]


def room_ratio(
    modelled: Float[np.ndarray, "b g r e"],
    traced: Float[np.ndarray, "m b g r e"],
    entered: Int[np.ndarray, " g"],
    bins: int,
) -> Float[np.ndarray, "g r k"]:
    """Return the ratio of `portal_ratio` per room, over `bins` bins, from sums over cells and intervals.

    Args:
        modelled: Predicted energy.
        traced: Energy from batches of rays without termination.
        entered: Room that paths of each portal state are in.
        bins: Number of bins k.
    """
    known = (modelled > MIN_ENERGY) & (traced.sum(axis=(0, 3, 4), keepdims=True)[0] > 0)
    ratio = np.where(known, traced / np.maximum(modelled, MIN_ENERGY), 1.0).mean(axis=1)
    missed = (traced.sum(axis=1) <= 0).mean(axis=0) * known.any(axis=0)
    noise = np.maximum(ratio.var(axis=0, ddof=1) / len(ratio), missed**2)
    own = entered[:, None, None] == np.arange(modelled.shape[2])[None, :, None]
    prior = np.where(own, OWN_ROOM_STD, PRIOR_STD) ** 2
    factor = 1 + prior / (prior + noise) * (ratio.mean(axis=0) - 1)
    middle = np.convolve(INTERVAL_EDGES, [0.5, 0.5], "valid") - 0.5
    factor = np.clip(factor, 1 / MAX_CORRECTION, MAX_CORRECTION)
    return np.stack([[np.interp(np.arange(bins), middle, one) for one in state] for state in factor])


def _sum_rooms(energy: Float[np.ndarray, "b g n k"], member: Float[np.ndarray, "n r"]) -> Float[np.ndarray, "b g r e"]:
    """Sum energies over the cells of each room, and over the bins between `INTERVAL_EDGES`; later bins are omitted."""
    parts = np.add.reduceat(energy[..., :RECORDED_BINS], INTERVAL_EDGES[:-1], axis=3)
    return np.einsum("bgne,nr->bgre", parts, member)
