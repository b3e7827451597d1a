"""Ray tracing from cells or portal states of a house, with energy recorded in all cells at once."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.trace.cells import FROM_FLOOR
from home_mjx.audio_jax.late_reverb.trace.grid import Grid
from home_mjx.audio_jax.late_reverb.trace.split import share_out
from home_mjx.audio_jax.propagation.paths import SKIN, air_energy
from home_mjx.audio_jax.propagation.surfaces import AcousticSurface, surface_at
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import ARCHITECTURE, BANDS, Ray

FLIGHTS = "flights"  # name of the mapped axis of flights
STAMPS = 6  # maximum times at which one segment is recorded; the rest of a longer segment is not
FAR = 1e4  # [m], maximum length of a segment
INWARD = 0.1  # [m], offset from a surface to a point in the room in front of it
BEHIND = (0.08, 0.15, 0.25, 0.4)  # [m], offsets from a surface to candidate points in the room behind it
HALVINGS = 5  # bisections of a segment to find where it enters another room
FLOORS = 2.0  # maximum thickness of floors re walls
FEW = 0.1  # maximum active energy when a flight ends, re the energy that has aged
FAINT = 1e-6  # the same re the initial energy; the larger limit applies


class Rays(NamedTuple):
    """Rays, octave after octave, with equal numbers per octave."""

    origin: Float[Array, "n 3"]
    direction: Float[Array, "n 3"]
    travelled: Float[Array, " n"]  # [m]
    energy: Float[Array, " n"]  # of the ray's own octave, starting from 1
    counts: Float[Array, " n"]  # 0 on segments that early paths render, else 1
    room: Int[Array, " n"]  # current room, or the room that it left
    last: Int[Array, " n"]  # room in front of the surface of the last reflection


class Gave(NamedTuple):
    """Energy sums of the rays of one or several sources."""

    energy: Float[Array, "*s bands c k"]  # re the free field of the source at 1 m, per octave, cell and time bin
    way: Float[Array, "*s c k 3"]  # energy-weighted directions of propagation, over all octaves
    went: Float[Array, "*s bands r r k"]  # energy from room to room, by bin of passage; diagonal: energy that aged
    lived: Float[Array, "*s bands r"]  # energy times path length [m] in each room
    lost: Float[Array, "*s bands r"]  # energy absorbed by surfaces and air
    moved: Float[Array, "*s bands r r"]  # energy from room to room
    through: Float[Array, "*s bands r r"]  # energy that walls would transmit


class Flown(NamedTuple):
    """Result of a flight of rays of one or several sources."""

    gave: Gave
    gone: "Gone"  # rays that ended in another room
    aged: "Gone"  # rays that ended by age


class _Sums(NamedTuple):
    heard: Float[Array, " x"]
    way: Float[Array, "x 3"]
    went: Float[Array, "bands r r k"]
    lived: Float[Array, "bands r"]
    lost: Float[Array, "bands r"]
    moved: Float[Array, "bands r r"]
    through: Float[Array, "bands r r"]


class Gone(NamedTuple):
    """One ended ray per ray slot, as reflected, with the energy of all rays that ended in the slot."""

    ray: Rays  # `travelled`: since the start of the time bin in which it reached the portal state
    entered: Int[Array, " n"]  # room entered


def fly(
    scene: Scene,
    grid: Grid,
    start: Float[Array, "n 3"],
    direction: Float[Array, "n 3"],
    travelled: Float[Array, " n"],
    room: Int[Array, ""],
    fresh: Bool[Array, ""],
    ends: Bool[Array, ""],
    bounces: Int[Array, ""],
    age: Float[Array, ""],
    key: Array,
    config: AudioConfig,
    bins: int,
) -> Flown:
    """Trace rays and record the energy density in every cell over time, until the rays enter another room.

    Each ray carries one octave and is scattered with that octave's coefficient; energies are not reweighted. A ray is
    recorded at regular times in its current cell, so the energy in a cell is proportional to its volume. Segments that
    early paths render are left out: the direct one, and first-order reflections in architecture. After each reflection
    rays are resampled by energy, see `share_out`.

    A ray ends at the first reflection in another room, or by age. Only sound that a source emits directly into another
    room continues there. The portal state is reached at the point where the segment enters that room. The distance from
    there is kept when the ray restarts, because far walls would otherwise reflect without delay.

    The function is mapped over concurrent flights, along the axis `FLIGHTS`.

    Args:
        scene: Scene of the house.
        grid: Cells of the house.
        start: Start points of rays [m], octave after octave, with equal numbers per octave.
        direction: Unit directions.
        travelled: Distance already travelled from the source or portal state [m].
        room: Room of the start points.
        fresh: Rays start at a source, not at a reflection.
        ends: Rays end in other rooms; else they continue there.
        bounces: Maximum number of reflections; the energy left then counts as aged.
        age: Path length at which rays end by age [m].
        key: Random key.
        config: Options for `bin_seconds` and air absorption.
        bins: Number of time bins.
    """
    count = start.shape[0]
    octave = jnp.repeat(jnp.arange(len(BANDS), dtype=jnp.int32), count // len(BANDS))
    jitter, draws, turn = jax.random.split(key, 3)
    zero, rooms = jnp.zeros(count, jnp.float32), jnp.broadcast_to(room, (count,))
    first = Rays(start, direction, travelled, zero + 1, jnp.where(fresh, zero, 1.0), rooms, rooms)
    nobody = Gone(first._replace(energy=zero), rooms)
    metres = config.bin_seconds * config.speed_of_sound
    late = jax.random.uniform(jitter, octave.shape, jnp.float32)
    hear = partial(_hear, grid=grid, octave=octave, late=late, metres=metres)
    mirrors = fresh & (config.num_reflections > 0)
    air = jnp.asarray(air_energy(config))[octave]
    walk = _Walk(scene, grid, octave, air, fresh, ends, age, mirrors, hear, metres)

    def step(carry: _Carry) -> _Carry:
        return _goes_on(walk, carry, bounces, jax.random.fold_in(draws, carry.bounces))

    def any_flies(carry: _Carry) -> Bool[Array, ""]:
        # A condition per flight would make each bounce copy the sums of all mapped flights, to keep those that ended.
        return jax.lax.pmax(_flies(carry, bounces).astype(jnp.int32), FLIGHTS) > 0

    end = jax.lax.while_loop(any_flies, step, _Carry(jnp.int32(0), first, nobody, nobody, _no_sums(grid, bins)))
    return walk.flown(end, jax.random.uniform(turn, (count,), jnp.float32))


def _no_sums(grid: Grid, bins: int) -> _Sums:
    cells, pair = grid.volume.shape[0], (len(BANDS), grid.rooms, grid.rooms)
    shapes = ((len(BANDS) * cells * bins,), (cells * bins, 3), (*pair, bins), *(2 * [pair[:2]]), *(2 * [pair]))
    return _Sums(*(jnp.zeros(shape, jnp.float32) for shape in shapes))


class _Carry(NamedTuple):
    bounces: Int[Array, ""]
    ray: Rays
    gone: Gone
    aged: Gone
    sums: _Sums


def _flies(carry: _Carry, bounces: Int[Array, ""]) -> Bool[Array, ""]:
    """Return whether a flight continues: reflections are left, and some octave has relevant active energy."""
    left, old = (x.reshape(len(BANDS), -1).sum(axis=1) for x in (carry.ray.energy, carry.aged.ray.energy))
    return (carry.bounces < bounces) & jnp.any(
        left > jnp.maximum(FEW * old, FAINT * carry.ray.energy.size / len(BANDS))
    )


def _goes_on(walk: "_Walk", carry: _Carry, bounces: Int[Array, ""], key: Array) -> _Carry:
    """Trace one bounce of a flight, or return it unchanged if it has ended while others continue."""
    flies = _flies(carry, bounces)
    ray = carry.ray._replace(energy=jnp.where(flies, carry.ray.energy, 0.0))
    after = walk.bounce(carry._replace(ray=ray), key)
    return after._replace(ray=jax.tree.map(lambda new, old: jnp.where(flies, new, old), after.ray, carry.ray))


class _Walk(NamedTuple):
    """Inputs that all bounces share."""

    scene: Scene
    grid: Grid
    octave: Int[Array, " n"]
    air: Float[Array, " n"]  # [1/m]
    fresh: Bool[Array, ""]
    ends: Bool[Array, ""]
    age: Float[Array, ""]
    mirrors: Bool[Array, ""]  # early paths render first-order reflections
    hear: Callable[..., _Sums]
    metres: float  # distance that sound travels in one bin [m]

    def flown(self, end: "_Carry", chance: Float[Array, " n"]) -> Flown:
        """Scale the sums of all bounces; rays that are still active count as aged."""
        (count,), cells = self.octave.shape, self.grid.volume.shape[0]
        ray, sums = end.ray, end.sums
        since = _since(ray.travelled / self.metres, jnp.zeros(count, jnp.float32), self.metres)
        left = _replace(end.aged, ray._replace(travelled=since), ray.room, chance)
        share = len(BANDS) / count
        scale = 4 * jnp.pi * self.metres * share / self.grid.volume
        energy = sums.heard.reshape(len(BANDS), cells, -1) * scale[None, :, None]
        way = sums.way.reshape(cells, -1, 3) * scale[:, None, None]
        went = _put(sums.went, self.octave, ray.room, ray.room, ray.travelled / self.metres, ray.energy)
        gave = Gave(energy, way, went * share, *(x * share for x in sums[3:]))
        return Flown(gave, end.gone, left)

    def bounce(self, carry: "_Carry", key: Array) -> "_Carry":
        """Trace and record one segment, then reflect the rays at its end."""
        ray, sums = carry.ray, carry.sums
        share, turn, *leave = jax.random.split(key, 5)
        reach = jnp.where(ray.energy > 0, FAR, -1.0)
        hit = cast(self.scene, ray.origin, ray.direction, t_max=reach, mask=int(Ray.SOUND))
        met = surface_at(self.scene, ray.direction, hit)
        wall, alive = hit.instance == ARCHITECTURE, hit.instance >= 0
        length = jnp.where(alive, hit.t, 0.0)
        point = ray.origin + length[:, None] * ray.direction
        room = _room_at(point + INWARD * met.normal, self.grid)
        seen = jnp.where(alive & (room >= 0), room, ray.room)
        # Objects reach into walls and beyond, so a room without a portal to the last one needs a second reflection.
        room = jnp.where(self.grid.joined[ray.room, seen] | (seen == ray.last), seen, ray.room)
        sums = self.hear(sums, ray, length, self.air)
        left = ray.energy * jnp.exp(-self.air * length) * (1 - self._own(met.absorption))
        left = jnp.where(alive, left, 0.0)
        sums = self._account(sums, ray, room, length, left)
        sums = self._leak(sums, ray, room, point, met, wall)
        unheard = self.fresh & (ray.travelled == 0)
        origin, flown = point + SKIN * met.normal, ray.travelled + length
        goes = self.ends & (room != ray.room) & ~unheard
        ages = (flown >= self.age) & ~goes & ~unheard
        direction, _ = _reflect(ray.direction, met.normal, self._own(met.scattering), leave[0])
        inside = jnp.where(goes, _inside(ray, length, room, self.grid), 0.0)
        when = (flown - inside) / self.metres
        since = _since(when, inside, self.metres)
        ended = Rays(origin, direction, since, jnp.where(goes, left, 0.0), ray.counts, ray.room, room)
        gone, aged = carry.gone, carry.aged
        chance = (
            jax.random.uniform(leave[1], left.shape, jnp.float32),
            jax.random.uniform(leave[2], left.shape, jnp.float32),
        )
        gone = _replace(gone, ended, room, chance[0])
        aged = _replace(aged, ended._replace(energy=jnp.where(ages, left, 0.0), room=room), room, chance[1])
        energy = jnp.where(goes | ages, left, 0.0)
        left_room = jnp.where(ages, room, ray.room)
        sums = sums._replace(went=_put(sums.went, self.octave, left_room, room, when, energy))
        left = jnp.where(goes | ages, 0.0, left)

        pick, energy = share_out(left, room, self.octave, self.grid.rooms, share)
        direction, mirrored = _reflect(ray.direction[pick], met.normal[pick], self._own(met.scattering)[pick], turn)
        counts = jnp.where(unheard[pick] & mirrored & wall[pick] & self.mirrors, 0.0, 1.0)
        ray = Rays(origin[pick], direction, flown[pick], energy, counts, room[pick], seen[pick])
        return _Carry(carry.bounces + 1, ray, gone, aged, sums)

    def _account(
        self, sums: _Sums, ray: Rays, room: Int[Array, " n"], length: Float[Array, " n"], left: Float[Array, " n"]
    ) -> _Sums:
        """Add the energy in rooms, its losses and its exchange along a segment."""
        middle = ray.energy * jnp.exp(-0.5 * self.air * length)
        here = 0.5 * middle * length
        lived = sums.lived.at[self.octave, ray.room].add(here).at[self.octave, room].add(here)
        lost = sums.lost.at[self.octave, room].add(ray.energy - left)
        moved = sums.moved.at[self.octave, ray.room, room].add(jnp.where(room != ray.room, middle, 0.0))
        return sums._replace(lived=lived, lost=lost, moved=moved)

    def _leak(
        self,
        sums: _Sums,
        ray: Rays,
        room: Int[Array, " n"],
        point: Float[Array, "n 3"],
        met: AcousticSurface,
        wall: Bool[Array, " n"],
    ) -> _Sums:
        """Add the energy transmitted by walls, floors and ceilings to the room behind them."""
        behind = jnp.full(room.shape, -1, jnp.int32)
        across = jnp.where(jnp.abs(met.normal[:, 2:]) < 0.5, 1.0, FLOORS)
        for depth in BEHIND[::-1]:
            found = _room_at(point - depth * across * met.normal, self.grid)
            behind = jnp.where((found >= 0) & (found != room), found, behind)
        counts = wall & (behind >= 0)
        length = jnp.linalg.norm(point - ray.origin, axis=1)
        energy = ray.energy * jnp.exp(-self.air * length) * self._own(met.transmission)
        behind = jnp.maximum(behind, 0)
        return sums._replace(through=sums.through.at[self.octave, room, behind].add(jnp.where(counts, energy, 0.0)))

    def _own(self, values: Float[Array, "n bands"]) -> Float[Array, " n"]:
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


def _hear(
    sums: _Sums,
    ray: Rays,
    length: Float[Array, " n"],
    air: Float[Array, " n"],
    *,
    grid: Grid,
    octave: Int[Array, " n"],
    late: Float[Array, " n"],
    metres: float,
) -> _Sums:
    """Record each ray's segment in cells, at the times (k + late) bins within it."""
    heard, way = sums.heard, sums.way
    cells = grid.volume.shape[0]
    bins = heard.shape[0] // cells // len(BANDS)
    index = jnp.ceil(ray.travelled / metres - late) + jnp.arange(STAMPS, dtype=jnp.float32)[:, None]
    along = (index + late) * metres - ray.travelled
    point = ray.origin + along[..., None] * ray.direction
    cell = _cell_at(point.reshape(-1, 3), grid).reshape(along.shape)
    inside = (along < length) & (cell >= 0) & (index < bins) & (ray.counts > 0)
    inside = inside & (point[..., 2] >= grid.low[cell]) & (point[..., 2] < grid.high[cell])
    energy = jnp.where(inside, ray.energy * jnp.exp(-air * along), 0.0)
    index = index.astype(jnp.int32)
    place = (octave * cells + cell) * bins + index
    heard = heard.at[jnp.where(inside, place, heard.shape[0])].add(energy, mode="drop")
    place = jnp.where(inside, cell * bins + index, way.shape[0])
    way = way.at[place].add(energy[..., None] * ray.direction, mode="drop")
    return sums._replace(heard=heard, way=way)


def _replace(kept: Gone, ray: Rays, entered: Int[Array, " n"], chance: Float[Array, " n"]) -> Gone:
    """Keep one ended ray per slot, drawn by energy: weighted reservoir sampling (Chao 1982)."""
    total = kept.ray.energy + ray.energy
    taken = chance * total < ray.energy
    new = Gone(ray, entered)
    kept = jax.tree.map(lambda a, b: jnp.where(taken.reshape(-1, *(a.ndim - 1) * [1]), a, b), new, kept)
    return kept._replace(ray=kept.ray._replace(energy=total))


def _put(
    went: Float[Array, "bands r r k"],
    octave: Int[Array, " n"],
    room: Int[Array, " n"],
    other: Int[Array, " n"],
    bins: Float[Array, " n"],
    energy: Float[Array, " n"],
) -> Float[Array, "bands r r k"]:
    """Add energy from room to room, in the bin of its passage; `_since` has the fraction of the bin."""
    return went.at[octave, room, other, bins.astype(jnp.int32)].add(energy, mode="drop")


def _since(when: Float[Array, " n"], inside: Float[Array, " n"], metres: float) -> Float[Array, " n"]:
    """Return the distance travelled since the start of the bin in which a portal state was reached [m].

    Rays restart with it. Otherwise, rounding down to whole bins would lose half a bin at each portal state.

    Args:
        when: Time at which the state was reached [bins].
        inside: Distance travelled since that time [m].
        metres: Distance that sound travels in one bin [m].
    """
    return inside + (when - jnp.floor(when)) * metres


def _inside(ray: Rays, length: Float[Array, " n"], room: Int[Array, " n"], grid: Grid) -> Float[Array, " n"]:
    """Return the length of each segment inside the room where it ends [m], by bisection."""
    low, high = jnp.zeros_like(length), length
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        there = _room_at(ray.origin + middle[:, None] * ray.direction, grid) == room
        low, high = jnp.where(there, low, middle), jnp.where(there, middle, high)
    return length - high


def _room_at(point: Float[Array, "n 3"], grid: Grid) -> Int[Array, " n"]:
    """Return the room over whose floor each point is; -1 if none."""
    cell = _cell_at(point, grid)
    return jnp.where(cell >= 0, grid.room[cell], -1)


def _cell_at(point: Float[Array, "n 3"], grid: Grid) -> Int[Array, " n"]:
    """Return the cell over whose floor each point is, on the highest storey below it; -1 if none."""
    at = jnp.floor((point[:, :2] - grid.origin[None]) / grid.step).astype(jnp.int32)
    levels, rows, columns = grid.lookup.shape
    there = (at[:, 0] >= 0) & (at[:, 0] < columns) & (at[:, 1] >= 0) & (at[:, 1] < rows)
    found = jnp.full(point.shape[0], -1, jnp.int32)
    for level in range(levels):
        cell = grid.lookup[level, jnp.clip(at[:, 1], 0, rows - 1), jnp.clip(at[:, 0], 0, columns - 1)]
        above = point[:, 2] >= grid.low[cell] - (FROM_FLOOR + INWARD)
        found = jnp.where(there & (cell >= 0) & above, cell, found)
    return found
