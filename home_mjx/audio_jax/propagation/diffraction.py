"""Direct sound around edges: the straight path near them, and what bends into their shadows."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Complex, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.propagation.barriers import Boxes, Strings, strings
from home_mjx.audio_jax.propagation.paths import NEAREST, SKIN, Paths, Straight, air_energy, cross
from home_mjx.audio_jax.propagation.wedge import diffracted, second_edge
from home_mjx.core.transforms import quat_matrix
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, Ray
from home_mjx.schema.edges import EDGES

SPREAD = (-1 / 3, 0.0, 1 / 3)  # [octaves] re the centre, where each octave is evaluated
FREE = -1e-3  # [rad], turn past an edge of what is seen


class _Field(NamedTuple):
    """What strings bring, per octave and frequency in it."""

    amplitude: Complex[Array, "k f"]  # re the free field of the straight path; its phase re that path
    share: Float[Array, "k f"]  # of energy that this piece of an endless edge has
    shadow: Bool[Array, " k"]  # the string bends around its box


def house_boxes(scene: Scene) -> Boxes:
    """All boxes of an environment: static ones, then movable objects, doors and agents."""
    physics, house, moving = scene.bank.physics, scene.house, scene.moving
    bits = scene.bank.acoustics.collider_edges[house]
    exposed = (bits[:, None] >> jnp.arange(EDGES, dtype=jnp.int32)[None]) & 1 == 1
    axis = jnp.swapaxes(jax.vmap(quat_matrix)(physics.collider_quat[house]), 1, 2)
    box = scene.geometry.model_box[moving.model]
    columns = jnp.swapaxes(moving.pose[:, :, :3], 1, 2)
    stretch = jnp.maximum(jnp.linalg.norm(columns, axis=2), 1e-6)
    middle = jnp.mean(box, axis=1)
    center = jnp.sum(columns * middle[:, :, None], axis=1) + moving.pose[:, :, 3]
    there = jnp.broadcast_to((moving.instance >= 0)[:, None], (moving.instance.shape[0], EDGES))
    return Boxes(
        center=jnp.concatenate([physics.collider_pos[house], center]),
        axis=jnp.concatenate([axis, columns / stretch[:, :, None]]),
        half=jnp.concatenate([physics.collider_size[house], (box[:, 1] - box[:, 0]) / 2 * stretch]),
        exposed=jnp.concatenate([exposed, there]),
        object_id=jnp.concatenate([physics.collider_object[house], moving.object_id]),
    )


def bent_paths(scene: Scene, source: Source, listener: Listener, config: AudioConfig) -> Paths:
    """The straight path and those around edges, by the uniform theory of diffraction.

    While the straight path is free it is the only one, and edges near it make it softer or a little louder; where
    something blocks it, sound comes from the edges, and through partitions. Both are equally loud where the one takes
    over from the other. What objects let through counts only where no edge leads around them.

    Args:
        scene: The environment.
        source: Who sounds.
        listener: Who hears.
        config: Options.

    Returns:
        1 + `config.num_edges` paths.
    """
    straight = cross(scene, source, listener, config)
    found = _nearest(scene, source, listener, config.num_edges)
    heard = _heard(scene, source, listener, found)
    return assembled_paths(straight, found, heard, listener.pos, config)


def assembled_paths(
    straight: Straight, found: Strings, heard: Bool[Array, " k"], ears: Float[Array, "3"], config: AudioConfig
) -> Paths:
    """The paths that a straight line and strings make, see `bent_paths`.

    Args:
        straight: What the straight line meets.
        found: Strings, of finite detour where there are any.
        heard: Those whose ends source and listener see.
        ears: Where the listener is [m].
        config: Options.
    """
    field = _field(found, straight.distance, straight.clear, config)
    around = jnp.any(heard & field.shadow & (jnp.max(field.share, axis=1) > 0.5))
    free = straight.clear | (~around & straight.within)
    share = jnp.where(heard[:, None], field.share, 0.0)
    near = _octaves(_near_edges(field.amplitude, share))
    hidden = straight.partitions * jnp.where(around & straight.within, 0.0, straight.objects)
    energy = jnp.concatenate(
        [
            jnp.where(free, near * straight.objects, hidden)[None],
            jnp.where(free, 0.0, _octaves(share * jnp.abs(field.amplitude) ** 2)),
        ]
    )
    length = straight.distance + jnp.where(heard, found.detour, 0.0)
    length = jnp.concatenate([straight.distance[None], length])
    gain = jnp.sqrt(energy * jnp.exp(-air_energy(config)[None] * length[:, None])) / straight.distance
    away = found.last - ears[None]
    away = away / jnp.maximum(jnp.linalg.norm(away, axis=1), NEAREST)[:, None]
    return Paths(length, jnp.where(straight.silent, 0.0, gain), jnp.concatenate([straight.direction[None], away]))


def _nearest(scene: Scene, source: Source, listener: Listener, count: int) -> Strings:
    """The strings of the least detour."""
    found = strings(house_boxes(scene), source.pos, listener.pos)
    body = found.object_id
    own = (body >= 0) & ((body == jnp.int32(source.body)) | (body == jnp.int32(listener.body)))
    detour = jnp.where(own, jnp.inf, found.detour)
    _, nearest = jax.lax.top_k(-detour, min(count, detour.size))
    return jax.tree.map(lambda x: x[nearest], found.replace(detour=detour))


def _field(found: Strings, distance: Float[Array, ""], clear: Bool[Array, ""], config: AudioConfig) -> _Field:
    frequency = np.array(BANDS)[:, None] * 2.0 ** np.array(SPREAD)
    wavenumber = jnp.asarray(2 * np.pi * frequency.ravel() / config.speed_of_sound, jnp.float32)
    shadow = found.bend.turn > 0
    # What rays see is not in a shadow, whatever the boxes say that stand for meshes.
    bend = found.bend._replace(turn=jnp.where(clear, jnp.minimum(found.bend.turn, FREE), found.bend.turn))
    detour = jnp.where(jnp.isfinite(found.detour), found.detour, 0.0)
    angle = -detour[:, None] * wavenumber[None]
    loss = second_edge(found.turn, found.reach, wavenumber) * (distance / (distance + detour))[:, None]
    amplitude = diffracted(bend, wavenumber) * jax.lax.complex(loss * jnp.cos(angle), loss * jnp.sin(angle))
    harmonic = bend.near * bend.far / (bend.near + bend.far)
    zone = jnp.sqrt((jnp.pi / 2 * harmonic / bend.slope**3)[:, None] / wavenumber[None])
    low, high = (found.beyond[:, i, None] / zone for i in range(2))
    return _Field(amplitude, jax.scipy.stats.norm.cdf(high) - jax.scipy.stats.norm.cdf(low), shadow)


def _near_edges(amplitude: Complex[Array, "k f"], share: Float[Array, "k f"]) -> Float[Array, " f"]:
    """Energy of the straight path together with edges that it passes, re the free field.

    Each edge adds its energy; only those as strong as the strongest interfere with the straight path, so that the sum
    at a shadow boundary is what is heard behind it.
    """
    power = jnp.abs(amplitude) ** 2
    strongest = jnp.max(power * jnp.minimum(4 * share, 1.0), axis=0)
    weight = jnp.minimum(power / jnp.maximum(strongest, 1e-12)[None], 1.0) ** 2
    return jnp.maximum(1 + jnp.sum(share * (power + 2 * weight * jnp.real(amplitude)), axis=0), 0.0)


def _octaves(power: Float[Array, "*k f"]) -> Float[Array, "*k bands"]:
    """Means over the frequencies of each octave."""
    return jnp.mean(power.reshape(*power.shape[:-1], len(BANDS), len(SPREAD)), axis=-1)


def _heard(scene: Scene, source: Source, listener: Listener, found: Strings) -> Bool[Array, " k"]:
    """Whether the source sees where a string leaves its side, and the listener where it arrives."""
    there = jnp.isfinite(found.detour)

    def hidden(start: Float[Array, "3"], end: Float[Array, "k 3"], body: Int[Array, ""] | int) -> Bool[Array, " k"]:
        way = end - start[None]
        length = jnp.linalg.norm(way, axis=1)
        direction = way / jnp.maximum(length, NEAREST)[:, None]
        reach = jnp.where(there, length - SKIN, -1.0)
        return occluded(scene, start, direction, t_max=reach, exclude=body, mask=int(Ray.SOUND))

    return there & ~hidden(source.pos, found.first, source.body) & ~hidden(listener.pos, found.last, listener.body)
