"""Path model of HoME (2017), for comparison with it: a producer for `early_paths`, and responses of its paths.

Paths are specular only. The level of a path of length L over materials with absorption α is, per octave,
20 lg(1 / L) + 20 lg(1 - m L) + Σ 20 lg(1 - α) dB. This is not physical: α and m are energy fractions, which HoME
applies to pressure. HoME also omits the material of one reflection, so first-order paths lose nothing; here it is the
reflection next to the listener. Objects are boxes around their models; doors are omitted.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from benchmarks.home2017.boxes import (
    LEG_END_MARGIN,
    ModelBoxes,
    box_mirrors,
    is_occluded_by_boxes,
    model_boxes,
)
from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Air, EarlyPaths, NoLate, Omni
from home_mjx.audio_jax.geometry.image_sources import ImageSources, find_image_sources, select_nearest_mirrors
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.image_source_paths import (
    MIN_LEG_LENGTH,
    find_duplicates,
    house_mirrors,
    path_names,
)
from home_mjx.audio_jax.propagation.paths import MIN_PATH_LENGTH, RAY_OFFSET, Paths
from home_mjx.audio_jax.propagation.surfaces import sound_materials, surface_at
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, MAX_MIRROR_DISTANCE, RayKind

TEMPERATURES, HUMIDITIES = (10.0, 20.0), (40.0, 60.0, 80.0)  # [degrees Celsius], [%]
# Coefficients per octave [1/1000 m]: Vorländer, Auralization, 2008. They are for energy; HoME applies them to pressure.
COEFFICIENTS = np.array(
    [
        [
            [0.1, 0.2, 0.5, 1.1, 2.7, 9.4, 29.0],
            [0.1, 0.2, 0.5, 0.8, 1.8, 5.9, 21.1],
            [0.1, 0.2, 0.5, 0.7, 1.4, 4.4, 15.8],
        ],
        [
            [0.1, 0.3, 0.6, 1.0, 1.9, 5.8, 20.3],
            [0.1, 0.3, 0.6, 1.0, 1.7, 4.1, 13.5],
            [0.1, 0.3, 0.6, 1.1, 1.7, 3.5, 10.6],
        ],
    ]
)
MIN_REMAINING_PRESSURE = 1e-7  # minimum remaining share of the pressure, so that levels stay finite
MAX_MIRRORS = {1: (64, 256), 2: (40, 120), 3: (16, 16)}  # maximum numbers of room and box mirrors, by order
CANDIDATES_PER_PATH = 4  # candidate sequences per path, because several sequences can yield the same path
MIN_REFLECTANCE = 1e-7  # minimum of 1 - α, as in HoME's float32
MAX_ATTENUATION = 120.0  # [dB], attenuation of all octaves from which a path is dropped
SAMPLE_MARGIN = 1e-5  # [m], excess over whole samples, against rounding down by one

HOME2017 = AudioConfig(  # `humidity` selects HoME's row of 60 %
    response_seconds=1.0,
    air=Air(humidity=65.0),
    early=EarlyPaths(num_reflections=62, reflection_order=3),
    late=NoLate(),
    receiver=Omni(),
)


class _Legs(Pytree):
    """Straight legs of p paths from the listener on, each up to a reflection or the source."""

    start: Float[Array, "p k 3"]
    end: Float[Array, "p k 3"]
    normal: Float[Array, "p k 3"]  # of the mirror at its end; 0 at the source
    material: Int[Array, "p k"]  # row of the material table if that mirror is a face of a box; -1 otherwise
    to_shell: Bool[Array, "p k"]  # whether that mirror is a wall, floor or ceiling
    from_shell: Bool[Array, "p k"]  # whether the leg begins on a wall, floor or ceiling
    last: Bool[Array, "p k"]  # whether the leg ends at the source
    used: Bool[Array, "p k"]  # False for padding


def home2017_paths(scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig) -> Paths:
    """Compute the direct path and image sources up to `config.early.reflection_order` with HoME's lengths and levels.

    There are two differences. HoME applies a random sign to each path; this function does not. HoME enumerates all
    mirrors; here only those nearest to source and listener are used (`MAX_MIRRORS`).

    Args:
        scene: The environment.
        source: The source.
        listener: The listener.
        config: Options; uses `early` without `num_edges`, and temperature and humidity of `air`.

    Returns:
        1 + `config.early.num_reflections` paths, or fewer if there are fewer sequences; silent ones included.

    Example:
        >>> home2017_paths(scene, source, listener, HOME2017).distance.shape  # doctest: +SKIP
        (63,)
    """
    boxes = model_boxes(scene, source, listener)
    found, material = _find_images(scene, boxes, source, listener, config)
    legs = _legs(found, material, source, listener)
    free, absorption = _trace_legs(scene, legs, config)
    hidden = is_occluded_by_boxes(boxes, legs.start.reshape(-1, 3), legs.end.reshape(-1, 3)).reshape(legs.used.shape)
    heard = jnp.isfinite(found.length) & jnp.all((free & ~hidden) | ~legs.used, axis=1)
    length = jnp.maximum(jnp.where(heard, found.length, 1.0), MIN_PATH_LENGTH)
    counts = (legs.used & ~legs.last).at[:, 0].set(False)  # not the reflection next to the listener
    lost = jnp.where(counts[:, :, None], 20 * jnp.log10(jnp.maximum(1 - absorption, MIN_REFLECTANCE)), 0.0)
    air = home2017_air_level(length, config.air.temperature, config.air.humidity)
    level = air + jnp.sum(lost, axis=1) - 20 * jnp.log10(length)[:, None]
    heard = heard & jnp.any(jnp.abs(level) < MAX_ATTENUATION, axis=1)
    gain = jnp.where(heard[:, None], 10 ** (level / 20), 0.0)
    return Paths(length, gain, _directions_to(found.point[:, 0], listener), path_names(found))


def home2017_response(
    scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig = HOME2017
) -> Float[Array, "e l"]:
    """Compute the impulse response of HoME's paths, delayed by whole samples, without late reverberation.

    Args:
        scene: The environment.
        source: The source, omnidirectional.
        listener: The listener.
        config: Options; `num_edges`, `late` and `motion` have no effect.

    Example:
        >>> home2017_response(scene, source, listener).shape  # doctest: +SKIP
        (2, 16000)
    """
    paths = early_paths(scene, source, listener, config, producers=[home2017_paths])
    rate = config.sample_rate / config.speed_of_sound
    paths = paths.replace(distance=jnp.floor(paths.distance * rate) / rate + SAMPLE_MARGIN)
    return early_response(paths, listener.quat, config, listener.head)


def home2017_air_level(
    distance: Float[Array, " p"], temperature: float = 20.0, humidity: float = 65.0
) -> Float[Array, "p bands"]:
    """Compute the level change by air over a distance d [dB] by HoME's rule 20 lg(1 - m d), m from the nearest row.

    Args:
        distance: [m].
        temperature: [degrees Celsius].
        humidity: Relative humidity [%].

    Example:
        >>> round(float(home2017_air_level(jnp.array([10.0]))[0, -1]), 2)  # at 8 kHz
        -1.26
    """
    row = COEFFICIENTS[_nearest(TEMPERATURES, temperature), _nearest(HUMIDITIES, humidity)] / 1000
    kept = 1 - distance[:, None] * jnp.asarray(row, jnp.float32)[None]
    return 20 * jnp.log10(jnp.clip(kept, MIN_REMAINING_PRESSURE, 1.0))


def _nearest(values: tuple[float, ...], value: float) -> int:
    return int(np.argmin(np.abs(np.array(values) - value)))


def _directions_to(point: Float[Array, "p 3"], listener: Listener) -> Float[Array, "p 3"]:
    """Return unit vectors from the listener to points."""
    away = point - listener.pos[None]
    return away / jnp.maximum(jnp.linalg.norm(away, axis=1), MIN_PATH_LENGTH)[:, None]


def _find_images(
    scene: Scene, boxes: ModelBoxes, source: SoundSource, listener: Listener, config: AudioConfig
) -> tuple[ImageSources, Int[Array, "p k"]]:
    """Find the straight path, then the shortest image sources; return them and box material rows (-1 if none)."""
    order, shell = config.early.reflection_order, house_mirrors(scene)
    kinds = shell.replace(material=jnp.full(shell.valid.shape, -1, jnp.int32)), box_mirrors(boxes)
    kept = [
        select_nearest_mirrors(m, source.pos, listener.pos, n) for m, n in zip(kinds, MAX_MIRRORS[order], strict=True)
    ]
    mirrors = jax.tree.map(lambda *x: jnp.concatenate(x), *kept)
    found = find_image_sources(mirrors, source.pos, listener.pos, order)
    _, shortest = jax.lax.top_k(
        -found.length, min(CANDIDATES_PER_PATH * config.early.num_reflections, found.length.size)
    )
    found = jax.tree.map(lambda x: x[shortest], found)
    again = find_duplicates(
        found.length, _directions_to(found.point[:, 0], listener)
    )  # paths into corners, and over coplanar faces
    first = jnp.argsort(again, stable=True)[: config.early.num_reflections]
    found = found.replace(length=jnp.where(again, jnp.inf, found.length))
    straight = ImageSources(
        length=jnp.linalg.norm(source.pos - listener.pos)[None],
        point=jnp.broadcast_to(source.pos, (1, order, 3)),
        normal=jnp.zeros((1, order, 3), jnp.float32),
        order=jnp.zeros(1, jnp.int32),
        mirror=jnp.full((1, order), -1, jnp.int32),
    )
    found = jax.tree.map(lambda a, b: jnp.concatenate([a, b[first]]), straight, found)
    material = jnp.concatenate([kind.material for kind in kept])  # pyright: ignore[reportArgumentType]
    return found, jnp.where(found.mirror < 0, -1, material[jnp.maximum(found.mirror, 0)])


def _legs(found: ImageSources, material: Int[Array, "p k"], source: SoundSource, listener: Listener) -> _Legs:
    count, order = found.point.shape[:2]
    first, final = (jnp.broadcast_to(x, (count, 1, 3)) for x in (listener.pos, source.pos))
    corner = jnp.concatenate([first, found.point, final], axis=1)
    number = jnp.arange(order + 1, dtype=jnp.int32)[None]
    shell = (material < 0) & (found.mirror >= 0)
    none = jnp.zeros((count, 1), bool)
    return _Legs(
        start=corner[:, :-1],
        end=corner[:, 1:],
        normal=jnp.concatenate([found.normal, jnp.zeros((count, 1, 3), jnp.float32)], axis=1),
        material=jnp.concatenate([material, jnp.full((count, 1), -1, jnp.int32)], axis=1),
        to_shell=jnp.concatenate([shell, none], axis=1),
        from_shell=jnp.concatenate([none, shell], axis=1),
        last=jnp.broadcast_to(number == found.order[:, None], (count, order + 1)),
        used=number <= found.order[:, None],
    )


def _trace_legs(scene: Scene, legs: _Legs, config: AudioConfig) -> tuple[Bool[Array, "p k"], Float[Array, "p k bands"]]:
    """Return whether architecture leaves each leg free up to its end, and the absorption of the surface there."""
    way = legs.end - legs.start
    length = jnp.linalg.norm(way, axis=2)
    # The leg between two reflections in one corner has no length: a ray against the normal hits the second surface.
    none = length < MIN_LEG_LENGTH
    toward = jnp.where(none[:, :, None], -legs.normal, way / jnp.maximum(length, MIN_LEG_LENGTH)[:, :, None])
    origin = legs.start - jnp.where(none, MAX_MIRROR_DISTANCE, 0.0)[:, :, None] * toward
    length = jnp.where(none, MAX_MIRROR_DISTANCE, length)
    begin = jnp.where(legs.from_shell & ~none, jnp.minimum(MAX_MIRROR_DISTANCE, length / 2), 0.0)
    reach = jnp.where(legs.to_shell, length + MAX_MIRROR_DISTANCE, length - LEG_END_MARGIN)
    reach = jnp.where(legs.used & (legs.to_shell | ~none), reach, -1.0)
    rays = origin.reshape(-1, 3), toward.reshape(-1, 3), begin.ravel(), reach.ravel()
    t, absorption = _cast_to_architecture(scene, *rays, config)
    t, absorption = t.reshape(length.shape), absorption.reshape(*length.shape, -1)
    free = jnp.where(legs.to_shell, jnp.abs(t - length) < MAX_MIRROR_DISTANCE, ~jnp.isfinite(t))
    own = sound_materials(scene).absorption[jnp.maximum(legs.material, 0)]
    return free, jnp.where((legs.material >= 0)[:, :, None], own, absorption)


def _cast_to_architecture(
    scene: Scene,
    origin: Float[Array, "n 3"],
    direction: Float[Array, "n 3"],
    begin: Float[Array, " n"],
    end: Float[Array, " n"],
    config: AudioConfig,
) -> tuple[Float[Array, " n"], Float[Array, "n bands"]]:
    """Cast rays to architecture through objects; return distances (inf if none, 0 after `max_crossings` surfaces)."""
    count = origin.shape[0]

    def more(carry: tuple) -> Bool[Array, ""]:
        number, _, _, t, _ = carry
        return (number < config.early.max_crossings) & jnp.any(jnp.isnan(t))

    def march(carry: tuple) -> tuple:
        number, start, skipped, t, absorption = carry
        going = jnp.isnan(t)
        reach = jnp.where(going, end, -1.0)
        hit = cast(scene, origin, direction, start, reach, exclude=skipped, mask=int(RayKind.SOUND))
        met = surface_at(scene, direction, hit)
        through = going & (hit.instance >= 0) & (met.object_id >= 0)
        done = going & ~through
        return (
            number + 1,
            jnp.where(through, hit.t + RAY_OFFSET, start),
            jnp.where(through, met.object_id, skipped),
            jnp.where(done, hit.t, t),
            jnp.where((done & (hit.instance >= 0))[:, None], met.absorption, absorption),
        )

    unknown = jnp.full(count, jnp.nan, jnp.float32)
    first = (jnp.int32(0), begin, jnp.full(count, -1, jnp.int32), unknown)
    *_, t, absorption = jax.lax.while_loop(more, march, (*first, jnp.zeros((count, len(BANDS)), jnp.float32)))
    return jnp.where(jnp.isnan(t), 0.0, t), absorption
