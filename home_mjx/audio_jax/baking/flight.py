"""Rays from the cells of a house, heard in all other cells at once."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.baking.cells import FROM_FLOOR
from home_mjx.audio_jax.baking.split import share_out
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.paths import SKIN, air_energy
from home_mjx.audio_jax.propagation.surfaces import AcousticSurface, surface_at
from home_mjx.core.pytree import Pytree, static
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import ARCHITECTURE, BANDS, Ray

STAMPS = 6  # times at which one segment can be heard; longer ones are heard there by so many
FAR = 1e4  # [m]
INWARD = 0.1  # [m], from a surface to a point that is in the room before it
BEHIND = (0.08, 0.15, 0.25, 0.4)  # [m], from a surface to points that may be in the room behind it


class Grid(Pytree):
    """Which cell holds a point: `baking.cells` on the device."""

    lookup: Int[Array, "levels rows columns"]
    origin: Float[Array, " 2"]
    low: Float[Array, " n"]
    high: Float[Array, " n"]
    volume: Float[Array, " n"]
    room: Int[Array, " n"]
    rooms: int = static()
    step: float = static()  # [m]


class Flown(NamedTuple):
    """What the rays of one source gave, or several; sums over rays are in no unit, only their ratios count."""

    energy: Float[Array, "bands c k"]  # re the free field of the source at 1 m, per octave, cell and time bin
    way: Float[Array, "c 3"]  # sum of directions in which it came, by energy
    distance: Float[Array, " n"]  # [m], that each ray flew
    lived: Float[Array, "bands r"]  # energy times way [m] in each room
    lost: Float[Array, "bands r"]  # energy that surfaces and air have taken
    moved: Float[Array, "bands r r"]  # that went from room to room
    through: Float[Array, "bands r r"]  # that walls would have let through


class _Ray(NamedTuple):
    origin: Float[Array, "n 3"]
    direction: Float[Array, "n 3"]
    travelled: Float[Array, " n"]
    energy: Float[Array, " n"]  # of the ray's own octave, starting from 1
    counts: Float[Array, " n"]  # 0 on segments that early paths render
    room: Int[Array, " n"]


class _Sums(NamedTuple):
    heard: Float[Array, " x"]
    way: Float[Array, "c 3"]
    lived: Float[Array, "bands r"]
    lost: Float[Array, "bands r"]
    moved: Float[Array, "bands r r"]
    through: Float[Array, "bands r r"]


def fly(
    scene: Scene,
    grid: Grid,
    start: Float[Array, "r 3"],
    room: Int[Array, ""],
    key: Array,
    config: AudioConfig,
    bins: int,
) -> Flown:
    """Energy density in every cell over time, of one source that is spread over some points.

    Each ray belongs to one octave and is scattered as that octave is: nothing is weighted afterwards. It is heard at
    regular times, in the cell where it then is, so that a cell hears as much as its volume deserves. Segments that
    early paths render are left out: the direct one, and first-order reflections in architecture. After each reflection
    rays are shared out anew, see `share_out`, so that many are in rooms that little energy gets to.

    Args:
        scene: The house.
        grid: Its cells.
        start: Where rays of every octave start [m].
        room: In which room that is.
        key: Random key.
        config: `num_bounces`, `bin_seconds` and the air.
        bins: Number of time bins.
    """
    rays, cells = start.shape[0], grid.volume.shape[0]
    octave = jnp.repeat(jnp.arange(len(BANDS), dtype=jnp.int32), rays)
    ways, jitter, draws = jax.random.split(key, 3)
    way = jax.random.normal(ways, (octave.size, 3), jnp.float32)
    zero = jnp.zeros(octave.size, jnp.float32)
    first = _Ray(
        jnp.tile(start, (len(BANDS), 1)),
        way / jnp.linalg.norm(way, axis=1, keepdims=True),
        zero,
        zero + 1,
        zero,
        jnp.broadcast_to(room, octave.shape),
    )
    metres = config.bin_seconds * config.speed_of_sound
    late = jax.random.uniform(jitter, octave.shape, jnp.float32)
    hear = partial(_hear, grid=grid, octave=octave, late=late, metres=metres)
    walk = _Walk(scene, grid, octave, jnp.asarray(air_energy(config))[octave], config.num_reflections > 0, hear)
    shapes = (len(BANDS) * cells * bins,), (cells, 3), *(2 * [(7, grid.rooms)]), *(2 * [(7, grid.rooms, grid.rooms)])
    nothing = _Sums(*(jnp.zeros(shape, jnp.float32) for shape in shapes))
    (ray, sums), _ = jax.lax.scan(walk.bounce, (first, nothing), jax.random.split(draws, config.num_bounces))
    scale = 4 * jnp.pi * metres / rays / grid.volume
    energy = sums.heard.reshape(len(BANDS), cells, bins) * scale[None, :, None]
    return Flown(energy, sums.way * scale[:, None], ray.travelled, *sums[2:])


class _Walk(NamedTuple):
    """What all bounces share."""

    scene: Scene
    grid: Grid
    octave: Int[Array, " n"]
    air: Float[Array, " n"]  # [1/m]
    mirrors: bool  # whether early paths render first-order reflections
    hear: Callable[..., _Sums]

    def bounce(self, carry: tuple[_Ray, _Sums], key: Array) -> tuple[tuple[_Ray, _Sums], None]:
        """One segment, heard on its way, and the reflection at its end."""
        ray, sums = carry
        share, turn = jax.random.split(key)
        reach = jnp.where(ray.energy > 0, FAR, -1.0)
        hit = cast(self.scene, ray.origin, ray.direction, t_max=reach, mask=int(Ray.SOUND))
        met = surface_at(self.scene, ray.direction, hit)
        wall, alive = hit.instance == ARCHITECTURE, hit.instance >= 0
        length = jnp.where(alive, hit.t, 0.0)
        point = ray.origin + length[:, None] * ray.direction
        room = _room_at(point + INWARD * met.normal, self.grid)
        room = jnp.where(alive & (room >= 0), room, ray.room)
        sums = self.hear(sums, ray, length, self.air)
        left = ray.energy * jnp.exp(-self.air * length) * (1 - self._own(met.absorption))
        left = jnp.where(alive, left, 0.0)
        sums = self._account(sums, ray, room, length, left)
        sums = self._leak(sums, ray, room, point, met, wall)

        pick, energy = share_out(left, room, self.octave, self.grid.rooms, share)
        direction, mirrored = _reflect(ray.direction[pick], met.normal[pick], self._own(met.scattering)[pick], turn)
        rendered = (ray.travelled[pick] == 0) & mirrored & wall[pick] & self.mirrors
        origin, flown = (point + SKIN * met.normal)[pick], (ray.travelled + length)[pick]
        return (_Ray(origin, direction, flown, energy, jnp.where(rendered, 0.0, 1.0), room[pick]), sums), None

    def _account(
        self, sums: _Sums, ray: _Ray, room: Int[Array, " n"], length: Float[Array, " n"], left: Float[Array, " n"]
    ) -> _Sums:
        """Adds where energy was, where it was lost, and where it went."""
        middle = ray.energy * jnp.exp(-0.5 * self.air * length)
        here = 0.5 * middle * length
        lived = sums.lived.at[self.octave, ray.room].add(here).at[self.octave, room].add(here)
        lost = sums.lost.at[self.octave, room].add(ray.energy - left)
        moved = sums.moved.at[self.octave, ray.room, room].add(jnp.where(room != ray.room, middle, 0.0))
        return sums._replace(lived=lived, lost=lost, moved=moved)

    def _leak(
        self,
        sums: _Sums,
        ray: _Ray,
        room: Int[Array, " n"],
        point: Float[Array, "n 3"],
        met: AcousticSurface,
        wall: Bool[Array, " n"],
    ) -> _Sums:
        """Adds what walls let through to the room behind them; floors and ceilings let nothing through."""
        behind = jnp.full(room.shape, -1, jnp.int32)
        for depth in BEHIND[::-1]:
            found = _room_at(point - depth * met.normal, self.grid)
            behind = jnp.where((found >= 0) & (found != room), found, behind)
        counts = wall & (behind >= 0) & (jnp.abs(met.normal[:, 2]) < 0.5)
        length = jnp.linalg.norm(point - ray.origin, axis=1)
        energy = ray.energy * jnp.exp(-self.air * length) * self._own(met.transmission)
        behind = jnp.maximum(behind, 0)
        return sums._replace(through=sums.through.at[self.octave, room, behind].add(jnp.where(counts, energy, 0.0)))

    def _own(self, values: Float[Array, "n bands"]) -> Float[Array, " n"]:
        """Of each ray's octave."""
        return jnp.take_along_axis(values, self.octave[:, None], axis=1)[:, 0]


def _reflect(
    direction: Float[Array, "n 3"], normal: Float[Array, "n 3"], scattering: Float[Array, " n"], key: Array
) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
    """New directions, mirrored or by Lambert's law, and which are mirrored."""
    choice, scatter = jax.random.split(key)
    mirrors = jax.random.uniform(choice, scattering.shape, jnp.float32) >= scattering
    ball = jax.random.normal(scatter, direction.shape, jnp.float32)
    lambert = normal + ball / jnp.linalg.norm(ball, axis=1, keepdims=True)
    lambert = lambert / jnp.maximum(jnp.linalg.norm(lambert, axis=1, keepdims=True), 1e-6)
    mirrored = direction - 2 * jnp.sum(direction * normal, axis=1, keepdims=True) * normal
    return jnp.where(mirrors[:, None], mirrored, lambert), mirrors


def _hear(
    sums: _Sums,
    ray: _Ray,
    length: Float[Array, " n"],
    air: Float[Array, " n"],
    *,
    grid: Grid,
    octave: Int[Array, " n"],
    late: Float[Array, " n"],
    metres: float,
) -> _Sums:
    """Adds what cells hear of each ray's segment at the times (k + late) bins that fall into it."""
    heard, way = sums.heard, sums.way
    cells = grid.volume.shape[0]
    bins = heard.shape[0] // cells // len(BANDS)
    first = jnp.ceil(ray.travelled / metres - late)
    for stamp in range(STAMPS):
        index = first + stamp
        along = (index + late) * metres - ray.travelled
        point = ray.origin + along[:, None] * ray.direction
        cell = _cell_at(point, grid)
        inside = (along < length) & (cell >= 0) & (index < bins) & (ray.counts > 0)
        inside = inside & (point[:, 2] >= grid.low[cell]) & (point[:, 2] < grid.high[cell])
        energy = jnp.where(inside, ray.energy * jnp.exp(-air * along), 0.0)
        place = (octave * cells + cell) * bins + index.astype(jnp.int32)
        heard = heard.at[jnp.where(inside, place, heard.shape[0])].add(energy, mode="drop")
        way = way.at[jnp.where(inside, cell, cells)].add(energy[:, None] * ray.direction, mode="drop")
    return sums._replace(heard=heard, way=way)


def _room_at(point: Float[Array, "n 3"], grid: Grid) -> Int[Array, " n"]:
    """Room over whose floor each point is; -1 none."""
    cell = _cell_at(point, grid)
    return jnp.where(cell >= 0, grid.room[cell], -1)


def _cell_at(point: Float[Array, "n 3"], grid: Grid) -> Int[Array, " n"]:
    """Cell over whose floor each point is, of the highest storey that is below it; -1 none."""
    at = jnp.floor((point[:, :2] - grid.origin[None]) / grid.step).astype(jnp.int32)
    levels, rows, columns = grid.lookup.shape
    there = (at[:, 0] >= 0) & (at[:, 0] < columns) & (at[:, 1] >= 0) & (at[:, 1] < rows)
    found = jnp.full(point.shape[0], -1, jnp.int32)
    for level in range(levels):
        cell = grid.lookup[level, jnp.clip(at[:, 1], 0, rows - 1), jnp.clip(at[:, 0], 0, columns - 1)]
        above = point[:, 2] >= grid.low[cell] - (FROM_FLOOR + INWARD)
        found = jnp.where(there & (cell >= 0) & above, cell, found)
    return found
