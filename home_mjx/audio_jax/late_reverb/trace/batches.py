"""Batched flights from several sources, and the mean result of each source.

A flight is a set of rays of all octaves that start in one room.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.trace.cell_grid import CellGrid
from home_mjx.audio_jax.late_reverb.trace.trace_cells import FLIGHT_AXIS, PortalRays, TraceEnergy, trace_flight
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

RAYS_PER_BATCH = {"gpu": 1 << 18}  # concurrent rays, about the number of threads; elsewhere those of one flight
MAX_FLIGHTS_PER_BATCH = 96  # maximum concurrent flights, each with 3 to 9 MB of recorded energy
SOURCE_PADDING = 16  # to a multiple of which the averaged sources are padded; limits compiled programs
KEY_PADDING = 256  # to a multiple of which the random keys are padded; limits compiled programs
MAX_BOUNCES_PER_METRE = (
    1.0  # maximum reflections per metre of age: flights end by age, as rarely reflected rays last longest
)


class FlightStart(NamedTuple):
    """Start of the rays of one flight, octave after octave, with equal numbers per octave."""

    origin: Float[np.ndarray, "n 3"]
    direction: Float[np.ndarray, "n 3"]
    travelled: Float[np.ndarray, " n"]  # since the start of the bin in which it reached a portal state [m]
    room: int
    age: float  # path length at which rays end by age [m]


class StageResult(NamedTuple):
    """Mean results over the flights of each source; portal states are sources too."""

    count: int  # number of sources
    parts: tuple[tuple[Int[np.ndarray, " s"], TraceEnergy], ...]  # sources and their results, padded

    def gather(self, read: Callable[[TraceEnergy], Array | np.ndarray]) -> Float[np.ndarray, "count ..."]:
        """Gather an array of the results for all sources on the host; zeros for sources without flights."""
        found = [(rows, np.asarray(read(gave))) for rows, gave in self.parts]
        out = np.zeros((self.count, *found[0][1].shape[1:]), np.float32)
        for rows, some in found:
            out[rows] = some[: len(rows)]
        return out

    def gather_on_device(self, read: Callable[[TraceEnergy], Array]) -> Array:
        """Concatenate an array of the results of all sources on the device; every source must have flights."""
        return jnp.concatenate([read(gave)[: len(rows)] for rows, gave in self.parts])


def merge_results(count: int, some: Sequence[tuple[Int[np.ndarray, " _"], StageResult]]) -> StageResult:
    """Merge results into one of `count` sources; each part comes with the new indices of its sources."""
    return StageResult(count, tuple((number[rows], gave) for number, heard in some for rows, gave in heard.parts))


@dataclass(frozen=True)
class FlightTracer:
    """Ray tracer of one house.

    Attributes:
        scene: Scene of the house.
        grid: Cells of the house.
        config: Options for `bin_seconds` and air absorption.
        bins: Number of time bins.
        rays: Rays per flight, over all octaves.
        max_bounces: Maximum reflections of a ray.
    """

    scene: Scene
    grid: CellGrid
    config: AudioConfig
    bins: int
    rays: int
    max_bounces: int

    @property
    def batch_size(self) -> int:
        """Number of concurrent flights."""
        return int(np.clip(RAYS_PER_BATCH.get(jax.default_backend(), 0) // self.rays, 1, MAX_FLIGHTS_PER_BATCH))

    def trace(
        self,
        starts: Sequence[Sequence[FlightStart]],
        from_source: bool,
        seed: int,
        end_in_rooms: bool = True,
        num_bins: int | None = None,
        keep: Callable[[PortalRays, Int[np.ndarray, " f"]], None] | None = None,
    ) -> StageResult:
        """Trace the flights of some sources; results stay on the device, and transfers to the host are started.

        Args:
            starts: Flights of each source.
            from_source: Rays start at sources, not at reflections.
            seed: Seed of all flights.
            end_in_rooms: Rays end in other rooms; else they continue there.
            num_bins: Number of bins that are kept; None: all.
            keep: Callback for the rays that reached portal states, and the source of each flight. Host arrays of
                flights (f, 2, n) hold the rays that left a room and those that aged there.
        """
        source = np.repeat(np.arange(len(starts)), [len(some) for some in starts])
        every, keys = [one for some in starts for one in some], _keys(seed, len(source))
        how = np.bool_(from_source), np.bool_(end_in_rooms)
        parts, ended = [(source[:0], _empty_energy(self.grid, num_bins or self.bins))], []
        for rows in self._blocks(source):
            gave = ()
            for some in _chunks(np.flatnonzero(np.isin(source, rows)), self.batch_size):
                here = some[np.minimum(np.arange(self.batch_size), len(some) - 1)]  # constant size: one program
                rays = _stack([every[flight] for flight in here])
                bounces = np.minimum(MAX_BOUNCES_PER_METRE * rays[-1], self.max_bounces).astype(np.int32)
                found, gone = _trace_batch(
                    self.scene, self.grid, *rays, bounces, *how, keys[here], self.config, self.bins
                )
                ended.append((gone, source[some]))
                if keep:
                    _start_copies(gone)
                gave = (_accumulate(gave, found, *_batch_weights(rows, source, some, self.batch_size)),)
                jax.block_until_ready(ended[-2:-1])  # at most two batches in flight, as each holds its memory
            gave = tuple(_crop_bins(one, num_bins) if num_bins else one for one in gave)
            # The energy between cells is the largest part, and only the device needs it.
            _start_copies(*(one._replace(energy=(), intensity=()) if from_source else one for one in gave))
            parts.append((rows, *gave))
        if keep:
            for gone, of in ended:
                keep(jax.tree.map(lambda x, of=of: x[: len(of)], jax.device_get(gone)), of)
        return StageResult(len(starts), tuple(parts))

    def _blocks(self, source: Int[np.ndarray, " f"]) -> list[Int[np.ndarray, " s"]]:
        """Group sources whose flights fit into one batch; at least one source per group."""
        rows, flights = np.unique(source, return_counts=True)
        return _chunks(rows, max(self.batch_size // max(flights.tolist(), default=1), 1))


def _start_copies(*arrays: Any) -> None:
    """Start copies to the host in reverse order, so the largest array, the received energy, comes last."""
    for array in reversed(jax.tree.leaves(arrays)):
        array.copy_to_host_async()


@partial(jax.jit, static_argnums=1)
def _crop_bins(gave: TraceEnergy, bins: int) -> TraceEnergy:
    return gave._replace(
        energy=gave.energy[..., :bins],
        intensity=gave.intensity[:, :, :bins],
        portal_energy=gave.portal_energy[..., :bins],
    )


def _chunks(values: Int[np.ndarray, " n"], size: int) -> list[Int[np.ndarray, " _"]]:
    return [values[first : first + size] for first in range(0, len(values), size)]


def _keys(seed: int, count: int) -> np.ndarray:
    """Return data of at least `count` random keys, rounded up so that few sizes are compiled."""
    return np.asarray(
        jax.random.key_data(jax.random.split(jax.random.key(seed), KEY_PADDING * (count // KEY_PADDING + 1)))
    )


def _stack(flights: Sequence[FlightStart]) -> tuple[np.ndarray, ...]:
    *rays, room, age = (np.stack(x) for x in zip(*flights, strict=True))
    return *(x.astype(np.float32) for x in rays), room.astype(np.int32), age.astype(np.float32)


def _batch_weights(
    rows: Int[np.ndarray, " s"], source: Int[np.ndarray, " f"], some: Int[np.ndarray, " n"], at_once: int
) -> tuple[Int[np.ndarray, "p m"], Float[np.ndarray, "p m"]]:
    """Return the batch positions and weights of each source's flights: 1 / its flights, or 0 for padding."""
    of, step = source[some], min(SOURCE_PADDING, at_once)
    place, nth = np.searchsorted(rows, of), np.arange(len(of)) - np.searchsorted(of, of)
    shape = len(rows) + -len(rows) % step, nth.max() + 1
    flight, weight = np.zeros(shape, np.int32), np.zeros(shape, np.float32)
    flight[place, nth], weight[place, nth] = np.arange(len(of)), 1 / np.bincount(source)[of]
    return flight, weight


@partial(jax.jit, static_argnames=("config", "bins"))
def _trace_batch(
    scene: Scene,
    grid: CellGrid,
    origin: Float[Array, "f n 3"],
    direction: Float[Array, "f n 3"],
    travelled: Float[Array, "f n"],
    room: Int[Array, " f"],
    age: Float[Array, " f"],
    bounces: Int[Array, " f"],
    fresh: Bool[Array, ""],
    ends: Bool[Array, ""],
    keys: UInt32[Array, "f 2"],
    config: AudioConfig,
    bins: int,
) -> tuple[TraceEnergy, PortalRays]:
    """Trace concurrent flights; return their sums, and the rays (f, 2, n) that ended in another room or by age."""
    found = jax.vmap(
        lambda p, d, t, r, a, b, k: trace_flight(scene, grid, p, d, t, r, fresh, ends, b, a, k, config, bins),
        axis_name=FLIGHT_AXIS,
    )(origin, direction, travelled, room, age, bounces, jax.random.wrap_key_data(keys))
    return found.energy, jax.tree.map(lambda a, b: jnp.stack([a, b], axis=1), found.portal_rays, found.aged_rays)


@jax.jit
def _accumulate(
    before: tuple[TraceEnergy, ...], gave: TraceEnergy, flight: Int[Array, "s m"], weight: Float[Array, "s m"]
) -> TraceEnergy:
    """Sum the weighted energies of each source's flights, in a fixed order for reproducible results.

    Args:
        before: One element, the sums of earlier batches with one row per source; empty for the first batch.
        gave: Energies of a batch, one row per flight.
        flight: Rows of the m flights of each of s sources.
        weight: Weights of these flights; 0 for padding.
    """

    def add(new: Array, *total: Array) -> Array:
        share = weight.T.reshape(*weight.T.shape, *(new.ndim - 1) * [1])
        return reduce(jnp.add, (*total, *(share[nth] * new[row] for nth, row in enumerate(flight.T))))

    return jax.tree.map(add, gave, *before)


def _empty_energy(grid: CellGrid, bins: int) -> TraceEnergy:
    """Return empty results, of no source."""
    bands, cells, rooms = len(BANDS), grid.volume.shape[0], grid.rooms
    pair = bands, rooms, rooms
    shapes = (bands, cells, bins), (cells, bins, 3), (*pair, bins), pair[:2], pair[:2], pair, pair
    return TraceEnergy(*(jax.device_put(np.zeros((0, *shape), np.float32)) for shape in shapes))
