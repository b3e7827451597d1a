"""Higher-order reflections: image sources in walls and faces of boxes, validated by ray casts."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.geometry.image_sources import ImageSources, Mirrors, find_image_sources, select_nearest_mirrors
from home_mjx.audio_jax.propagation.diffraction import barrier_boxes
from home_mjx.audio_jax.propagation.paths import (
    MAX_PATH_NAMES,
    MIN_PATH_LENGTH,
    RAY_OFFSET,
    Paths,
    air_attenuation,
    empty_paths,
    is_duplicate,
)
from home_mjx.audio_jax.propagation.surfaces import surface_at
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import MAX_MIRROR_DISTANCE, RayKind

MAX_MIRRORS = {1: (32, 32), 2: (12, 8), 3: (8, 4)}  # maximum numbers of walls and of faces of objects, by order
MIN_LEG_LENGTH = 1e-3  # [m], minimum length of a leg with a direction
# Quantization steps of names per unit of a normal and per metre. An irregular value keeps planes at round coordinates
# away from rounding boundaries.
NAME_STEPS = 29.37
DUPLICATE_TOLERANCE = 1e-3  # [m], and per unit of direction: tolerance within which paths are duplicates


def house_mirrors(scene: Scene) -> Mirrors:
    """Return the mirror rectangles of the environment's house: walls, floors and ceilings; padding is not valid.

    They have no material: it is that of the surface that rays hit.
    """
    planes = scene.bank.acoustics
    flat = planes.plane_center, planes.plane_normal, planes.plane_u, planes.plane_v, planes.plane_valid
    return Mirrors(*(x[scene.house] for x in flat))


def object_mirrors(scene: Scene, source: SoundSource, listener: Listener) -> Mirrors:
    """Return six faces per box of `barrier_boxes`, which reflect outside; valid are those of objects.

    Faces of architecture and of the bodies of source and listener are not valid.
    """
    boxes = barrier_boxes(scene)
    own = (boxes.object_id == jnp.int32(source.body)) | (boxes.object_id == jnp.int32(listener.body))
    order = np.array([[(a + i) % 3 for i in range(3)] for a in range(3) for _ in (0, 1)])
    side = jnp.asarray(np.tile([-1.0, 1.0], 3), jnp.float32)[None, :, None]
    out, u, v = (boxes.axis[:, order[:, i]] * boxes.half[:, order[:, i], None] for i in range(3))
    center, normal = boxes.center[:, None] + out * side, boxes.axis[:, order[:, 0]] * side
    thing = jnp.broadcast_to(((boxes.object_id >= 0) & ~own)[:, None], out.shape[:2])
    faces = Mirrors.build_unchecked(center=center, normal=normal, u=u, v=v, valid=thing)
    return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), faces)


def image_source_reflections(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> Paths:
    """Compute image sources up to `config.early.reflection_order` in walls and faces of furniture, the shortest first.

    Sequences are made of the mirrors nearest to source and listener (`MAX_MIRRORS`). A path is audible if each leg
    hits a surface in the plane of its mirror and the last leg reaches the source. Its energy is the product of
    (1 - absorption) (1 - scattering) over these surfaces and of absorption by air. Duplicates are silent.

    Returns:
        `config.early.num_reflections` paths, or one per sequence if there are fewer. Silent ones have gain 0, and
        length 1 m if geometry excludes them or they are duplicates.
    """
    if config.early.num_reflections == 0:
        return empty_paths()
    order = config.early.reflection_order
    kinds = house_mirrors(scene), object_mirrors(scene, source, listener)
    kept = [
        select_nearest_mirrors(kind, source.pos, listener.pos, count)
        for kind, count in zip(kinds, MAX_MIRRORS[order], strict=True)
    ]
    mirrors = jax.tree.map(lambda *x: jnp.concatenate(x), *kept)
    found = find_image_sources(mirrors, source.pos, listener.pos, order)
    _, shortest = jax.lax.top_k(-found.length, min(config.early.num_reflections, found.length.size))
    found = jax.tree.map(lambda x: x[shortest], found)
    away = found.point[:, 0] - listener.pos[None]
    direction = away / jnp.maximum(jnp.linalg.norm(away, axis=1), MIN_PATH_LENGTH)[:, None]
    energy = _reflected_energy(scene, source, listener, found)
    possible = jnp.isfinite(found.length) & ~find_duplicates(found.length, direction)
    length = jnp.where(possible, found.length, 1.0)
    energy = energy * jnp.exp(-length[:, None] * air_attenuation(config)[None])
    gain = jnp.sqrt(jnp.maximum(energy, 0.0)) / jnp.maximum(length, MIN_PATH_LENGTH)[:, None]
    gain = jnp.where(possible[:, None], gain, 0.0)
    return Paths(length, gain, direction, path_names(found), _departures(found, source.pos))


def _departures(found: ImageSources, source: Float[Array, "3"]) -> Float[Array, "p 3"]:
    """Return unit vectors from the source to the last reflection, counted from the listener."""
    last = jnp.take_along_axis(found.point, found.order[:, None, None] - 1, axis=1)[:, 0]
    way = last - source[None]
    return way / jnp.maximum(jnp.linalg.norm(way, axis=1), MIN_PATH_LENGTH)[:, None]


def path_names(found: ImageSources) -> Int[Array, " p"]:
    """Hash the mirror planes of each path to a name below `MAX_PATH_NAMES`, stable while source and listener move."""
    order = jnp.arange(found.point.shape[1], dtype=jnp.int32)[None]
    depth = jnp.sum(found.normal * found.point, axis=2)
    plane = jnp.concatenate([found.normal, depth[:, :, None]], axis=2)
    parts = jnp.round(plane * NAME_STEPS).astype(jnp.int32) * jnp.array([1, 73, 5419, 401_231], jnp.int32)[None, None]
    each = jnp.sum(parts, axis=2) * (2 * order + 1) + order
    return jnp.abs(jnp.sum(jnp.where(order < found.order[:, None], each, 0), axis=1)) % MAX_PATH_NAMES


def _reflected_energy(
    scene: Scene, source: SoundSource, listener: Listener, found: ImageSources
) -> Float[Array, "p bands"]:
    """Compute the share of energy reflected on each path: the product of (1 - absorption) (1 - scattering) at its hits.

    It is 0 if a leg is occluded or misses its mirror, and 1 for paths of length inf.
    """
    count, order = found.point.shape[:2]
    ends = jnp.broadcast_to(listener.pos, (count, 1, 3)), jnp.broadcast_to(source.pos, (count, 1, 3))
    corner = jnp.concatenate([ends[0], found.point, ends[1]], axis=1)
    origin, way = corner[:, :-2], corner[:, 1:-1] - corner[:, :-2]
    length = jnp.linalg.norm(way, axis=2)
    # The leg between two reflections in one corner has no length: a ray against the normal hits the second surface.
    none = length < MIN_LEG_LENGTH
    toward = jnp.where(none[:, :, None], -found.normal, way / jnp.maximum(length, MIN_LEG_LENGTH)[:, :, None])
    origin = origin - jnp.where(none, MAX_MIRROR_DISTANCE, 0.0)[:, :, None] * toward
    length = jnp.where(none, MAX_MIRROR_DISTANCE, length)
    number = jnp.arange(order, dtype=jnp.int32)[None]
    used = jnp.isfinite(found.length)[:, None] & (number < found.order[:, None])
    start = jnp.where((number == 0) | none, 0.0, jnp.minimum(MAX_MIRROR_DISTANCE, length / 2))
    own = jnp.broadcast_to(jnp.where(number == 0, jnp.int32(listener.body), -1), used.shape)
    rays = (x.reshape(count * order, *x.shape[2:]) for x in (origin, toward, length, start, own, used))
    origin, toward, reach, begin, body, alive = rays
    hit = cast(
        scene,
        origin,
        toward,
        t_min=begin,
        t_max=jnp.where(alive, reach + MAX_MIRROR_DISTANCE, -1.0),
        exclude=body,
        mask=int(RayKind.SOUND),
    )
    met = surface_at(scene, toward, hit)
    there = (hit.instance >= 0) & (jnp.abs(hit.t - reach) < MAX_MIRROR_DISTANCE)
    share = jnp.where(there[:, None], (1 - met.absorption) * (1 - met.scattering), 0.0)
    share = jnp.where(alive[:, None], share, 1.0).reshape(count, order, -1)
    hidden = _is_occluded(scene, source, found, corner, used)
    return jnp.where(hidden[:, None], 0.0, jnp.prod(share, axis=1))


def _is_occluded(
    scene: Scene, source: SoundSource, found: ImageSources, corner: Float[Array, "p k 3"], used: Bool[Array, "p legs"]
) -> Bool[Array, " p"]:
    """Return whether the leg from the source to the last reflection, counted from the listener, is occluded.

    It is False for paths that `used` excludes.
    """
    last = jnp.take_along_axis(corner, found.order[:, None, None], axis=1)[:, 0]
    way = last - source.pos[None]
    length = jnp.linalg.norm(way, axis=1)
    reach = jnp.where(used[:, 0], length - MAX_MIRROR_DISTANCE, -1.0)
    direction = way / jnp.maximum(length, RAY_OFFSET)[:, None]
    return occluded(scene, source.pos, direction, t_max=reach, exclude=source.body, mask=int(RayKind.SOUND))


def find_duplicates(length: Float[Array, " p"], direction: Float[Array, "p 3"]) -> Bool[Array, " p"]:
    """Return which paths have the length [m] and unit direction of an earlier one, each within 0.001.

    Coplanar faces of two boxes yield such paths.
    """
    near = jnp.abs(length[:, None] - length[None]) < DUPLICATE_TOLERANCE
    near &= jnp.max(jnp.abs(direction[:, None] - direction[None]), axis=-1) < DUPLICATE_TOLERANCE
    return is_duplicate(near)
