"""Flights of several sources on all cores, and their sums per source."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types of the private functions)

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple, no_type_check

import numpy as np
from jaxtyping import Bool, Float, Int
from numba import njit, types

from home_mjx.audio_jax.late_reverb.trace import cells, flight, house_rays
from home_mjx.audio_jax.late_reverb.trace.cells import Cells
from home_mjx.audio_jax.late_reverb.trace.flight import NUM_OCTAVES, PLACE
from home_mjx.audio_jax.late_reverb.trace.house_rays import CAST_MODULES, CastScene, HouseRays, addresses, ray_memory
from home_mjx.core.native import ffi
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.core.native.simd import LANES, load
from home_mjx.core.workers import map_threads
from home_mjx.schema import compiled as compiled_house

MAX_BOUNCES_PER_METRE = 1.0  # maximum reflections per metre of age: flights end by age, as rays rarely reflected last
floats, doubles, integers = map(pointer_to, (types.float32, types.float64, types.int32))
flags, words, naturals = map(pointer_to, (types.uint8, types.int64, types.uint64))
compiled = compile_inner()


class FlightStart(NamedTuple):
    """Start of the rays of one source: positions [m], unit directions, energies per octave, room."""

    origin: Float[np.ndarray, "n 3"]
    direction: Float[np.ndarray, "n 3"]
    travelled: Float[np.ndarray, " n"]  # since the start of the bin in which it reached a portal state [m]
    energy: Float[np.ndarray, "n bands"]
    room: int
    age: float  # path length at which rays end by age [m]


class SourceSums(NamedTuple):
    """Sums over the rays of several sources, each of energy 1 per octave; vectors hold octaves in their first lanes."""

    # Energy of octaves re the free field of the source at 1 m, per cell and time bin. Three more lanes hold the energy
    # of all octaves times the direction of propagation. float32 (s c k lanes), on the device that traced the rays.
    energy: Any
    # Energy from room to room, by bin of passage; diagonal: energy that aged
    portal: Float[np.ndarray, "s r r k lanes"]
    path_length: Float[np.ndarray, "s r lanes"]  # energy times path length [m] in each room
    absorbed: Float[np.ndarray, "s r lanes"]  # energy absorbed by surfaces and air
    exchanged: Float[np.ndarray, "s r r lanes"]  # energy from room to room
    transmitted: Float[np.ndarray, "s r r lanes"]  # energy that walls would transmit


class EndedRays(NamedTuple):
    """Rays that left a room or aged, as reflected."""

    place: Float[np.ndarray, "m 7"]  # origin, direction, distance since the start of the bin of the portal state [m]
    energy: Float[np.ndarray, "m bands"]
    rooms: Int[np.ndarray, "m 2"]  # left and entered; equal if aged


class CellGrid(NamedTuple):
    """Cells of a house, as rays read them; fields are those of `Cells`."""

    lookup: Int[np.ndarray, "levels rows columns"]
    low: Float[np.ndarray, " n"]  # [m]
    high: Float[np.ndarray, " n"]  # [m]
    room: Int[np.ndarray, " n"]
    joined: Bool[np.ndarray, "r r"]  # pairs of rooms that share a portal
    origin: Float[np.ndarray, " 2"]
    step: float  # [m]


NO_ENDED_RAYS = EndedRays(
    np.zeros((0, PLACE), np.float32), np.zeros((0, NUM_OCTAVES), np.float32), np.zeros((0, 2), np.int32)
)


def make_grid(divided: Cells, joined: Bool[np.ndarray, "r r"]) -> CellGrid:
    """Return cells as rays read them; `joined` are pairs of rooms that share a portal."""
    lookup, room = (np.ascontiguousarray(x, np.int32) for x in (divided.lookup, divided.room))
    low, high = (np.ascontiguousarray(x, np.float32) for x in (divided.low, divided.high))
    return CellGrid(lookup, low, high, room, joined, divided.origin, float(divided.step))


@dataclass(frozen=True)
class FlightTracer:
    """Ray tracer of one house.

    Attributes:
        house: Arrays of the house.
        grid: Cells of the house.
        air: Energy attenuation of air per octave [1/m].
        bin_length: Distance that sound travels in one bin [m].
        volume: Free volume of each cell [m³].
        max_bounces: Maximum reflections of a ray.
    """

    house: HouseRays
    grid: CellGrid
    air: Float[np.ndarray, " bands"]
    bin_length: float
    volume: Float[np.ndarray, " c"]
    max_bounces: int

    def trace(
        self,
        starts: Sequence[FlightStart],
        bins: int,
        seed: int,
        from_source: bool = False,
        end_in_rooms: bool = True,
        keeps_ended: bool = False,
    ) -> tuple[SourceSums, list[EndedRays]]:
        """Trace the flights of some sources; return their sums, and per source the rays that ended, if `keeps_ended`.

        Every source is traced by one thread, in the order of its rays: the result has the same bits with any number of
        threads.

        Args:
            starts: Rays of each source; a source may have none.
            bins: Number of time bins.
            seed: Seed of all flights.
            from_source: Rays start at sources, not at reflections.
            end_in_rooms: Rays end in other rooms; else they continue there.
            keeps_ended: Return the rays that left their room or aged; else the list is empty.
        """
        sums = _empty_sums(len(starts), len(self.volume), len(self.grid.joined), bins)
        seeds = np.random.SeedSequence(seed).generate_state(max(len(starts), 1), np.uint64)

        def run(source: int) -> EndedRays:
            """Trace and normalise one source."""
            one, mine = starts[source], SourceSums(*(x[source] for x in sums))
            bounces = int(min(MAX_BOUNCES_PER_METRE * one.age, self.max_bounces))
            kept = (bounces + 1) * len(one.origin) if keeps_ended else 0
            rules = flight.FlightRules(
                np.int64(one.room),
                np.bool_(from_source),
                np.bool_(end_in_rooms),
                np.float32(one.age),
                np.int64(bounces),
                np.int64(len(one.origin)),
                np.int64(bins),
                np.int64(kept),
                np.float32(self.bin_length),
            )
            ended = self._fly(one, rules, mine, seeds[source])
            self._normalise(mine, one.energy)
            return ended

        longest = sorted(range(len(starts)), key=lambda s: -len(starts[s].origin) * min(starts[s].age, 1e3))
        found = dict(zip(longest, map_threads(run, longest), strict=True))
        return sums, [found[source] for source in range(len(starts))] if keeps_ended else []

    def _fly(self, one: FlightStart, rules: flight.FlightRules, sums: SourceSums, seed: np.uint64) -> EndedRays:
        """Trace one flight in this thread: add to `sums`, return the kept ended rays."""
        count, rooms, kept = len(one.origin), len(self.grid.joined), int(rules.kept)
        rays = _rays(count)
        for array, value in zip(rays, (*one[:3], 0, not rules.from_source, one.room, one.room), strict=True):
            array[:] = value
        rays[3][:, :NUM_OCTAVES] = one.energy
        ended = np.empty((kept, PLACE), np.float32), np.empty((kept, LANES), np.float32), np.empty((kept, 2), np.int32)
        air = np.zeros(LANES, np.float32)
        air[:NUM_OCTAVES] = self.air
        arrays = (
            *(self.house.operands(), *self.house.surfaces, *self.grid[:5], air),
            *(*rays, *_rays(count), *sums, *ended, *_scratch(count, rooms), *ray_memory(count)),
        )
        sizes = (*map(np.int64, (*self.grid.lookup.shape, rooms, len(self.house.surfaces[-1]))),)
        place = (*map(np.float32, (*self.grid.origin, self.grid.step)),)
        filled = _fly_source(addresses(arrays), self.house.sizes, sizes, place, rules, seed)
        return EndedRays(ended[0][:filled].copy(), ended[1][:filled, :NUM_OCTAVES].copy(), ended[2][:filled].copy())

    def _normalise(self, sums: SourceSums, energy: Float[np.ndarray, "n bands"]) -> None:
        """Scale a source's sums in place to energy 1, and those of cells to energy densities re the free field.

        Octaves without energy become 0.
        """
        unit = np.zeros(LANES, np.float32)
        whole = energy.sum(axis=0, dtype=float)
        unit[:NUM_OCTAVES] = np.where(whole > 0, 1 / np.maximum(whole, 1e-30), 0)
        for x in sums[1:]:
            for room in np.flatnonzero(x.reshape(len(x), -1).any(axis=1)):  # writing zeros would take their memory
                x[room] *= unit
        unit[NUM_OCTAVES : NUM_OCTAVES + 3] = unit.max()
        density = (4 * np.pi * self.bin_length / self.volume).astype(np.float32)
        for cell in np.flatnonzero(sums.energy.any(axis=(1, 2))):
            sums.energy[cell] *= density[cell] * unit


def _rays(count: int) -> tuple[np.ndarray, ...]:
    """Return uninitialized memory of `flight.FlightRays` for `count` rays."""
    return (
        *(np.empty((count, 3), np.float32), np.empty((count, 3), np.float32), np.empty(count, np.float32)),
        *(np.empty((count, LANES), np.float32), np.empty(count, np.uint8)),
        *(np.empty(count, np.int32), np.empty(count, np.int32)),
    )


def _scratch(count: int, rooms: int) -> tuple[np.ndarray, ...]:
    """Return memory of `flight.Scratch` for `count` rays in a house of `rooms` rooms."""
    return (
        *(np.empty((count, 3), np.float32), np.zeros(count, np.int32), np.empty(count, np.uint8)),
        *(np.empty(count, np.int32), np.empty(count, np.float32), np.empty(count)),
        *(np.empty((3, LANES), np.float32), np.empty((rooms, LANES), np.float32), np.empty(1, np.uint64)),
    )


def _empty_sums(sources: int, cells: int, rooms: int, bins: int) -> SourceSums:
    """Return zero sums of the shapes of `SourceSums`."""
    shapes = (cells, bins), (rooms, rooms, bins), *(2 * [(rooms,)]), *(2 * [(rooms, rooms)])
    return SourceSums(*(np.zeros((sources, *shape, LANES), np.float32) for shape in shapes))


@verify_cache_once
@no_type_check
def _fly_source(at, rows, sizes, place, rules, seed):
    """Call the compiled `_fly_at`, return the number of kept ended rays; verifies Numba's disk cache once."""
    return _compiled_flight()(at, rows, sizes, place, rules, seed)


@cache
def _compiled_flight() -> Any:
    """Return the compiled `fly`, from Numba's disk cache if it is there."""
    # Numba's cache checks this file and the values that a function closes over: the digest stands for other files.
    parts: tuple[Any, ...] = (*CAST_MODULES, cells, compiled_house, flight, house_rays)
    digest = ffi.hash_sources(*(part.__file__ for part in parts))

    @njit(error_model="numpy", nogil=True, cache=True)
    @no_type_check
    def fly(at, rows, sizes, place, rules, seed):
        """Call `_fly_at`."""
        _ = digest
        return _fly_at(at, rows, sizes, place, rules, seed)

    return fly


@compiled
@no_type_check
def _fly_at(at, rows, sizes, place, rules, seed):
    """Call `flight.fly` for arrays at addresses `at`, in the order of `FlightTracer._fly`, and return its result."""
    surfaces = flight.Surfaces(
        floats(at[1]), integers(at[2]), floats(at[3]), integers(at[4]), floats(at[5]), floats(at[6]), floats(at[7]),
        sizes[4],
    )  # fmt: skip
    grid = flight.Grid(
        integers(at[8]), floats(at[9]), floats(at[10]), integers(at[11]), flags(at[12]), *sizes[:4], *place
    )
    sums = flight.FlightSums(
        floats(at[28]), floats(at[29]), floats(at[30]), floats(at[31]), floats(at[32]), floats(at[33])
    )
    ended = flight.EndedMemory(floats(at[34]), floats(at[35]), integers(at[36]))
    scratch = flight.Scratch(
        floats(at[37]), integers(at[38]), flags(at[39]), integers(at[40]), floats(at[41]), doubles(at[42]),
        floats(at[43]), floats(at[44]), naturals(at[45]),
    )  # fmt: skip
    everything = flight.Flight(surfaces, grid, load(floats(at[13]), 0), rules, sums, ended, scratch)
    scene, memory = CastScene(words(at[0]), rows), house_rays.read_memory(at, 46)
    return flight.fly(scene, everything, _read_rays(at, 14), _read_rays(at, 21), memory, seed)


@compiled
@no_type_check
def _read_rays(at, first):
    """Return the `FlightRays` whose arrays are at seven successive addresses."""
    return flight.FlightRays(
        floats(at[first]), floats(at[first + 1]), floats(at[first + 2]), floats(at[first + 3]), flags(at[first + 4]),
        integers(at[first + 5]), integers(at[first + 6]),
    )  # fmt: skip
