"""Flights of several sources on a GPU, and their sums per source: `FlightTracer` for `flight.cu`."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.cuda.device import DeviceHouse
from home_mjx.audio_jax.late_reverb.cuda.kernels import BLOCK, LANES
from home_mjx.audio_jax.late_reverb.trace.flight import PLACE as KEPT_PLACE
from home_mjx.audio_jax.late_reverb.trace.tracer import (
    MAX_BOUNCES_PER_METRE,
    NO_ENDED_RAYS,
    EndedRays,
    FlightStart,
    FlightTracer,
    SourceSums,
)
from home_mjx.core.native.cuda_driver import DeviceArray, pack_words
from home_mjx.schema.compiled import BANDS

PLACE, NOTES = 12, 4  # as in flight.cu, like the next ones
TEAM = 256
FINE, COARSE = 2.0**42, 2.0**36
OCTAVES, RECORDED = len(BANDS), len(BANDS) + 3
SHARED_WORD = 8  # [bytes]
FULL_RAYS = 1 << 14  # rays of energy 1 in a flight; more have less, or sums of integers might overflow
FLIGHT_BIT, BOUNCE_BIT = 48, 28  # of the keys of ended rays
MAX_BOUNCES, MAX_FLIGHTS = 1 << (FLIGHT_BIT - BOUNCE_BIT), 1 << (63 - FLIGHT_BIT)


@dataclass(frozen=True)
class _Batch:
    """Flights that are traced together; arrays of all rays, flight by flight."""

    first: Int[np.ndarray, " f1"]
    flight: Int[np.ndarray, " n"]
    place: Float[np.ndarray, "2 n place"]
    energy: Float[np.ndarray, "2 n lanes"]
    notes: Int[np.ndarray, "2 n notes"]
    room: Int[np.ndarray, " f"]
    age: Float[np.ndarray, " f"]
    limit: Int[np.ndarray, " f"]  # maximum bounces
    unit: float  # energy of a ray of energy 1 on the GPU, a power of two


@dataclass(frozen=True)
class DeviceTracer(FlightTracer):
    """Ray tracer of one house on a GPU: the estimator of `FlightTracer` with other random numbers.

    Attributes:
        device: The house on the GPU.
    """

    device: DeviceHouse

    def trace(
        self,
        starts: Sequence[FlightStart],
        bins: int,
        seed: int,
        from_source: bool = False,
        end_in_rooms: bool = True,
        keeps_ended: bool = False,
    ) -> tuple[SourceSums, list[EndedRays]]:
        """Trace flights as `FlightTracer.trace` does; energies of cells stay on the GPU.

        Rows of sums have as many numbers as they need.

        The result has the same bits in every run on one kind of GPU.

        Raises:
            BackendError: The GPU fails.
        """
        batch = self._batch(starts, from_source)
        sums = self._zero_sums(len(starts), bins)
        bounces = int(batch.limit.max(initial=0))
        kept = (bounces + 1) * len(batch.flight) if keeps_ended else 0
        shapes = (kept, LANES), (kept, LANES), (kept, 2), (kept,), (1,)
        types = np.float32, np.float32, np.int32, np.int64, np.uint64
        ended = [self.device.stream.empty(shape, kind) for shape, kind in zip(shapes[:4], types, strict=False)]
        ended.append(self.device.stream.zeros(*shapes[4:], types[4]))
        self._fly(batch, bounces, (seed, bins, from_source, end_in_rooms, kept), sums, ended)
        found = self._scale(sums, starts, bins, batch.unit)
        return found, self._read_ended(ended, len(starts), batch.unit) if keeps_ended else []

    def _batch(self, starts: Sequence[FlightStart], from_source: bool) -> _Batch:
        """Return the rays of all sources as one batch."""
        counts = [len(one.origin) for one in starts]
        total, first = sum(counts), np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int64)
        unit = 2.0 ** -np.ceil(np.log2(max(max(counts, default=1) / FULL_RAYS, 1)))
        place, energy = np.zeros((2, total, PLACE), np.float32), np.zeros((2, total, LANES), np.float32)
        notes = np.zeros((2, total, NOTES), np.int32)
        for start, one in zip(first, starts, strict=False):
            rows = slice(start, start + len(one.origin))
            place[1, rows, :3], place[1, rows, 3:6], place[1, rows, 9] = one.origin, one.direction, one.travelled
            energy[1, rows, :OCTAVES] = one.energy * unit
            notes[1, rows] = 0, one.room, from_source, one.room
        age = np.array([one.age for one in starts], np.float32)
        limit = np.minimum(MAX_BOUNCES_PER_METRE * age.astype(float), min(self.max_bounces, MAX_BOUNCES - 1))
        room = np.array([one.room for one in starts], np.int32)
        flight = np.repeat(np.arange(len(starts), dtype=np.int32), counts)
        return _Batch(first, flight, place, energy, notes, room, age, limit.astype(np.int32), unit)

    def _zero_sums(self, sources: int, bins: int) -> list[DeviceArray]:
        """Return zero sums of integers, in the order of `SourceSums`."""
        cells, rooms = len(self.volume), len(self.grid.joined)
        shapes = (cells, bins, RECORDED), (rooms, rooms, bins, OCTAVES), *(2 * [(rooms, OCTAVES)])
        every = *shapes, *(2 * [(rooms, rooms, OCTAVES)])
        return [self.device.stream.zeros((sources, *shape), np.int64) for shape in every]

    def _fly(
        self,
        batch: _Batch,
        bounces: int,
        rules: tuple[int, int, bool, bool, int],
        sums: Sequence[DeviceArray],
        ended: Sequence[DeviceArray],
    ) -> None:
        """Queue the kernels of all bounces; `rules`: seed, bins, from_source, end_in_rooms, kept."""
        stream, (seed, bins, from_source, ends, kept) = self.device.stream, rules
        flights, rays, rooms = len(batch.limit), len(batch.flight), len(self.grid.joined)
        seeds = np.random.SeedSequence(seed).generate_state(max(flights, 1), np.uint64)
        air = np.pad(np.asarray(self.air, np.float32), (0, LANES - OCTAVES))
        joined = self.grid.joined.astype(np.uint8)
        grid = *map(stream.upload, (*self.grid[:4], joined, air)), *self.grid.lookup.shape, rooms, len(self.volume)
        lengths = (*map(float, (*self.grid.origin, self.grid.step, self.bin_length)),)
        each = (*map(stream.upload, (batch.first, seeds, batch.age, batch.limit, batch.flight)),)
        state = *map(stream.upload, (batch.place, batch.energy, batch.notes)), stream.empty((rays,), np.float64)
        factor, balance = (
            stream.zeros((flights, rooms, LANES), np.float32),
            stream.zeros((flights, 2, LANES), np.float32),
        )
        aged = stream.zeros((flights, LANES), np.int64)
        counts = kept, flights, rays, bins, from_source, ends
        fields = *self.device.fields, *grid, *lengths, *each, *state, factor, balance, aged, *sums, *ended, *counts, -1
        words, blocks, shared = pack_words(fields), -(-rays // BLOCK), SHARED_WORD * rooms * OCTAVES
        stream.launch("resample_flights", flights, TEAM, words, shared)
        for bounce in range(bounces):
            words[-1] = bounce
            stream.launch("trace_segments", blocks, BLOCK, words)
            stream.launch("resample_flights", flights, TEAM, words, shared)
        stream.launch("finish_flights", blocks, BLOCK, words)

    def _scale(
        self, sums: Sequence[DeviceArray], starts: Sequence[FlightStart], bins: int, one_ray: float
    ) -> SourceSums:
        """Return sums for energy 1 per octave of each source, those of cells as energy densities re the free field.

        `one_ray`: energy of a ray of energy 1 on the GPU.
        """
        stream = self.device.stream
        unit = np.zeros((len(starts), RECORDED), np.float32)
        for row, one in zip(unit, starts, strict=True):
            whole = one.energy.sum(axis=0, dtype=float)
            row[:OCTAVES] = np.where(whole > 0, 1 / np.maximum(whole * one_ray, 1e-30), 0)
            row[OCTAVES:] = row.max()
        density = stream.upload((4 * np.pi * self.bin_length / self.volume).astype(np.float32))
        units = stream.upload(unit), stream.upload(unit[:, :OCTAVES])
        found = []
        for number, one in enumerate(sums):
            out, lanes = stream.empty(one.shape, np.float32), one.shape[-1]
            count, scale = int(np.prod(one.shape)), 1 / (FINE if number < 2 else COARSE)
            inner = 0 if number else bins * RECORDED
            fields = one, out, units[number > 0], density, count, count // max(len(starts), 1), lanes, inner, scale
            stream.launch("scale_sums", -(-count // BLOCK), BLOCK, pack_words(fields))
            found.append(stream.download(out) if number else out)
        return SourceSums(*found)

    def _read_ended(self, ended: Sequence[DeviceArray], flights: int, one_ray: float) -> list[EndedRays]:
        """Return the ended rays of each flight, by bounce, then by ray; `one_ray` as in `_scale`."""
        stream = self.device.stream
        count = min(int(stream.download(ended[4])[0]), ended[3].shape[0])
        place, energy, rooms, key = (stream.download(x, count) for x in ended[:4])
        order = np.argsort(key)
        cuts = np.searchsorted(key[order], np.arange(1, flights) << FLIGHT_BIT)
        place, energy, rooms = place[order, :KEPT_PLACE], energy[order, :OCTAVES] / np.float32(one_ray), rooms[order]
        if not flights:
            return [NO_ENDED_RAYS][:0]
        return [EndedRays(*one) for one in zip(*(np.split(x, cuts) for x in (place, energy, rooms)), strict=True)]
