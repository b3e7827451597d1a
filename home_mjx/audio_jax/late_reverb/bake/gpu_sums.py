"""Energies between cells on a GPU from the sums of all flights: `fill_accumulator` with the kernels of cuda/sums.cu."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.bake.accumulate import DIRECTIONAL_BINS, pack_directions, sum_fields, trim_silence
from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.portal_correction import INTERVAL_EDGES, NUM_BATCHES, RECORDED_BINS, room_ratio
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import Transfer
from home_mjx.audio_jax.late_reverb.bake.stages import BakedRays
from home_mjx.audio_jax.late_reverb.cuda.kernels import BLOCK
from home_mjx.audio_jax.late_reverb.lookup.time_grid import NUM_BINS, SPAN_STARTS
from home_mjx.core.native.cuda_driver import CudaStream, DeviceArray, pack_words
from home_mjx.schema.compiled import BANDS

CELLS, RENEWAL_TEAM, DECAY_TEAM = 32, 1024, 128  # as in sums.cu
OCTAVES, RECORDED = len(BANDS), len(BANDS) + 3
DOUBLE = 8  # [bytes]
SWEEPS = 8  # iterations of the transfer within one bin


class AfterStates(NamedTuple):
    """Energy that cells receive from some states, per lane (octaves or directions)."""

    energy: DeviceArray  # (lanes, states, cells, bins) float32
    total: DeviceArray  # (lanes, states, cells, bins + 1) float64, cumulative


def fill_accumulator(tally: Accumulator, rays: BakedRays, stream: CudaStream) -> dict[str, np.ndarray]:
    """Add the results of all stages to an accumulator, as `accumulate.fill_accumulator` does, on a GPU.

    Args:
        tally: The accumulator.
        rays: Results of all stages; energies of cells are arrays of the GPU.
        stream: Queue of its work.

    Raises:
        BackendError: The GPU fails.
    """
    found = solve_transfers(stream, gather_states(stream, rays, len(tally.room)), rays.transfer)
    ratio = _ratio(stream, rays, found, tally.room) if rays.unterminated is not None else None
    if ratio is None:
        ratio = np.ones((len(rays.entered), tally.room.max() + 1, NUM_BINS))
    sent = trim_silence(np.moveaxis(rays.emitted[:, :, rays.first], 1, 0))
    energy = energy_after(stream, found, rays.first, tally.room, (0, OCTAVES, NUM_BINS), ratio)
    pair, shape = sum_pairs(stream, rays.cells.energy, 0, sent, energy, tally.arrival, tally.room)
    tally.add_sums(pair, shape, float(NUM_BINS * tally.metres))
    early = np.broadcast_to(sent.mean(axis=0), (3, *sent.shape[1:]))
    intensity = energy_after(stream, found, rays.first, tally.room, (OCTAVES, 3, DIRECTIONAL_BINS))
    ways, _ = sum_pairs(stream, rays.cells.energy, OCTAVES, early, intensity, tally.arrival, tally.room)
    return sum_fields(rays) | {"comes_from": pack_directions(ways, tally.pair)}


def gather_states(stream: CudaStream, rays: BakedRays, cells: int) -> DeviceArray:
    """Return energies that cells receive from states, float32 (octaves and directions, states, bins, padded cells)."""
    found = stream.zeros((RECORDED, rays.number, NUM_BINS, -(-cells // CELLS) * CELLS), np.float32)
    for rows, sums in rays.states:
        count, _, bins, _ = sums.energy.shape
        row = stream.upload(np.asarray(rows, np.int32))
        words = pack_words([sums.energy, found, row, count, cells, bins, rays.number, NUM_BINS, found.shape[3]])
        stream.launch("gather_states", -(-count * cells * bins * RECORDED // BLOCK), BLOCK, words)
    return found


def solve_transfers(stream: CudaStream, found: DeviceArray, transfer: Transfer) -> DeviceArray:
    """Add transfers between states to `found` in place, see `renewal`, and return it.

    Within a bin, transfers are iterated for all states at once.
    """
    source, target, energy = transfer
    _, states, bins, stride = found.shape
    directional = min(DIRECTIONAL_BINS, bins)
    share = np.zeros((RECORDED, len(source), bins), np.float32)
    share[:OCTAVES] = np.moveaxis(energy, 1, 0)
    share[OCTAVES:, :, :directional] = energy[..., :directional].mean(axis=1)
    some = (energy != 0).any(axis=1)
    last = bins - np.argmax(some[:, ::-1], axis=1)
    pair = np.stack([target, np.maximum(np.argmax(some, axis=1), 1), np.where(some.any(axis=1), last, 0)], axis=1)
    end, instant = np.searchsorted(source, np.arange(states + 1)), np.zeros(states, np.int32)
    instant[source[some[:, 0]]] = 1
    base, shares = stream.empty((2, RECORDED, states, stride), np.float32), stream.upload(share)
    tables = [stream.upload(np.asarray(x, np.int32)) for x in (end, pair, instant)]
    counts = states, bins, stride, len(source), directional, SWEEPS if instant.any() else 0
    words = pack_words([found, base, shares, *tables, *counts])
    stream.launch("solve_renewal", stride // CELLS, RENEWAL_TEAM, words, rows=RECORDED)
    return found


def _ratio(
    stream: CudaStream, rays: BakedRays, found: DeviceArray, room: Int[np.ndarray, " n"]
) -> Float[np.ndarray, "g r k"]:
    """Return the ratio of measured to predicted energy, see `portal_ratio`, per room."""
    measured, cells, (_, states, bins, stride) = rays.unterminated, len(room), found.shape
    row = cells * RECORDED_BINS * RECORDED
    count = len(rays.entered)
    start = found.address + 4 * rays.first.start * bins * stride
    modelled = sum_rooms(stream, start, (1, count), room, (0, states * bins * stride, bins * stride, stride, 1))
    strides = count * row, 1, row, RECORDED, RECORDED_BINS * RECORDED
    traced = sum_rooms(stream, measured.address, (NUM_BATCHES, count), room, strides)
    return room_ratio(modelled[0], traced, rays.entered, NUM_BINS)


def sum_rooms(
    stream: CudaStream, address: int, shape: tuple[int, int], room: Int[np.ndarray, " n"], strides: tuple[int, ...]
) -> Float[np.ndarray, "m b g r e"]:
    """Sum energies over the cells of each room, and over the bins between `INTERVAL_EDGES`.

    Args:
        stream: Queue of the GPU's work.
        address: Of the energies, float32.
        shape: Numbers of batches and of states.
        room: Room of each cell.
        strides: From one batch, octave, state, bin and cell to the next.
    """
    rooms, intervals = int(room.max()) + 1, len(INTERVAL_EDGES) - 1
    out = stream.empty((*shape, rooms, intervals, OCTAVES), np.float64)
    tables = [stream.upload(np.asarray(x, np.int32)) for x in (room, INTERVAL_EDGES)]
    words = pack_words([address, out, *tables, *shape, rooms, intervals, len(room), *strides])
    stream.launch("sum_rooms_over_time", -(-int(np.prod(out.shape)) // BLOCK), BLOCK, words)
    return np.moveaxis(stream.download(out), 4, 1)


def energy_after(
    stream: CudaStream,
    found: DeviceArray,
    first: slice,
    room: Int[np.ndarray, " n"],
    part: tuple[int, int, int],
    ratio: Float[np.ndarray, "g r k"] | None = None,
) -> AfterStates:
    """Return energies of some states (`first`) and of `part`, that is first lane, lanes and bins, times `ratio`."""
    (lane, lanes, bins), (_, states, every, stride) = part, found.shape
    start, count, cells = (
        found.address + 4 * (lane * states + first.start) * every * stride,
        first.stop - first.start,
        len(room),
    )
    energy = stream.empty((lanes, count, cells, bins), np.float32)
    total = stream.empty((lanes, count, cells, bins + 1), np.float64)
    factor = None if ratio is None else stream.upload(ratio.astype(np.float32))
    rooms = stream.upload(room.astype(np.int32))
    sizes = lanes, count, cells, bins, int(room.max()) + 1, every, stride, states
    words = pack_words([start, factor, rooms, energy, total, *sizes])
    stream.launch("sum_after", -(-lanes * count * cells // BLOCK), BLOCK, words)
    return AfterStates(energy, total)


def sum_pairs(
    stream: CudaStream,
    own: DeviceArray,
    lane: int,
    emitted: Float[np.ndarray, "b n g t"],
    after: AfterStates,
    arrival: Int[np.ndarray, "n n"],
    room: Int[np.ndarray, " n"],
) -> tuple[Float[np.ndarray, "n n spans b"], Float[np.ndarray, "r r b k"]]:
    """Sum energies over spans per pair of cells and over pairs of rooms, as `pair_sums.sum_pairs` does.

    Args:
        stream: Queue of the GPU's work.
        own: Energy from cells (first axis) to cells before any state, per bin, octave and direction.
        lane: First octave or direction of the result.
        emitted: Energy from cells into states, per bin.
        after: Energy that cells receive from states.
        arrival: Bin of the first possible arrival from cell (row) to cell.
        room: Room of each cell.
    """
    lanes, states, cells, bins = after.energy.shape
    arrival, rooms, own_bins, sent_bins = np.minimum(arrival, bins), int(room.max()) + 1, own.shape[2], emitted.shape[3]
    sent = stream.upload(np.asarray(np.moveaxis(emitted, 1, 3), np.float32))
    tables = arrival, room, arrival.max(axis=0), [*SPAN_STARTS[1:], bins]
    pair = stream.empty((cells, cells, len(SPAN_STARTS), lanes), np.float64)
    part = stream.empty((cells, rooms, lanes, bins), np.float64)
    shape = stream.empty((rooms, rooms, lanes, bins), np.float64)
    given = [own, sent, *after, *(stream.upload(np.asarray(x, np.int32)) for x in tables)]
    words = pack_words([*given, pair, part, shape, cells, rooms, states, lanes, bins, own_bins, sent_bins, lane])
    stream.launch("sum_spans", -(-cells // BLOCK), BLOCK, words, rows=cells * lanes)
    shared = DOUBLE * (sent_bins + int(arrival.max()))
    stream.launch("sum_decays", cells, DECAY_TEAM, words, shared, rooms * lanes)
    stream.launch("sum_targets", -(-rooms * rooms * lanes * bins // BLOCK), BLOCK, words)
    return stream.download(pair), stream.download(shape)
