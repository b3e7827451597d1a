"""Late sound: ray tracing from the listener with next-event estimation of the energy from the source."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, emission_gains
from home_mjx.audio_jax.base.options import Traced
from home_mjx.audio_jax.propagation.paths import RAY_OFFSET, air_attenuation
from home_mjx.audio_jax.propagation.surfaces import AcousticSurface, surface_at
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import quat_matrix
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import ARCHITECTURE, BANDS, RayKind

MAX_SEGMENT_LENGTH = 1e6  # [m], maximum length of ray segments


class Trace(Pytree):
    """Arrivals and decay of n rays over b bounces. Distances are path lengths [m], energies re the source at 1 m."""

    direction: Float[Array, "n 3"]  # of each ray at the listener: its direction of incidence
    arrival: Float[Array, "a n"]  # path length from source to listener over each hit
    energy: Float[Array, "a n bands"]  # energy of that arrival
    travelled: Float[Array, "b n"]  # path length from the listener to each hit
    remaining: Float[Array, "b n bands"]  # energy of each ray after each hit
    initial_energy: Float[Array, "n bands"]  # initial energy of each ray; its sum over rays is 1


class _Ray(NamedTuple):
    """Rays before a segment: positions [m], unit directions, path lengths [m], energies per octave."""

    origin: Float[Array, "n 3"]
    direction: Float[Array, "n 3"]
    travelled: Float[Array, " n"]
    energy: Float[Array, "n bands"]
    specular: Float[Array, "n bands"]  # share of the energy that the sphere detector counts
    mirrored: Bool[Array, " n"]  # whether all hits so far were specular reflections in architecture


def trace(scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig) -> Trace:
    """Trace rays from the listener through specular and Lambert reflections; the same key yields the same rays.

    By reciprocity, energy traced from the listener equals that from the source. A hit at distance d that sees the
    source contributes 4 e (1 - absorption) s cos / d², with ray energy e and scattering coefficient s. This is
    Schröder's diffuse rain, normalized to the free-field level at 1 m. The specular rest (1 - s) is estimated by the
    detector of `config.late`. Specular reflections in architecture up to `config.early.reflection_order` are excluded
    if early paths render them (`num_reflections` above 0). Contributions are weighted by the source's directivity. With
    `octave_rays` a ray carries one octave and scatters by that octave's coefficient.

    Raises:
        ConfigError: `config.late` is not `Traced`.

    Returns:
        Arrivals and the rays' decay. With the detector "sphere" there are two rows of arrivals per bounce.
    """
    turn_key, choice_key, scatter_key = jax.random.split(key, 3)
    rays = config.traced
    shape = (rays.num_bounces, rays.num_rays)
    turn = jax.random.normal(turn_key, (4,), jnp.float32)  # normalised: a uniformly distributed rotation
    turn = quat_matrix(turn / jnp.linalg.norm(turn))
    carried = _octave_shares(rays)
    lattice = np.tile(fibonacci_directions(rays.num_rays // rays.num_groups), (rays.num_groups, 1))
    direction = jnp.matmul(jnp.asarray(lattice), turn, precision="highest")
    scattered = jax.random.normal(scatter_key, (*shape, 3), jnp.float32)
    draws = (jnp.arange(shape[0], dtype=jnp.int32), jax.random.uniform(choice_key, shape, jnp.float32), scattered)
    walk = _TraceContext(scene, source, config, jnp.int32(listener.body), jnp.int32(source.body), jnp.asarray(carried))
    leaving = walk.carried * jnp.float32(len(BANDS) / rays.num_rays)
    start = _Ray(
        jnp.broadcast_to(listener.pos, direction.shape),
        direction,
        jnp.zeros(shape[1], jnp.float32),
        leaving,
        jnp.zeros((shape[1], len(BANDS)), jnp.float32),
        jnp.ones(shape[1], bool),
    )
    _, (arrival, energy, travelled, remaining) = jax.lax.scan(walk.bounce, start, draws)
    rows = (-1, shape[1])
    return Trace(direction, arrival.reshape(rows), energy.reshape(*rows, len(BANDS)), travelled, remaining, leaving)


def _octave_shares(rays: Traced) -> Float[np.ndarray, "n bands"]:
    """Return the share of each octave in each ray: 1 / 7; with `octave_rays` 1 for one octave, rays sorted by it."""
    if rays.octave_rays:
        return np.repeat(np.eye(len(BANDS), dtype=np.float32), rays.num_rays // len(BANDS), axis=0)
    return np.full((rays.num_rays, len(BANDS)), 1 / len(BANDS), np.float32)


class _TraceContext(NamedTuple):
    """Constants of a trace, shared by all bounces.

    `exclude` and `emitter` are object ids of the listener's and the source's body, `carried` octave shares of each ray.
    """

    scene: Scene
    source: SoundSource
    config: AudioConfig
    exclude: Int[Array, ""]
    emitter: Int[Array, ""]
    carried: Float[Array, "n bands"]

    def bounce(self, ray: _Ray, draw: tuple[Array, Array, Array]) -> tuple[_Ray, tuple[Array, Array, Array, Array]]:
        """Trace a segment and reflect; `draw`: bounce index, uniforms, normal vectors.

        Return the reflected rays, and this bounce's `arrival`, `energy`, `travelled` and `remaining` of `Trace`.
        """
        index, choice, scattered = draw
        alive = jnp.max(ray.energy, axis=1) > 0
        hit = cast(
            self.scene,
            ray.origin,
            ray.direction,
            t_max=jnp.where(alive, MAX_SEGMENT_LENGTH, -1.0),
            exclude=self.exclude,
            mask=int(RayKind.SOUND),
        )
        met = surface_at(self.scene, ray.direction, hit)
        alive = hit.instance >= 0
        length = jnp.where(alive, hit.t, 0.0)
        loss = jnp.exp(-length[:, None] * air_attenuation(self.config)[None]) * (1 - met.absorption)
        energy = jnp.where(alive[:, None], ray.energy * loss, 0.0)
        point = ray.origin + length[:, None] * ray.direction + RAY_OFFSET * met.normal
        travelled = ray.travelled + length

        mirrored = ray.mirrored & (index < self.config.early.reflection_order) & (hit.instance == ARCHITECTURE)
        mirrored = mirrored & (self.config.early.num_reflections > 0)
        rain = energy * jnp.where(mirrored[:, None] | (self.config.traced.detector == "sphere"), met.scattering, 1.0)
        arrival, arriving = self._rain(point, met.normal, rain)
        arrival = arrival + travelled
        if self.config.traced.detector == "sphere":
            passing, passed = self._sphere(ray, length)
            arrival, arriving = jnp.stack([arrival, passing]), jnp.stack([arriving, passed])
        direction, specular, scatters = _reflect(ray.direction, met, self.carried, choice, scattered)
        specular = jnp.where(mirrored[:, None], 0.0, specular)
        new = _Ray(point, direction, travelled, energy, specular, mirrored & ~scatters)
        return new, (arrival, arriving, travelled, energy)

    def _rain(
        self, point: Float[Array, "n 3"], normal: Float[Array, "n 3"], energy: Float[Array, "n bands"]
    ) -> tuple[Float[Array, " n"], Float[Array, "n bands"]]:
        """Compute the distance d from each hit to the source [m], and the energy 4 cos / d² times air and directivity.

        The energy is 0 if the source is occluded or behind the surface; d is at least `detector_radius` in it.
        """
        offset = self.source.pos[None] - point
        distance = jnp.linalg.norm(offset, axis=1)
        toward = offset / jnp.maximum(distance, RAY_OFFSET)[:, None]
        cosine = jnp.sum(toward * normal, axis=1)
        asks = (cosine > 0) & (jnp.max(energy, axis=1) > 0)
        hidden = occluded(
            self.scene,
            point,
            toward,
            t_max=jnp.where(asks, distance - RAY_OFFSET, -1.0),
            exclude=self.emitter,
            mask=int(RayKind.SOUND),
        )
        share = 4 * cosine / jnp.maximum(distance, self.config.traced.detector_radius) ** 2
        share = jnp.where(asks & ~hidden, share, 0.0)
        energy = energy * share[:, None] * jnp.exp(-distance[:, None] * air_attenuation(self.config)[None])
        return distance, self._weight_directivity(energy, -toward)

    def _sphere(self, ray: _Ray, length: Float[Array, " n"]) -> tuple[Float[Array, " n"], Float[Array, "n bands"]]:
        """Compute path lengths [m] and energies of specular rays through a sphere around the source; else energy 0.

        A segment of `length` [m] that passes within the radius r of the source counts the specular energy times 4 / r².
        """
        offset = self.source.pos[None] - ray.origin
        nearest = jnp.sum(offset * ray.direction, axis=1)
        miss = jnp.linalg.norm(offset - nearest[:, None] * ray.direction, axis=1)
        radius = self.config.traced.detector_radius
        inside = (nearest > 0) & (nearest < length) & (miss < radius)
        decay = jnp.exp(-nearest[:, None] * air_attenuation(self.config)[None])
        energy = 4 / radius**2 * ray.energy * ray.specular * decay
        return ray.travelled + nearest, self._weight_directivity(
            jnp.where(inside[:, None], energy, 0.0), -ray.direction
        )

    def _weight_directivity(
        self, energy: Float[Array, "n bands"], direction: Float[Array, "n 3"]
    ) -> Float[Array, "n bands"]:
        """Weight energies with the source's directivity towards `direction`, a unit vector away from the source."""
        return energy * emission_gains(self.source, direction) ** 2


def _reflect(
    direction: Float[Array, "n 3"],
    met: AcousticSurface,
    carried: Float[Array, "n bands"],
    choice: Float[Array, " n"],
    scattered: Float[Array, "n 3"],
) -> tuple[Float[Array, "n 3"], Float[Array, "n bands"], Bool[Array, " n"]]:
    """Sample reflected directions; return them, specular weights per octave, and which are scattered (Lambert).

    All octaves of a ray share one direction, scattered if `choice` (0 to 1) is below their mean coefficient. The weight
    is (1 - s) / (1 - mean) with the octave's coefficient s, and 0 if scattered.
    """
    mean = jnp.sum(carried * met.scattering, axis=1)
    mirror = direction - 2 * jnp.sum(direction * met.normal, axis=1, keepdims=True) * met.normal
    lambert = met.normal + scattered / jnp.maximum(jnp.linalg.norm(scattered, axis=1, keepdims=True), 1e-9)
    lambert = lambert / jnp.maximum(jnp.linalg.norm(lambert, axis=1, keepdims=True), 1e-6)
    random = choice < mean
    scatters = random[:, None]
    weight = (1 - met.scattering) / jnp.maximum(1 - mean, 1e-6)[:, None]
    return jnp.where(scatters, lambert, mirror), jnp.where(scatters, 0.0, weight), random


def fibonacci_directions(count: int) -> Float[np.ndarray, "n 3"]:
    """Return `count` evenly distributed unit vectors (Fibonacci lattice), in order from near +z to near -z."""
    index = np.arange(count) + 0.5
    z, turn = 1 - 2 * index / count, index * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1).astype(np.float32)
