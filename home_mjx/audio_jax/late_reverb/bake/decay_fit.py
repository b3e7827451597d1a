"""Decay fit of received energies: time spans, decay shapes, and extrapolation beyond the traced time."""

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.audio_jax.late_reverb.bake.pair_sums import sum_pairs
from home_mjx.audio_jax.late_reverb.lookup.time_grid import FINE_BINS, MIN_ENERGY, SPAN_STARTS

GAP_BLOCK = 10  # [bins], resolution of the search for gaps in a decay
ROOM_PRIOR = 0.05  # weight of the rooms' distribution over spans in that of each pair of cells


class Accumulator:
    """Accumulator of the energy between cells and between rooms.

    Args:
        room: Room of each cell.
        distance: Shortest path between cells [m].
        bands: Number of octaves.
        bins: Number of time bins.
        metres: Distance that sound travels in one bin [m].
    """

    def __init__(
        self, room: Int[np.ndarray, " n"], distance: Float[np.ndarray, "n n"], bands: int, bins: int, metres: float
    ) -> None:
        self.room, self.distance, self.metres, self.bins = room, distance, metres, bins
        self.arrival = np.floor(distance / metres).astype(int)  # bin of the first possible arrival
        count, rooms = len(room), room.max() + 1
        self.pair = np.zeros((count, count, len(SPAN_STARTS), bands))
        self.shape = np.zeros((rooms, rooms, bands, bins))
        self.valid = 0

    def add(
        self,
        own: Float[np.ndarray, "n n u bands"],
        emitted: Float[np.ndarray, "bands n g t"],
        after: Float[np.ndarray, "bands g n k"],
        flown: float,
    ) -> None:
        """Add energies, see `sum_pairs`; `flown`, the path length that most rays travelled [m], limits decay fits."""
        self.add_sums(*sum_pairs(own, emitted, after, self.arrival, self.room), flown)

    def add_sums(self, pair: Float[np.ndarray, "n n s b"], shape: Float[np.ndarray, "r r b k"], flown: float) -> None:
        """Add the results of `sum_pairs`; `flown` as in `add`."""
        self.pair += pair
        self.shape += shape
        self.valid = int((flown - self.distance.max()) / self.metres)

    def finish(
        self, seen: Bool[np.ndarray, "n n"] | None = None
    ) -> tuple[Float[np.ndarray, "n n s b"], Float[np.ndarray, "r r b k"]]:
        """Return log energies per pair, span and octave, and decay shapes (sum 1 per span) per pair of rooms.

        Logs are natural. Energies are symmetric (reciprocity), smoothed over octaves, and extrapolated after the traced
        time.

        Args:
            seen: Visibility between cells. Pairs of rooms without any visible pair of cells are smoothed, see
                `factor_hidden_pairs`. None: all cells are visible.
        """
        shape = self.shape + np.swapaxes(self.shape, 0, 1)
        valid = int(np.clip(self.valid, 3 * FINE_BINS, shape.shape[3]))
        rooms = np.arange(len(shape))
        slowest = [_decay_rate(band, valid) for band in shape[rooms, rooms].sum(axis=0)]
        found = np.add.reduceat(shape, SPAN_STARTS, axis=3)
        for index in np.ndindex(*shape.shape[:3]):
            _extrapolate(shape[index], valid, slowest[index[2]])
        spans = np.add.reduceat(shape, SPAN_STARTS, axis=3)  # (r, r, bands, spans)
        longer = np.moveaxis(np.where(found > 0, spans / np.maximum(found, MIN_ENERGY**2), 1.0), 3, 2)
        pair = smooth_octaves((self.pair + np.swapaxes(self.pair, 0, 1)) / 2, self.room)
        pair = factor_hidden_pairs(pair, self.room, seen) if seen is not None else pair
        a, b = self.room[:, None], self.room[None]
        pair *= longer[a, b]
        form = np.moveaxis(spans / np.maximum(spans.sum(axis=3, keepdims=True), MIN_ENERGY), 3, 2)[a, b]
        pair = (pair + ROOM_PRIOR * pair.sum(axis=2, keepdims=True) * form) / (1 + ROOM_PRIOR)
        width = np.diff([*SPAN_STARTS, shape.shape[3]])
        shape /= np.maximum(np.repeat(spans, width, axis=3), MIN_ENERGY)
        return np.log(np.maximum(pair, MIN_ENERGY)), shape


def smooth_octaves(pair: Float[np.ndarray, "n n s b"], room: Int[np.ndarray, " n"]) -> Float[np.ndarray, "n n s b"]:
    """Smooth the pattern over the cells of each pair of rooms: average it over each octave and its neighbours.

    The ratio of a cell's energy to its room's mean depends on its position and changes slowly with frequency. Each
    octave has its own rays, so averaging reduces noise. Means over pairs of rooms are unchanged.
    """
    member = np.eye(room.max() + 1)[room]
    count = member.sum(axis=0)
    mean = np.einsum("ia,ijsb,jc->acsb", member, pair, member, optimize=True)
    mean /= np.maximum(count[:, None] * count[None], 1)[..., None, None]
    mean = np.maximum(mean, MIN_ENERGY**2)[room[:, None], room[None]]
    bands = pair.shape[-1]
    near = np.abs(np.subtract.outer(np.arange(bands), np.arange(bands))) <= 1
    return (pair / mean) @ (near / near.sum(axis=0)) * mean


def factor_hidden_pairs(
    pair: Float[np.ndarray, "n n s b"], room: Int[np.ndarray, " n"], seen: Bool[np.ndarray, "n n"]
) -> Float[np.ndarray, "n n s b"]:
    """Return a copy with energies between rooms without mutual visibility replaced by a product of one factor per cell.

    Such sound passes other rooms and enters through one doorway. The source's cell then only determines the level at
    that doorway, so a few rays determine many pairs. Factors are a cell's sums over the cells of the other room; their
    product is divided by the total of both rooms.

    `pair` must be symmetric in its first two axes, and so is the result: one direction is computed and mirrored. A pair
    of rooms is replaced only if no cell of one sees any cell of the other, in either direction of `seen`.
    """
    out = pair.copy()
    for a, b in np.argwhere(np.triu(np.ones((room.max() + 1,) * 2), 1)):
        rows, columns = np.flatnonzero(room == a), np.flatnonzero(room == b)
        block = np.ix_(rows, columns)
        if not len(rows) or not len(columns) or seen[block].any() or seen.T[block].any():
            continue
        of, to = pair[block].sum(axis=1, keepdims=True), pair[block].sum(axis=0, keepdims=True)
        out[block] = of * to / np.maximum(of.sum(axis=0, keepdims=True), MIN_ENERGY**2)
        out[np.ix_(columns, rows)] = np.swapaxes(out[block], 0, 1)
    return out


def _dense_end(decay: Float[np.ndarray, " k"], valid: int) -> int:
    """Return the start of the first block of `GAP_BLOCK` bins with energy in less than 70 % of them; else `valid`.

    Blocks that begin within `FINE_BINS` are exempt, as is a partial one before `valid`.
    """
    blocks = decay[: valid // GAP_BLOCK * GAP_BLOCK].reshape(-1, GAP_BLOCK) > 0
    empty = np.flatnonzero(blocks.mean(axis=1) < 0.7)
    empty = empty[empty > FINE_BINS // GAP_BLOCK]
    return int(empty[0] * GAP_BLOCK) if empty.size else valid


def _decay_rate(decay: Float[np.ndarray, " k"], end: int) -> float:
    """Estimate the decay rate before `end` [1/bin]; 0 if the energy does not fall, or falls to 0.

    The rate is the log ratio of the energies in the last two quarters before `end`, without the first `FINE_BINS` bins;
    0 if these quarters are empty.
    """
    half = (end - max(end // 2, FINE_BINS)) // 2
    if half < 1:
        return 0.0
    before, after = decay[end - 2 * half : end - half].sum(), decay[end - half : end].sum()
    return float(np.log(before / after) / half) if before > after > 0 else 0.0


def _extrapolate(decay: Float[np.ndarray, " k"], valid: int, slowest: float) -> None:
    """Extend a decay in place beyond the traced time, at its last rate; no effect if it does not decay.

    Bins from the first gap (`_dense_end`) on are replaced; the level is that of the last quarter before it.

    Args:
        decay: Energy per bin between two rooms.
        valid: Bin up to which nearly all rays were traced.
        slowest: Final decay rate of the rooms themselves [1/bin]; a lower bound for all rooms that they excite.
    """
    end = _dense_end(decay, valid)
    first, rate = max(end - (end - FINE_BINS) // 4, FINE_BINS), max(_decay_rate(decay, end), slowest)
    if decay[FINE_BINS:].sum() <= 0 or rate <= 0 or end <= first:
        return
    width = (end - first) / 2
    mean = np.sinh(rate * width) / (rate * width)  # mean of an exponential over the last quarter re its middle
    time = np.arange(end, len(decay)) - (first + end - 1) / 2
    decay[end:] = decay[first:end].mean() / mean * np.exp(-rate * time)


def weigh_cells(
    center: Float[np.ndarray, "n 3"],
    place: Float[np.ndarray, "p 3"],
    seen: Bool[np.ndarray, "p n"],
    reach: float,
    count: int,
) -> tuple[Int[np.ndarray, "p e"], Float[np.ndarray, "p e"]]:
    """Return indices of visible cells around each place and their weights, (1 − d / reach)² normalised to a sum of 1.

    A place without a visible cell within `reach` takes the nearest visible one, or else the nearest one. Distances d
    are those of `horizontal_distance`. Cells come by descending weight, equal ones by index; places with fewer cells
    are filled up with cells of weight 0.

    Args:
        center: Centres of the cells [m].
        place: Positions [m].
        seen: Visibility of each cell's centre from each place.
        reach: Distance at which a cell's weight becomes zero [m].
        count: Maximum cells per place.
    """
    apart = horizontal_distance(center, place)
    weight = np.where(seen, np.maximum(1 - apart / reach, 0) ** 2, 0)
    alone = weight.sum(axis=1) <= 0
    weight[alone, np.argmin(np.where(seen, apart, apart + 1000), axis=1)[alone]] = 1
    count = min(count, len(center))
    near = np.argsort(-weight, axis=1, kind="stable")[:, :count]
    weight = np.take_along_axis(weight, near, 1)
    return near, weight / weight.sum(axis=1, keepdims=True)


def horizontal_distance(center: Float[np.ndarray, "n 3"], place: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p n"]:
    """Return horizontal distances from places to cells [m], plus 100 m for cells more than 2 m above or below."""
    apart = np.linalg.norm(place[:, None, :2] - center[None, :, :2], axis=2)
    return apart + 100 * (np.abs(place[:, None, 2] - center[None, :, 2]) > 2)
