"""Rays from the cells of a house, heard in all other cells at once."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.paths import SKIN, air_energy
from home_mjx.audio_jax.propagation.surfaces import surface_at
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import ARCHITECTURE, BANDS, Ray

STAMPS = 6  # times at which one segment can be heard; longer ones are heard there by so many
FAR = 1e4  # [m]


class Grid(Pytree):
    """Which cell holds a point: `baking.cells` on the device."""

    lookup: Int[Array, "levels rows columns"]
    origin: Float[Array, " 2"]
    low: Float[Array, " n"]
    high: Float[Array, " n"]
    volume: Float[Array, " n"]


class _Ray(NamedTuple):
    origin: Float[Array, "n 3"]
    direction: Float[Array, "n 3"]
    travelled: Float[Array, " n"]
    energy: Float[Array, " n"]  # of the ray's own octave, starting from 1
    counts: Float[Array, " n"]  # 0 on segments that early paths render


def fly(
    scene: Scene, grid: Grid, step: float, start: Float[Array, "r 3"], key: Array, config: AudioConfig, bins: int
) -> tuple[Float[Array, "bands c k"], Float[Array, " n"]]:
    """Energy density in every cell over time, of one source that is spread over some points.

    Each ray belongs to one octave and is scattered as that octave is: nothing is weighted afterwards. It is heard at
    regular times, in the cell where it then is, so that a cell hears as much as its volume deserves. Segments that
    early paths render are left out: the direct one, and first-order reflections in architecture.

    Args:
        scene: The house.
        grid: Its cells.
        step: Of the grid's places [m].
        start: Where rays of every octave start [m].
        key: Random key.
        config: `num_bounces`, `bin_seconds` and the air.
        bins: Number of time bins.

    Returns:
        Energy re the free field of the source at 1 m per octave, cell and bin, and how far each ray flew [m].
    """
    rays = start.shape[0]
    octave = jnp.repeat(jnp.arange(len(BANDS), dtype=jnp.int32), rays)
    ways, jitter, draws = jax.random.split(key, 3)
    way = jax.random.normal(ways, (octave.size, 3), jnp.float32)
    zero = jnp.zeros(octave.size, jnp.float32)
    origin = jnp.tile(start, (len(BANDS), 1))
    first = _Ray(origin, way / jnp.linalg.norm(way, axis=1, keepdims=True), zero, zero + 1, zero)
    metres = config.bin_seconds * config.speed_of_sound
    late = jax.random.uniform(jitter, octave.shape, jnp.float32)
    hear = partial(_hear, grid=grid, step=step, octave=octave, late=late, metres=metres)
    walk = _Walk(scene, octave, jnp.asarray(air_energy(config))[octave], config.num_reflections > 0, hear)
    cells = grid.volume.shape[0]
    nothing = jnp.zeros(len(BANDS) * cells * bins, jnp.float32)
    (ray, heard), _ = jax.lax.scan(walk.bounce, (first, nothing), jax.random.split(draws, config.num_bounces))
    scale = 4 * jnp.pi * metres / rays / grid.volume
    return heard.reshape(len(BANDS), cells, bins) * scale[None, :, None], ray.travelled


class _Walk(NamedTuple):
    """What all bounces share."""

    scene: Scene
    octave: Int[Array, " n"]
    air: Float[Array, " n"]  # [1/m]
    mirrors: bool  # whether early paths render first-order reflections
    hear: Callable[..., Array]

    def bounce(self, carry: tuple[_Ray, Array], key: Array) -> tuple[tuple[_Ray, Array], None]:
        """One segment, heard on its way, and the reflection at its end."""
        ray, heard = carry
        reach = jnp.where(ray.energy > 0, FAR, -1.0)
        hit = cast(self.scene, ray.origin, ray.direction, t_max=reach, mask=int(Ray.SOUND))
        met = surface_at(self.scene, ray.direction, hit)
        alive = hit.instance >= 0
        length = jnp.where(alive, hit.t, 0.0)
        heard = self.hear(heard, ray, length, self.air)
        left = ray.energy * jnp.exp(-self.air * length) * (1 - self._own(met.absorption))
        direction, mirrored = _reflect(ray.direction, met.normal, self._own(met.scattering), key)
        rendered = (ray.travelled == 0) & mirrored & (hit.instance == ARCHITECTURE) & self.mirrors
        new = _Ray(
            ray.origin + length[:, None] * ray.direction + SKIN * met.normal,
            direction,
            ray.travelled + length,
            jnp.where(alive, left, 0.0),
            jnp.where(rendered, 0.0, 1.0),
        )
        return (new, heard), None

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
    heard: Float[Array, " x"],
    ray: _Ray,
    length: Float[Array, " n"],
    air: Float[Array, " n"],
    *,
    grid: Grid,
    step: float,
    octave: Int[Array, " n"],
    late: Float[Array, " n"],
    metres: float,
) -> Float[Array, " x"]:
    """Adds what cells hear of each ray's segment at the times (k + late) bins that fall into it."""
    cells = grid.volume.shape[0]
    bins = heard.shape[0] // cells // len(BANDS)
    first = jnp.ceil(ray.travelled / metres - late)
    for stamp in range(STAMPS):
        index = first + stamp
        along = (index + late) * metres - ray.travelled
        cell = _cell_at(ray.origin + along[:, None] * ray.direction, grid, step)
        inside = (along < length) & (cell >= 0) & (index < bins) & (ray.counts > 0)
        energy = jnp.where(inside, ray.energy * jnp.exp(-air * along), 0.0)
        place = (octave * cells + cell) * bins + index.astype(jnp.int32)
        heard = heard.at[jnp.where(inside, place, heard.shape[0])].add(energy, mode="drop")
    return heard


def _cell_at(point: Float[Array, "n 3"], grid: Grid, step: float) -> Int[Array, " n"]:
    """Cell that holds each point; -1 none. Storeys are tried one after the other."""
    at = jnp.floor((point[:, :2] - grid.origin[None]) / step).astype(jnp.int32)
    levels, rows, columns = grid.lookup.shape
    there = (at[:, 0] >= 0) & (at[:, 0] < columns) & (at[:, 1] >= 0) & (at[:, 1] < rows)
    found = jnp.full(point.shape[0], -1, jnp.int32)
    for level in range(levels):
        cell = grid.lookup[level, jnp.clip(at[:, 1], 0, rows - 1), jnp.clip(at[:, 0], 0, columns - 1)]
        held = there & (cell >= 0) & (point[:, 2] >= grid.low[cell]) & (point[:, 2] < grid.high[cell])
        found = jnp.where(held, cell, found)
    return found
