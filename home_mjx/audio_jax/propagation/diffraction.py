"""Diffraction of direct sound at edges: interference near edges, and sound in their shadows."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Complex, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.geometry.box_lengths import WITHOUT_EDGES
from home_mjx.audio_jax.geometry.edge_paths import BarrierBoxes, EdgePaths, find_edge_paths
from home_mjx.audio_jax.geometry.nearest_boxes import nearest_boxes
from home_mjx.audio_jax.geometry.wedge import diffracted_pressure, second_edge_factor
from home_mjx.audio_jax.propagation.paths import (
    MIN_PATH_LENGTH,
    RAY_OFFSET,
    Paths,
    StraightLine,
    air_attenuation,
    is_duplicate,
    trace_straight_line,
)
from home_mjx.core.transforms import quat_matrix
from home_mjx.geometry.diffraction_edges import NUM_EDGES
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, RayKind

OCTAVE_SAMPLES = (-1 / 3, 0.0, 1 / 3)  # [octaves] re the centre, frequencies at which each octave is evaluated
BOXES_PER_EDGE = 3  # candidate boxes per rendered edge
MAX_APEX_DISTANCE = 0.02  # [m], maximum distance between apexes of strings over pieces of one edge
MAX_EDGE_SEPARATION = 0.02  # [m], maximum distance of edges that act as one, as of two walls back to back
MAX_RELATIVE_ENERGY = 1.7  # maximum energy re the free field, next to edges
GRAZING_ANGLE = 1e-3  # [rad], angle to a shadow boundary below which rays decide on which side the listener is
MIN_LEADING_SHARE = 0.1  # minimum share of the wavefront over an edge for it to be the leading string


class _DirectField(NamedTuple):
    """Energies of direct sound at the frequencies of all octaves, re the free field of the straight path."""

    straight: Float[Array, " f"]  # energy of the straight path with the diffraction of edges that it passes
    bent: Float[Array, "k f"]  # energy of each string if the straight path is blocked
    around: Bool[Array, ""]  # whether a string leads around the obstacle


def barrier_boxes(scene: Scene) -> BarrierBoxes:
    """Return the boxes of the house (static), then of movable objects, doors and agents, in the world.

    Unused slots have no exposed edges.
    """
    static = jax.tree.map(lambda x: x[scene.house], _static_boxes(scene))
    return jax.tree.map(lambda *parts: jnp.concatenate(parts), static, _moving_boxes(scene))


def _static_boxes(scene: Scene) -> BarrierBoxes:
    """Return the static boxes of all houses, with a leading axis of houses."""
    physics = scene.bank.physics
    bits = scene.bank.acoustics.collider_edges
    return BarrierBoxes(
        center=physics.collider_pos,
        axis=jnp.swapaxes(jax.vmap(jax.vmap(quat_matrix))(physics.collider_quat), 2, 3),
        half=physics.collider_size,
        exposed=(bits[..., None] >> jnp.arange(NUM_EDGES, dtype=jnp.int32)[None, None]) & 1 == 1,
        object_id=physics.collider_object,
    )


def _moving_boxes(scene: Scene) -> BarrierBoxes:
    """Return bounding boxes of movable objects, doors and agents, in the world; unused slots have no exposed edges.

    All edges of the others are exposed.
    """
    moving = scene.moving
    box = scene.geometry.model_box[moving.model]
    columns = jnp.swapaxes(moving.pose[:, :, :3], 1, 2)
    stretch = jnp.maximum(jnp.linalg.norm(columns, axis=2), 1e-6)
    center = jnp.sum(columns * jnp.mean(box, axis=1)[:, :, None], axis=1) + moving.pose[:, :, 3]
    return BarrierBoxes(
        center=center,
        axis=columns / stretch[:, :, None],
        half=(box[:, 1] - box[:, 0]) / 2 * stretch,
        exposed=jnp.broadcast_to((moving.instance >= 0)[:, None], (moving.instance.shape[0], NUM_EDGES)),
        object_id=moving.object_id,
    )


def nearest_barriers(scene: Scene, source: SoundSource, listener: Listener, count: int) -> BarrierBoxes:
    """Select the boxes with exposed edges over which the path from source to listener is shortest.

    Boxes of the source's and the listener's bodies have no exposed edges.

    Args:
        scene: The environment.
        source: The source.
        listener: The listener.
        count: Maximum number of boxes.

    Returns:
        `count` boxes, or all if there are fewer, shortest path first; those without exposed edges come last.
    """
    static, moving = _static_boxes(scene), _moving_boxes(scene)
    bodies = jnp.stack([jnp.asarray(body, jnp.int32) for body in (source.body, listener.body)])
    chosen = nearest_boxes(
        _box_rows(static),
        _box_owners(static),
        scene.house,
        _box_rows(moving),
        _box_owners(moving),
        source.pos,
        listener.pos,
        bodies,
        count,
    )
    num_static, num_moving = static.object_id.shape[1], moving.object_id.shape[0]
    place = scene.house, jnp.minimum(chosen, num_static - 1)
    boxes = jax.tree.map(lambda x: x[place], static)
    if num_moving:
        other = jnp.clip(chosen - num_static, 0, num_moving - 1)
        boxes = jax.tree.map(
            lambda a, b: jnp.where((chosen < num_static).reshape(-1, *[1] * (b.ndim - 1)), a, b[other]), boxes, moving
        )
    own = (boxes.object_id >= 0) & jnp.any(boxes.object_id[:, None] == bodies[None], axis=1)
    return boxes.replace(exposed=boxes.exposed & ~own[:, None])


def _box_rows(boxes: BarrierBoxes) -> Float[Array, "*h 15 n"]:
    """Return centres, axes and half sizes of boxes as rows, see `nearest_boxes`."""
    axes = boxes.axis.reshape(*boxes.center.shape[:-1], 9)
    return jnp.swapaxes(jnp.concatenate([boxes.center, axes, boxes.half], axis=-1), -1, -2)


def _box_owners(boxes: BarrierBoxes) -> Int[Array, "*h n"]:
    """Return the object of each box; `WITHOUT_EDGES` if it has no exposed edge."""
    return jnp.where(jnp.any(boxes.exposed, axis=-1), boxes.object_id, WITHOUT_EDGES)


def diffracted_paths(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> Paths:
    """Compute the direct path and diffracted paths around edges, by the uniform theory of diffraction.

    If the straight path is free it is the only one, and edges near it attenuate or slightly amplify it. If it is
    blocked, sound arrives from the edges and through partitions. The level is continuous between the two cases.
    Transmission through objects counts only if no edge leads around them.

    Returns:
        1 + `config.early.num_edges` paths, silent ones included; the first is the direct one. There are fewer if the
        scene has less than one box per 24 edges.
    """
    straight = trace_straight_line(scene, source, listener, config)
    found = _select_edge_paths(scene, source, listener, config.early.num_edges)
    is_visible = _is_visible(scene, source, listener, found)
    return assemble_paths(straight, found, is_visible, listener.pos, config)


def assemble_paths(
    straight: StraightLine,
    edge_paths: EdgePaths,
    is_visible: Bool[Array, " k"],
    ears: Float[Array, "3"],
    config: AudioConfig,
) -> Paths:
    """Return the direct path, then one path per string (taut string over edges), see `diffracted_paths`.

    Gains include absorption by air. All paths are silent if the straight line is over the limit of crossings.

    Args:
        straight: Surfaces on the straight line.
        edge_paths: The k strings.
        is_visible: Whether source and listener see the string's ends; other strings are silent.
        ears: Position of the listener [m], world.
        config: Options.
    """
    field = _direct_field(straight, edge_paths, is_visible & ~_find_duplicates(edge_paths, is_visible), config)
    free = straight.is_clear | (~field.around & straight.is_partition_free)
    passed = jnp.where(straight.is_clear, _average_octaves(field.straight), straight.object_transmission)
    hidden = straight.partition_transmission * jnp.where(
        field.around & straight.is_partition_free, 0.0, straight.object_transmission
    )
    direct = jnp.where(free, passed, hidden)
    energy = jnp.concatenate([direct[None], jnp.where(free, 0.0, _average_octaves(field.bent))])
    length = straight.distance + jnp.where(is_visible, edge_paths.infinite_edge_detour, 0.0)
    length = jnp.concatenate([straight.distance[None], length])
    gain = jnp.sqrt(energy * jnp.exp(-air_attenuation(config)[None] * length[:, None])) / straight.distance
    ahead, mouth = straight.direction[None], ears + straight.distance * straight.direction
    comes = jnp.concatenate([ahead, _unit_vectors(edge_paths.listener_side_point, ears)])
    leaves = jnp.concatenate([-ahead, _unit_vectors(edge_paths.source_side_point, mouth)])
    return Paths(length, jnp.where(straight.is_over_limit, 0.0, gain), comes, departure=leaves)


def _unit_vectors(point: Float[Array, "k 3"], start: Float[Array, "3"]) -> Float[Array, "k 3"]:
    """Return unit vectors from `start` to each point; shorter ones within `MIN_PATH_LENGTH`."""
    away = point - start[None]
    return away / jnp.maximum(jnp.linalg.norm(away, axis=1), MIN_PATH_LENGTH)[:, None]


def _select_edge_paths(scene: Scene, source: SoundSource, listener: Listener, count: int) -> EdgePaths:
    """Select the `count` strings of least detour, missing ones (inf) last; fewer if the scene has few boxes.

    A string goes over one edge, or two parallel ones, of a box near the path. Boxes of the source's and the
    listener's bodies have no edges.
    """
    found = find_edge_paths(nearest_barriers(scene, source, listener, BOXES_PER_EDGE * count), source.pos, listener.pos)
    _, nearest = jax.lax.top_k(-found.finite_edge_detour, min(count, found.finite_edge_detour.size))
    return jax.tree.map(lambda x: x[nearest], found)


def _direct_field(
    straight: StraightLine, found: EdgePaths, is_visible: Bool[Array, " k"], config: AudioConfig
) -> _DirectField:
    """Compute energies of direct sound by the strings in the mask `is_visible`, with and without the straight path.

    With it, `straight` is their sum. Without it, `bent` has each string's incoherent rest. The leading string also has
    the energy of the coherent sum, including sound past the ends of edges. It is the shortest string with a share above
    `MIN_LEADING_SHARE`.

    Amplitudes add with weights exp(-(phase / π)²), and the rest of each string's energy adds incoherently. Phases are
    re the straight path, or without it re the leading string.
    """
    frequency = np.array(BANDS)[:, None] * 2.0 ** np.array(OCTAVE_SAMPLES)
    wavenumber = jnp.asarray(2 * np.pi * frequency.ravel() / config.speed_of_sound, jnp.float32)
    amplitude, share = _amplitudes(straight, found, is_visible, wavenumber)
    detour = jnp.where(is_visible, found.infinite_edge_detour, jnp.inf)
    first = jnp.argmin(jnp.where(jnp.max(share, axis=1) > MIN_LEADING_SHARE, detour, jnp.inf))
    power = jnp.abs(amplitude) ** 2

    def added(start: Float[Array, " f"], extra_length: Float[Array, " k"], most: float) -> tuple[Array, Array]:
        """Return the energy of the coherent sum with `start`, at most `most`, and the incoherent rest per string.

        `extra_length` is the length of each string re the reference of phases [m].
        """
        phase = wavenumber[None] * jnp.where(is_visible, extra_length, 0.0)[:, None]
        together = jnp.exp(-((phase / jnp.pi) ** 2))
        whole = jnp.sum(amplitude * together.astype(jnp.complex64), axis=0) + start.astype(jnp.complex64)
        return jnp.minimum(jnp.abs(whole) ** 2, most), power * (1 - together**2)

    near, rest = added(jnp.ones_like(wavenumber), found.infinite_edge_detour, MAX_RELATIVE_ENERGY)
    joined, alone = added(
        _amplitude_past_ends(straight, found, share),
        found.infinite_edge_detour - found.infinite_edge_detour[first],
        1.0,
    )
    behind = (found.blocked & (found.wedge.shadow_angle > 0)) | (jnp.abs(found.wedge.shadow_angle) < GRAZING_ANGLE)
    shadow = is_visible & behind & (jnp.max(share, axis=1) > 0.5)
    there = (jnp.arange(is_visible.size, dtype=jnp.int32) == first)[:, None]
    return _DirectField(near + jnp.sum(rest, axis=0), alone + jnp.where(there, joined[None], 0.0), jnp.any(shadow))


def _amplitude_past_ends(straight: StraightLine, found: EdgePaths, share: Float[Array, "k f"]) -> Float[Array, " f"]:
    """Return the amplitude that passes beyond the ends of edges re the free field, 0 to 1; 0 behind partitions.

    It is 1 minus the largest sum of `share` over the pieces of one edge, counting edges with the listener in shadow.
    """
    apart = jnp.max(jnp.abs(found.apex[:, None] - found.apex[None]), axis=-1)
    one_edge = ((apart < MAX_APEX_DISTANCE) & (found.wedge.shadow_angle > 0)[None]).astype(jnp.float32)
    covered = jnp.max(jnp.einsum("ef,fb->eb", one_edge, share, precision="highest"), axis=0)
    return jnp.where(straight.is_partition_free, jnp.clip(1 - covered, 0.0, 1.0), 0.0)


def _amplitudes(
    straight: StraightLine, found: EdgePaths, is_visible: Bool[Array, " k"], wavenumber: Float[Array, " f"]
) -> tuple[Complex[Array, "k f"], Float[Array, "k f"]]:
    """Compute each string's complex pressure re the free straight path, and its share of an infinite edge's wavefront.

    Both are 0 unless `is_visible`. The share is the normal distribution between both ends of the edge, in Fresnel zones
    from the apex of an infinite one.
    """
    # A point that rays see is not in shadow, even if the box around a mesh blocks the line.
    seen = straight.is_clear & found.blocked
    turn = jnp.where(seen, jnp.minimum(found.wedge.shadow_angle, -GRAZING_ANGLE), found.wedge.shadow_angle)
    grazing = ~straight.is_clear & (jnp.abs(turn) < GRAZING_ANGLE)
    bend = found.wedge._replace(shadow_angle=jnp.where(grazing, GRAZING_ANGLE, turn))
    harmonic = bend.source_distance * bend.listener_distance / (bend.source_distance + bend.listener_distance)
    zone = jnp.sqrt((jnp.pi / 2 * harmonic / bend.sin_incidence**3)[:, None] / wavenumber[None])
    low, high = (jax.scipy.stats.norm.cdf(found.edge_extent[:, i, None] / zone) for i in range(2))
    share = jnp.where(is_visible[:, None], high - low, 0.0)
    spread = (straight.distance / (straight.distance + found.infinite_edge_detour))[:, None]
    size = share * second_edge_factor(found.second_turn, found.second_edge_reach, wavenumber) * spread
    angle = -found.infinite_edge_detour[:, None] * wavenumber[None]
    turned = jax.lax.complex(size * jnp.cos(angle), size * jnp.sin(angle))
    return jnp.where(is_visible[:, None], diffracted_pressure(bend, wavenumber) * turned, 0), share


def _find_duplicates(found: EdgePaths, is_visible: Bool[Array, " k"]) -> Bool[Array, " k"]:
    """Return which strings touch the same edge, within 2 cm, as an earlier one that is visible.

    Two faces at an edge yield such strings.
    """
    place = jnp.concatenate([found.apex, found.listener_side_point, found.edge_extent], axis=1)
    same = jnp.max(jnp.abs(place[:, None] - place[None]), axis=-1) < MAX_EDGE_SEPARATION
    return is_duplicate(same & is_visible[None])


def _average_octaves(power: Float[Array, "*k f"]) -> Float[Array, "*k bands"]:
    """Average energies over the `OCTAVE_SAMPLES` frequencies of each octave; f is (octave, sample), flattened."""
    return jnp.mean(power.reshape(*power.shape[:-1], len(BANDS), len(OCTAVE_SAMPLES)), axis=-1)


def _is_visible(scene: Scene, source: SoundSource, listener: Listener, found: EdgePaths) -> Bool[Array, " k"]:
    """Return whether the source sees the string's first point and the listener its last one; False without path.

    Neither one's own body occludes.
    """
    there = jnp.isfinite(found.finite_edge_detour)

    def hidden(start: Float[Array, "3"], end: Float[Array, "k 3"], body: Int[Array, ""] | int) -> Bool[Array, " k"]:
        """Return whether lines from `start` to the points `end` are occluded; False for missing paths."""
        way = end - start[None]
        length = jnp.linalg.norm(way, axis=1)
        direction = way / jnp.maximum(length, MIN_PATH_LENGTH)[:, None]
        reach = jnp.where(there, length - RAY_OFFSET, -1.0)
        return occluded(scene, start, direction, t_max=reach, exclude=body, mask=int(RayKind.SOUND))

    return (
        there
        & ~hidden(source.pos, found.source_side_point, source.body)
        & ~hidden(listener.pos, found.listener_side_point, listener.body)
    )
