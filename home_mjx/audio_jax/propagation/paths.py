"""Early sound: the direct path, transmitted through obstacles, and first-order reflections."""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.air import air_absorption, energy_attenuation
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.propagation.surfaces import surface_at
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import length3, sum3
from home_mjx.raycast_render.casting.cast import cast, cast_multi_hit, occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, MAX_MIRROR_DISTANCE, RayKind

RAY_OFFSET = 1e-4  # [m], offset of ray ends from surfaces
MIN_PATH_LENGTH = 0.05  # [m], minimum path length, which bounds gains
MAX_PATH_NAMES = 1 << 24  # range of names of one producer's paths


class Paths(Pytree):
    """Sound paths from the source to the listener; the first is the direct one."""

    distance: Float[Array, " p"]  # [m], path length
    gain: Float[Array, "p bands"]  # pressure per octave re the source at 1 m; 0 if there is no path
    direction: Float[Array, "p 3"]  # unit vector from the listener towards the direction of incidence, world
    # Identity of a path across steps, such as the index of its mirror plane, so that its delay can be interpolated.
    # Unique within one producer; None: the path's index.
    name: Int[Array, " p"] | None = None
    # Unit vector from the source along the path's first leg, world; required for sources with a directivity.
    departure: Float[Array, "p 3"] | None = None


PathProducer = Callable[[Scene, SoundSource, Listener, AudioConfig], Paths]


def is_duplicate(same: Bool[Array, "p p"]) -> Bool[Array, " p"]:
    """Return which paths equal an earlier one (lower index); `same[i, j]`: path i equals path j."""
    return jnp.any(same & jnp.tril(jnp.ones(same.shape, bool), -1), axis=1)


def empty_paths() -> Paths:
    """Return `Paths` of zero paths."""
    none, nowhere = jnp.zeros(0, jnp.float32), jnp.zeros((0, 3), jnp.float32)
    return Paths(none, jnp.zeros((0, len(BANDS)), jnp.float32), nowhere, none.astype(jnp.int32), nowhere)


def air_attenuation(config: AudioConfig) -> Float[np.ndarray, " bands"]:
    """Compute the coefficient m [1/m] of the energy exp(-m r) left after r metres of air, per octave."""
    loss = air_absorption(np.array(BANDS), config.air.temperature, config.air.humidity, config.air.pressure)
    return energy_attenuation(loss).astype(np.float32)


class StraightLine(NamedTuple):
    """Surfaces on the straight line from the listener to the source."""

    distance: Float[Array, ""]  # [m], at least `MIN_PATH_LENGTH`
    direction: Float[Array, "3"]  # unit vector from the listener, world
    # energy transmission of all partitions on the line, each counted once
    partition_transmission: Float[Array, " bands"]
    object_transmission: Float[Array, " bands"]  # energy transmission of all objects on the line, each counted once
    is_partition_free: Bool[Array, ""]  # whether no partition is on the line
    is_clear: Bool[Array, ""]  # whether the line is unobstructed
    is_over_limit: Bool[Array, ""]  # whether `max_crossings` hits were used up before the source


def trace_straight_line(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> StraightLine:
    """Trace the straight line through all surfaces on it except those of the source's and listener's bodies.

    It runs from the listener; each partition and each object counts once, within `config.early.max_crossings` hits.
    """
    offset = source.pos - listener.pos
    distance = jnp.maximum(length3(offset), MIN_PATH_LENGTH)
    direction = offset / distance
    # Excluding the object just hit saves the steps for its other faces.
    hit = cast_multi_hit(
        scene,
        listener.pos,
        direction,
        num_hits=config.early.max_crossings,
        hit_epsilon=RAY_OFFSET,
        t_max=distance - RAY_OFFSET,
        exclude=listener.body,
        mask=int(RayKind.SOUND),
    )
    met, blocked = surface_at(scene, jnp.broadcast_to(direction, (*hit.t.shape, 3)), hit), hit.instance >= 0
    is_object, barrier = met.object_id >= 0, met.barrier
    own = is_object & ((met.object_id == listener.body) | (met.object_id == source.body))
    repeats = (barrier >= 0) & is_duplicate(blocked[None] & (barrier[:, None] == barrier[None]))
    counts, silent = blocked & ~own & ~repeats, blocked[-1]
    partition, item = counts & ~is_object, counts & is_object
    return StraightLine(
        distance,
        direction,
        partition_transmission=_transmit(met.transmission, partition),
        object_transmission=_transmit(met.transmission, item),
        is_partition_free=~jnp.any(partition),
        is_clear=~jnp.any(counts) & ~silent,
        is_over_limit=silent,
    )


def _transmit(transmission: Float[Array, "n bands"], counts: Bool[Array, " n"]) -> Float[Array, " bands"]:
    """Multiply the transmission of counted hits, in order so that all platforms round alike; 1 if none counts."""
    return functools.reduce(jnp.multiply, jnp.where(counts[:, None], transmission, 1.0))


def direct_path(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> Paths:
    """Compute the direct path, attenuated once by the transmission of each partition and object that it crosses.

    It is one path, of at least 5 cm. Its gain includes air and 1 / distance; it is 0 from `config.early.max_crossings`
    surface hits on.
    """
    straight = trace_straight_line(scene, source, listener, config)
    energy = straight.partition_transmission * straight.object_transmission
    amplitude = jnp.sqrt(energy * jnp.exp(-air_attenuation(config) * straight.distance)) / straight.distance
    amplitude = jnp.where(straight.is_over_limit, 0.0, amplitude)
    away = straight.direction[None]
    return Paths(straight.distance[None], amplitude[None], away, departure=-away)


def first_order_reflections(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> Paths:
    """Compute first-order image sources in the house's mirror planes, the shortest first.

    A reflection is audible if a ray from the listener hits a surface in the plane and the source sees that point. Its
    energy is (1 - absorption) (1 - scattering) of that surface, for example of a window, times absorption by air.

    Returns:
        `config.early.num_reflections` paths, or one per mirror plane if that is less. Silent ones have gain 0, and
        length 1 m if geometry excludes them.
    """
    if config.early.num_reflections == 0:
        return empty_paths()
    start, end = source.pos, listener.pos
    point, distance, plane = _nearest_mirrors(scene, start, end, config.early.num_reflections)
    to_listener = length3(point - end[None])
    to_source = length3(point - start[None])
    direction = (point - end[None]) / jnp.maximum(to_listener, MIN_PATH_LENGTH)[:, None]
    departure = (point - start[None]) / jnp.maximum(to_source, MIN_PATH_LENGTH)[:, None]
    possible = jnp.isfinite(distance)
    hit = cast(
        scene,
        jnp.broadcast_to(end, point.shape),
        direction,
        t_max=jnp.where(possible, to_listener + MAX_MIRROR_DISTANCE, -1.0),
        exclude=listener.body,
        mask=int(RayKind.SOUND),
    )
    hidden = occluded(
        scene,
        jnp.broadcast_to(start, point.shape),
        departure,
        t_max=jnp.where(possible, to_source - MAX_MIRROR_DISTANCE, -1.0),
        exclude=source.body,
        mask=int(RayKind.SOUND),
    )
    met = surface_at(scene, direction, hit)
    heard = possible & ~hidden & (hit.instance >= 0) & (jnp.abs(hit.t - to_listener) < MAX_MIRROR_DISTANCE)
    length = jnp.where(possible, distance, 1.0)
    energy = (1 - met.absorption) * (1 - met.scattering) * jnp.exp(-length[:, None] * air_attenuation(config)[None])
    gain = jnp.sqrt(jnp.maximum(energy, 0.0)) / jnp.maximum(length, MIN_PATH_LENGTH)[:, None]
    return Paths(length, jnp.where(heard[:, None], gain, 0.0), direction, plane, departure)


def _nearest_mirrors(
    scene: Scene, source: Float[Array, "3"], listener: Float[Array, "3"], count: int
) -> tuple[Float[Array, "r 3"], Float[Array, " r"], Int[Array, " r"]]:
    """Select up to `count` shortest reflections: points, path lengths [m], plane indices; sorted by length.

    The length is inf unless source and listener are before the plane and the point is in its rectangle.
    """
    planes = scene.bank.acoustics
    center, normal = planes.plane_center[scene.house], planes.plane_normal[scene.house]
    before_source = sum3((source[None] - center) * normal)
    before_listener = sum3((listener[None] - center) * normal)
    image = source[None] - 2 * before_source[:, None] * normal
    share = before_listener / jnp.maximum(before_listener + before_source, 1e-9)
    point = listener[None] + share[:, None] * (image - listener[None])
    inside = _is_inside(point - center, planes.plane_u[scene.house]) & _is_inside(
        point - center, planes.plane_v[scene.house]
    )
    valid = planes.plane_valid[scene.house] & (before_source > 0) & (before_listener > 0) & inside
    distance = jnp.where(valid, length3(image - listener[None]), jnp.inf)
    _, nearest = jax.lax.top_k(-distance, min(count, distance.size))
    return point[nearest], distance[nearest], nearest.astype(jnp.int32)


def _is_inside(offset: Float[Array, "p 3"], half: Float[Array, "p 3"]) -> Bool[Array, " p"]:
    """Return whether the projection of `offset` on `half`, a vector from centre to edge, is at most as long as it."""
    return jnp.abs(sum3(offset * half)) <= sum3(half * half)
