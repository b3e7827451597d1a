"""Stages of ray tracing in a house: from points of its cells, then from the portal states that rays reached."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.bake.options import StageSizes
from home_mjx.audio_jax.late_reverb.bake.portal_correction import NUM_BATCHES, RECORDED_BINS
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import (
    Transfer,
    build_portal_states,
    build_second_states,
    list_transfers,
    sum_transfer,
)
from home_mjx.audio_jax.late_reverb.lookup.time_grid import NUM_BINS
from home_mjx.audio_jax.late_reverb.trace.ray_pool import RayPool
from home_mjx.audio_jax.late_reverb.trace.tracer import FlightStart, FlightTracer, SourceSums
from home_mjx.schema.compiled import BANDS

CELL_MIXING_LENGTH = 40.0  # [m], path length after which the start cell within a room hardly affects the field
STATIONARY_LENGTH = 120.0  # [m], further path length after which the decay no longer depends on the time since emission
YOUNG_BINS = 64  # recorded bins of flights that end by age after `CELL_MIXING_LENGTH`, with room for one long segment
OLD_BINS = 128  # the same of `STATIONARY_LENGTH`
UNTERMINATED_TOTAL = 8000  # rays that portals do not terminate, from all states of small houses together
UNTERMINATED_LENGTH_RATIO = 1.25  # path length of these flights re the recorded one, because not all rays reach its end


class BakedRays(NamedTuple):
    """Results of all stages."""

    cells: SourceSums  # of the sources in cells
    states: list[tuple[Int[np.ndarray, " s"], SourceSums]]  # portal states, and their sums
    number: int  # of portal states
    first: slice  # portal states into which cells emit
    entered: Int[np.ndarray, " g"]  # rooms of these states
    emitted: Float[np.ndarray, "c bands g k"]  # energy from cells into each portal state
    transfer: Transfer  # energy from portal state to portal state
    # Energy in cells from batches of rays of the first states without termination, as of `SourceSums.energy`, batch by
    # batch; None: not traced
    unterminated: Any


def trace_stages(
    tracer: FlightTracer,
    points: Float[np.ndarray, "c r 3"],
    room: Int[np.ndarray, " c"],
    sizes: StageSizes,
    seed: int,
) -> BakedRays:
    """Trace rays from all cells, and from the portal states that they reach.

    After those of cells follow rays behind one door, behind two doors, of old paths, and of very old paths. Last are
    rays without termination, unless `sizes.unterminated` is 0.

    Args:
        tracer: Ray tracer of the house.
        points: Start points of rays in each cell [m].
        room: Room of each cell.
        sizes: Rays per portal state in each stage.
        seed: Seed of all random numbers of rays.
    """
    rng = np.random.default_rng(seed)

    def trace(starts: list[FlightStart], bins: int, **how: bool) -> tuple[SourceSums, RayPool]:
        """Trace flights; return sums and ended rays."""
        sums, ended = tracer.trace(starts, bins, int(rng.integers(2**31)), **how)
        return sums, RayPool(ended)

    sources = [_source_rays(p, int(r), rng) for p, r in zip(points, room, strict=True)]
    cells, sent = trace(sources, YOUNG_BINS, from_source=True, keeps_ended=True)
    gates = build_portal_states(cells.portal.sum(axis=(0, 3, 4), dtype=float))
    oldest, old, entering = gates.ranges()
    young = sent.draw_flights(
        gates.rooms[entering], gates.number, entering.start, sizes.entering, CELL_MIXING_LENGTH, rng
    )
    between, met = trace(young, YOUNG_BINS, keeps_ended=True)
    rooms, first, second = build_second_states(gates, between.portal.sum(axis=(3, 4), dtype=float))
    last, _ = trace(met.draw_flights(rooms, first, len(gates.rooms), sizes.second, CELL_MIXING_LENGTH, rng), YOUNG_BINS)
    sent.extend(met)
    grown = sent.draw_flights(gates.rooms[old], gates.number, old.start, sizes.old, STATIONARY_LENGTH, rng)
    middle, aged = trace(grown, OLD_BINS, keeps_ended=True)
    late = aged.draw_flights(gates.rooms[oldest], gates.aged_number, oldest.start, sizes.oldest, np.inf, rng)
    final, _ = trace(late, NUM_BINS)
    count = len(gates.rooms) + len(rooms)
    number = np.arange(count)
    states = [
        (number[oldest], final),
        (number[old], middle),
        (number[entering], between),
        (number[entering.stop :], last),
    ]
    goes = np.concatenate([np.repeat(gates.aged_number[None], entering.start, axis=0), first, second])
    transfer = list_transfers([(rows, _octaves_first(sums.portal)) for rows, sums in states], goes, NUM_BINS)
    emitted = sum_transfer(_octaves_first(cells.portal), gates.number, count)
    unterminated = None
    if sizes.unterminated:
        unterminated = _trace_unterminated(tracer, [*grown, *young], sizes.unterminated, int(rng.integers(2**31)))
    first_states = slice(old.start, entering.stop)
    return BakedRays(cells, states, count, first_states, gates.rooms[first_states, 1], emitted, transfer, unterminated)


def _source_rays(points: Float[np.ndarray, "r 3"], room: int, rng: np.random.Generator) -> FlightStart:
    """Return rays in all directions, one per point of a cell: a spiral of equal areas, randomly turned about z.

    Each has energy 1 per octave; the tracer normalises their sum. They end by age at `CELL_MIXING_LENGTH`.
    """
    count = len(points)
    z = 1 - 2 * (np.arange(count) + rng.random()) / count
    turn = np.pi * (1 + 5**0.5) * np.arange(count) + 2 * np.pi * rng.random()
    radius = np.sqrt(1 - z * z)
    way = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)
    return FlightStart(points, way, np.zeros(count), np.ones((count, len(BANDS))), room, CELL_MIXING_LENGTH)


def _trace_unterminated(tracer: FlightTracer, starts: list[FlightStart], count: int, seed: int) -> Any:
    """Trace batches of rays of each portal state without termination at others; return `SourceSums.energy`.

    It has `RECORDED_BINS` bins, and the states of the first batch come first.

    Args:
        tracer: Ray tracer of the house.
        starts: Flights of the states.
        count: Maximum rays per state; more in houses of few states, see `UNTERMINATED_TOTAL`.
        seed: Seed of all random numbers of rays.
    """
    count = max(count, UNTERMINATED_TOTAL // max(len(starts), 1))
    far = UNTERMINATED_LENGTH_RATIO * RECORDED_BINS * tracer.bin_length
    strides = [NUM_BATCHES * max(-(-len(one.origin) // count), 1) for one in starts]
    batches = [
        _thin_out(one, slice(batch, None, stride), far)
        for batch in range(NUM_BATCHES)
        for one, stride in zip(starts, strides, strict=True)
    ]
    sums, _ = tracer.trace(batches, RECORDED_BINS, seed, end_in_rooms=False)
    return sums.energy


def _thin_out(one: FlightStart, rows: slice, age: float) -> FlightStart:
    """Return some rays of a source, which end by age at a path length `age` [m]."""
    origin, direction, travelled, energy = (x[rows] for x in (one.origin, one.direction, one.travelled, one.energy))
    return FlightStart(origin, direction, travelled, energy, one.room, age)


def _octaves_first(portal: Float[np.ndarray, "s r r k lanes"]) -> Float[np.ndarray, "s bands r r k"]:
    """Return portal energies with the axis of octaves second, other lanes omitted."""
    return np.moveaxis(portal[..., : len(BANDS)], 4, 1)
