"""Ray tracing from cells or portal states of a house, with energy recorded in all cells at once."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.trace.cell_grid import CellGrid
from home_mjx.audio_jax.late_reverb.trace.cells import CELL_FLOOR_GAP
from home_mjx.audio_jax.late_reverb.trace.resampling import resample_rays
from home_mjx.audio_jax.propagation.paths import RAY_OFFSET, air_attenuation
from home_mjx.audio_jax.propagation.surfaces import AcousticSurface, surface_at
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import ARCHITECTURE, BANDS, RayKind

FLIGHT_AXIS = "flights"  # name of the mapped axis of flights
MAX_SEGMENT_SAMPLES = 6  # maximum times at which one segment is recorded; the rest of a longer segment is not
MAX_RAY_LENGTH = 1e4  # [m], maximum length of a segment
INWARD_OFFSET = 0.1  # [m], offset from a surface to a point in the room in front of it
BEHIND_OFFSETS = (0.08, 0.15, 0.25, 0.4)  # [m], offsets from a surface to candidate points in the room behind it
ENTRY_BISECTIONS = 5  # bisections of a segment to find where it enters another room
FLOOR_THICKNESS_RATIO = 2.0  # maximum thickness of floors re walls
MAX_ACTIVE_SHARE = 0.1  # maximum active energy when a flight ends, re the energy that has aged
MIN_ENERGY_SHARE = 1e-6  # the same re the initial energy; the larger limit applies


class RayBatch(NamedTuple):
    """Rays, octave after octave, with equal numbers per octave."""

    origin: Float[Array, "n 3"]
    direction: Float[Array, "n 3"]
    travelled: Float[Array, " n"]  # [m]
    energy: Float[Array, " n"]  # of the ray's own octave, starting from 1
    is_recorded: Float[Array, " n"]  # 0 on segments that early paths render, else 1
    room: Int[Array, " n"]  # current room, or the room that it left
    last_room: Int[Array, " n"]  # room in front of the surface of the last reflection


class TraceEnergy(NamedTuple):
    """Energy sums of the rays of one or several sources."""

    energy: Float[Array, "*s bands c k"]  # re the free field of the source at 1 m, per octave, cell and time bin
    intensity: Float[Array, "*s c k 3"]  # energy-weighted directions of propagation, over all octaves
    # energy from room to room, by bin of passage; diagonal: energy that aged
    portal_energy: Float[Array, "*s bands r r k"]
    path_length: Float[Array, "*s bands r"]  # energy times path length [m] in each room
    absorbed: Float[Array, "*s bands r"]  # energy absorbed by surfaces and air
    exchanged: Float[Array, "*s bands r r"]  # energy from room to room
    transmitted: Float[Array, "*s bands r r"]  # energy that walls would transmit


class TraceResult(NamedTuple):
    """Result of a flight of rays of one or several sources."""

    energy: TraceEnergy
    portal_rays: "PortalRays"  # rays that ended in another room
    aged_rays: "PortalRays"  # rays that ended by age


class _RunningSums(NamedTuple):
    energy: Float[Array, " x"]
    intensity: Float[Array, "x 3"]
    portal_energy: Float[Array, "bands r r k"]
    path_length: Float[Array, "bands r"]
    absorbed: Float[Array, "bands r"]
    exchanged: Float[Array, "bands r r"]
    transmitted: Float[Array, "bands r r"]


class PortalRays(NamedTuple):
    """One ended ray per ray slot, as reflected, with the energy of all rays that ended in the slot."""

    ray: RayBatch  # `travelled`: since the start of the time bin in which it reached the portal state
    entered_room: Int[Array, " n"]  # room entered


def trace_flight(
    scene: Scene,
    grid: CellGrid,
    start: Float[Array, "n 3"],
    direction: Float[Array, "n 3"],
    travelled: Float[Array, " n"],
    room: Int[Array, ""],
    from_source: Bool[Array, ""],
    end_in_rooms: Bool[Array, ""],
    max_bounces: Int[Array, ""],
    age: Float[Array, ""],
    key: Array,
    config: AudioConfig,
    bins: int,
) -> TraceResult:
    """Trace rays and record the energy density in every cell over time, until the rays enter another room.

    Each ray carries one octave and is scattered with that octave's coefficient; energies are not reweighted. A ray is
    recorded at regular times in its current cell, so the energy in a cell is proportional to its volume. Segments that
    early paths render are left out: the direct one, and first-order reflections in architecture. After each reflection
    rays are resampled by energy, see `resample_rays`.

    A ray ends at the first reflection in another room, or by age. Only sound that a source emits directly into another
    room continues there. The portal state is reached at the point where the segment enters that room. The distance from
    there is kept when the ray restarts, because far walls would otherwise reflect without delay.

    The function is mapped over concurrent flights, along the axis `FLIGHT_AXIS`.

    Args:
        scene: Scene of the house.
        grid: Cells of the house.
        start: Start points of rays [m], octave after octave, with equal numbers per octave.
        direction: Unit directions.
        travelled: Distance already travelled from the source or portal state [m].
        room: Room of the start points.
        from_source: Rays start at a source, not at a reflection.
        end_in_rooms: Rays end in other rooms; else they continue there.
        max_bounces: Maximum number of reflections; the energy left then counts as aged.
        age: Path length at which rays end by age [m].
        key: Random key.
        config: Options for `bin_seconds` and air absorption.
        bins: Number of time bins.
    """
    count = start.shape[0]
    octave = jnp.repeat(jnp.arange(len(BANDS), dtype=jnp.int32), count // len(BANDS))
    jitter, draws, turn = jax.random.split(key, 3)
    zero, rooms = jnp.zeros(count, jnp.float32), jnp.broadcast_to(room, (count,))
    first = RayBatch(start, direction, travelled, zero + 1, jnp.where(from_source, zero, 1.0), rooms, rooms)
    nobody = PortalRays(first._replace(energy=zero), rooms)
    metres = config.bin_seconds * config.speed_of_sound
    late = jax.random.uniform(jitter, octave.shape, jnp.float32)
    hear = partial(_record, grid=grid, octave=octave, late=late, metres=metres)
    mirrors = from_source & (config.early.num_reflections > 0)
    air = jnp.asarray(air_attenuation(config))[octave]
    walk = _BounceContext(scene, grid, octave, air, from_source, end_in_rooms, age, mirrors, hear, metres)

    def step(carry: _Carry) -> _Carry:
        return _advance(walk, carry, max_bounces, jax.random.fold_in(draws, carry.bounces))

    def any_flies(carry: _Carry) -> Bool[Array, ""]:
        # A condition per flight would make each bounce copy the sums of all mapped flights, to keep those that ended.
        return jax.lax.pmax(_is_active(carry, max_bounces).astype(jnp.int32), FLIGHT_AXIS) > 0

    end = jax.lax.while_loop(any_flies, step, _Carry(jnp.int32(0), first, nobody, nobody, _zero_sums(grid, bins)))
    return walk.finish(end, jax.random.uniform(turn, (count,), jnp.float32))


def _zero_sums(grid: CellGrid, bins: int) -> _RunningSums:
    cells, pair = grid.volume.shape[0], (len(BANDS), grid.rooms, grid.rooms)
    shapes = ((len(BANDS) * cells * bins,), (cells * bins, 3), (*pair, bins), *(2 * [pair[:2]]), *(2 * [pair]))
    return _RunningSums(*(jnp.zeros(shape, jnp.float32) for shape in shapes))


class _Carry(NamedTuple):
    bounces: Int[Array, ""]
    ray: RayBatch
    portal_rays: PortalRays
    aged_rays: PortalRays
    sums: _RunningSums


def _is_active(carry: _Carry, bounces: Int[Array, ""]) -> Bool[Array, ""]:
    """Return whether a flight continues: reflections are left, and some octave has relevant active energy."""
    left, old = (x.reshape(len(BANDS), -1).sum(axis=1) for x in (carry.ray.energy, carry.aged_rays.ray.energy))
    return (carry.bounces < bounces) & jnp.any(
        left > jnp.maximum(MAX_ACTIVE_SHARE * old, MIN_ENERGY_SHARE * carry.ray.energy.size / len(BANDS))
    )


def _advance(walk: "_BounceContext", carry: _Carry, bounces: Int[Array, ""], key: Array) -> _Carry:
    """Trace one bounce of a flight, or return it unchanged if it has ended while others continue."""
    flies = _is_active(carry, bounces)
    ray = carry.ray._replace(energy=jnp.where(flies, carry.ray.energy, 0.0))
    after = walk.bounce(carry._replace(ray=ray), key)
    return after._replace(ray=jax.tree.map(lambda new, old: jnp.where(flies, new, old), after.ray, carry.ray))


class _BounceContext(NamedTuple):
    """Inputs that all bounces share."""

    scene: Scene
    grid: CellGrid
    octave: Int[Array, " n"]
    air: Float[Array, " n"]  # [1/m]
    from_source: Bool[Array, ""]
    end_in_rooms: Bool[Array, ""]
    age: Float[Array, ""]
    has_mirror_paths: Bool[Array, ""]  # early paths render first-order reflections
    record: Callable[..., _RunningSums]
    bin_length: float  # distance that sound travels in one bin [m]

    def finish(self, end: "_Carry", chance: Float[Array, " n"]) -> TraceResult:
        """Scale the sums of all bounces; rays that are still active count as aged."""
        (count,), cells = self.octave.shape, self.grid.volume.shape[0]
        ray, sums = end.ray, end.sums
        since = _distance_in_bin(ray.travelled / self.bin_length, jnp.zeros(count, jnp.float32), self.bin_length)
        left = _reservoir_update(end.aged_rays, ray._replace(travelled=since), ray.room, chance)
        share = len(BANDS) / count
        scale = 4 * jnp.pi * self.bin_length * share / self.grid.volume
        energy = sums.energy.reshape(len(BANDS), cells, -1) * scale[None, :, None]
        way = sums.intensity.reshape(cells, -1, 3) * scale[:, None, None]
        went = _add_transfer(
            sums.portal_energy, self.octave, ray.room, ray.room, ray.travelled / self.bin_length, ray.energy
        )
        gave = TraceEnergy(energy, way, went * share, *(x * share for x in sums[3:]))
        return TraceResult(gave, end.portal_rays, left)

    def bounce(self, carry: "_Carry", key: Array) -> "_Carry":
        """Trace and record one segment, then reflect the rays at its end."""
        ray, sums = carry.ray, carry.sums
        share, turn, *leave = jax.random.split(key, 5)
        reach = jnp.where(ray.energy > 0, MAX_RAY_LENGTH, -1.0)
        hit = cast(self.scene, ray.origin, ray.direction, t_max=reach, mask=int(RayKind.SOUND))
        met = surface_at(self.scene, ray.direction, hit)
        wall, alive = hit.instance == ARCHITECTURE, hit.instance >= 0
        length = jnp.where(alive, hit.t, 0.0)
        point = ray.origin + length[:, None] * ray.direction
        room = _room_at(point + INWARD_OFFSET * met.normal, self.grid)
        seen = jnp.where(alive & (room >= 0), room, ray.room)
        # Objects reach into walls and beyond, so a room without a portal to the last one needs a second reflection.
        room = jnp.where(self.grid.joined[ray.room, seen] | (seen == ray.last_room), seen, ray.room)
        sums = self.record(sums, ray, length, self.air)
        left = ray.energy * jnp.exp(-self.air * length) * (1 - self._select_octave(met.absorption))
        left = jnp.where(alive, left, 0.0)
        sums = self._add_room_sums(sums, ray, room, length, left)
        sums = self._add_transmission(sums, ray, room, point, met, wall)
        unheard = self.from_source & (ray.travelled == 0)
        origin, flown = point + RAY_OFFSET * met.normal, ray.travelled + length
        goes = self.end_in_rooms & (room != ray.room) & ~unheard
        ages = (flown >= self.age) & ~goes & ~unheard
        direction, _ = _reflect(ray.direction, met.normal, self._select_octave(met.scattering), leave[0])
        inside = jnp.where(goes, _length_inside(ray, length, room, self.grid), 0.0)
        when = (flown - inside) / self.bin_length
        since = _distance_in_bin(when, inside, self.bin_length)
        ended = RayBatch(origin, direction, since, jnp.where(goes, left, 0.0), ray.is_recorded, ray.room, room)
        gone, aged = carry.portal_rays, carry.aged_rays
        chance = (
            jax.random.uniform(leave[1], left.shape, jnp.float32),
            jax.random.uniform(leave[2], left.shape, jnp.float32),
        )
        gone = _reservoir_update(gone, ended, room, chance[0])
        aged = _reservoir_update(aged, ended._replace(energy=jnp.where(ages, left, 0.0), room=room), room, chance[1])
        energy = jnp.where(goes | ages, left, 0.0)
        left_room = jnp.where(ages, room, ray.room)
        sums = sums._replace(
            portal_energy=_add_transfer(sums.portal_energy, self.octave, left_room, room, when, energy)
        )
        left = jnp.where(goes | ages, 0.0, left)

        pick, energy = resample_rays(left, room, self.octave, self.grid.rooms, share)
        direction, mirrored = _reflect(
            ray.direction[pick], met.normal[pick], self._select_octave(met.scattering)[pick], turn
        )
        counts = jnp.where(unheard[pick] & mirrored & wall[pick] & self.has_mirror_paths, 0.0, 1.0)
        ray = RayBatch(origin[pick], direction, flown[pick], energy, counts, room[pick], seen[pick])
        return _Carry(carry.bounces + 1, ray, gone, aged, sums)

    def _add_room_sums(
        self,
        sums: _RunningSums,
        ray: RayBatch,
        room: Int[Array, " n"],
        length: Float[Array, " n"],
        left: Float[Array, " n"],
    ) -> _RunningSums:
        """Add the energy in rooms, its losses and its exchange along a segment."""
        middle = ray.energy * jnp.exp(-0.5 * self.air * length)
        here = 0.5 * middle * length
        lived = sums.path_length.at[self.octave, ray.room].add(here).at[self.octave, room].add(here)
        lost = sums.absorbed.at[self.octave, room].add(ray.energy - left)
        moved = sums.exchanged.at[self.octave, ray.room, room].add(jnp.where(room != ray.room, middle, 0.0))
        return sums._replace(path_length=lived, absorbed=lost, exchanged=moved)

    def _add_transmission(
        self,
        sums: _RunningSums,
        ray: RayBatch,
        room: Int[Array, " n"],
        point: Float[Array, "n 3"],
        met: AcousticSurface,
        wall: Bool[Array, " n"],
    ) -> _RunningSums:
        """Add the energy transmitted by walls, floors and ceilings to the room behind them."""
        behind = jnp.full(room.shape, -1, jnp.int32)
        across = jnp.where(jnp.abs(met.normal[:, 2:]) < 0.5, 1.0, FLOOR_THICKNESS_RATIO)
        for depth in BEHIND_OFFSETS[::-1]:
            found = _room_at(point - depth * across * met.normal, self.grid)
            behind = jnp.where((found >= 0) & (found != room), found, behind)
        counts = wall & (behind >= 0)
        length = jnp.linalg.norm(point - ray.origin, axis=1)
        energy = ray.energy * jnp.exp(-self.air * length) * self._select_octave(met.transmission)
        behind = jnp.maximum(behind, 0)
        return sums._replace(
            transmitted=sums.transmitted.at[self.octave, room, behind].add(jnp.where(counts, energy, 0.0))
        )

    def _select_octave(self, values: Float[Array, "n bands"]) -> Float[Array, " n"]:
        """Select the values of each ray's octave."""
        return jnp.take_along_axis(values, self.octave[:, None], axis=1)[:, 0]


def _reflect(
    direction: Float[Array, "n 3"], normal: Float[Array, "n 3"], scattering: Float[Array, " n"], key: Array
) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
    """Sample specular or Lambertian directions; return them and a mask of the specular ones."""
    choice, scatter = jax.random.split(key)
    mirrors = jax.random.uniform(choice, scattering.shape, jnp.float32) >= scattering
    ball = jax.random.normal(scatter, direction.shape, jnp.float32)
    lambert = normal + ball / jnp.linalg.norm(ball, axis=1, keepdims=True)
    lambert = lambert / jnp.maximum(jnp.linalg.norm(lambert, axis=1, keepdims=True), 1e-6)
    mirrored = direction - 2 * jnp.sum(direction * normal, axis=1, keepdims=True) * normal
    return jnp.where(mirrors[:, None], mirrored, lambert), mirrors


def _record(
    sums: _RunningSums,
    ray: RayBatch,
    length: Float[Array, " n"],
    air: Float[Array, " n"],
    *,
    grid: CellGrid,
    octave: Int[Array, " n"],
    late: Float[Array, " n"],
    metres: float,
) -> _RunningSums:
    """Record each ray's segment in cells, at the times (k + late) bins within it."""
    heard, way = sums.energy, sums.intensity
    cells = grid.volume.shape[0]
    bins = heard.shape[0] // cells // len(BANDS)
    index = jnp.ceil(ray.travelled / metres - late) + jnp.arange(MAX_SEGMENT_SAMPLES, dtype=jnp.float32)[:, None]
    along = (index + late) * metres - ray.travelled
    point = ray.origin + along[..., None] * ray.direction
    cell = _cell_at(point.reshape(-1, 3), grid).reshape(along.shape)
    inside = (along < length) & (cell >= 0) & (index < bins) & (ray.is_recorded > 0)
    inside = inside & (point[..., 2] >= grid.low[cell]) & (point[..., 2] < grid.high[cell])
    energy = jnp.where(inside, ray.energy * jnp.exp(-air * along), 0.0)
    index = index.astype(jnp.int32)
    place = (octave * cells + cell) * bins + index
    heard = heard.at[jnp.where(inside, place, heard.shape[0])].add(energy, mode="drop")
    place = jnp.where(inside, cell * bins + index, way.shape[0])
    way = way.at[place].add(energy[..., None] * ray.direction, mode="drop")
    return sums._replace(energy=heard, intensity=way)


def _reservoir_update(
    kept: PortalRays, ray: RayBatch, entered: Int[Array, " n"], chance: Float[Array, " n"]
) -> PortalRays:
    """Keep one ended ray per slot, drawn by energy, with the sum of energies: reservoir sampling (Chao 1982).

    Element i of each argument is of slot i; the energy in `ray` is 0 if its ray does not end. `entered` is the room
    entered, and `chance` is uniform in [0, 1).
    """
    total = kept.ray.energy + ray.energy
    taken = chance * total < ray.energy
    new = PortalRays(ray, entered)
    kept = jax.tree.map(lambda a, b: jnp.where(taken.reshape(-1, *(a.ndim - 1) * [1]), a, b), new, kept)
    return kept._replace(ray=kept.ray._replace(energy=total))


def _add_transfer(
    went: Float[Array, "bands r r k"],
    octave: Int[Array, " n"],
    room: Int[Array, " n"],
    other: Int[Array, " n"],
    bins: Float[Array, " n"],
    energy: Float[Array, " n"],
) -> Float[Array, "bands r r k"]:
    """Add energy from room to room, in the bin of its passage; `_distance_in_bin` has the fraction of the bin."""
    return went.at[octave, room, other, bins.astype(jnp.int32)].add(energy, mode="drop")


def _distance_in_bin(when: Float[Array, " n"], inside: Float[Array, " n"], metres: float) -> Float[Array, " n"]:
    """Return the distance travelled since the start of the bin in which a portal state was reached [m].

    Rays restart with it. Otherwise, rounding down to whole bins would lose half a bin at each portal state.

    Args:
        when: Time at which the state was reached [bins].
        inside: Distance travelled since that time [m].
        metres: Distance that sound travels in one bin [m].
    """
    return inside + (when - jnp.floor(when)) * metres


def _length_inside(
    ray: RayBatch, length: Float[Array, " n"], room: Int[Array, " n"], grid: CellGrid
) -> Float[Array, " n"]:
    """Return the length of each segment inside the room where it ends [m], by bisection."""
    low, high = jnp.zeros_like(length), length
    for _ in range(ENTRY_BISECTIONS):
        middle = (low + high) / 2
        there = _room_at(ray.origin + middle[:, None] * ray.direction, grid) == room
        low, high = jnp.where(there, low, middle), jnp.where(there, middle, high)
    return length - high


def _room_at(point: Float[Array, "n 3"], grid: CellGrid) -> Int[Array, " n"]:
    """Return the room over whose floor each point is; -1 if none."""
    cell = _cell_at(point, grid)
    return jnp.where(cell >= 0, grid.room[cell], -1)


def _cell_at(point: Float[Array, "n 3"], grid: CellGrid) -> Int[Array, " n"]:
    """Return the cell over whose floor each point is, on the highest storey below it; -1 if none."""
    at = jnp.floor((point[:, :2] - grid.origin[None]) / grid.step).astype(jnp.int32)
    levels, rows, columns = grid.lookup.shape
    there = (at[:, 0] >= 0) & (at[:, 0] < columns) & (at[:, 1] >= 0) & (at[:, 1] < rows)
    found = jnp.full(point.shape[0], -1, jnp.int32)
    for level in range(levels):
        cell = grid.lookup[level, jnp.clip(at[:, 1], 0, rows - 1), jnp.clip(at[:, 0], 0, columns - 1)]
        above = point[:, 2] >= grid.low[cell] - (CELL_FLOOR_GAP + INWARD_OFFSET)
        found = jnp.where(there & (cell >= 0) & above, cell, found)
    return found
