"""Early sound: paths of all producers that the options select."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, check_listener, check_source, emission_gains
from home_mjx.audio_jax.propagation.diffraction import diffracted_paths
from home_mjx.audio_jax.propagation.image_source_paths import image_source_reflections
from home_mjx.audio_jax.propagation.paths import (
    MAX_PATH_NAMES,
    PathProducer,
    Paths,
    direct_path,
    first_order_reflections,
)
from home_mjx.core.transforms import is_unit_quat
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.types import Scene


def select_producers(config: AudioConfig) -> tuple[PathProducer, ...]:
    """Return the producers of early paths: of the direct path, then of reflections.

    The first also diffracts if `config.early.num_edges` is above 0. The second uses the house's mirror planes at
    `reflection_order` 1, and faces of furniture as well at higher orders.

    Example:
        >>> from home_mjx.audio_jax.base.options import EarlyPaths
        >>> [find.__name__ for find in select_producers(AudioConfig(early=EarlyPaths(num_edges=8)))]
        ['diffracted_paths', 'first_order_reflections']
    """
    return (
        diffracted_paths if config.early.num_edges else direct_path,
        first_order_reflections if config.early.reflection_order == 1 else image_source_reflections,
    )


def early_paths(
    scene: Scene,
    source: SoundSource,
    listener: Listener,
    config: AudioConfig,
    producers: Sequence[PathProducer] | None = None,
) -> Paths:
    """Compute the direct path, diffracted paths and the shortest reflections.

    The first of `producers` yields the direct path; None or empty: those that the options select.

    Returns:
        The paths of all producers in order, by default 1 + E + R, silent ones included: E is `config.early.num_edges`,
        and R is `config.early.num_reflections`, or less if the house has fewer edges or reflections. Directions of
        incidence are in the world, see `Paths`. Gains include the source's directivity; `departure` is None. Gains
        are 0 if the listener's quaternion is not of unit length.

    Raises:
        ConfigError: A concrete quaternion is not of unit length; or the source has a directivity and a producer does
            not return departure directions.

    Example:
        >>> paths = early_paths(scene, SoundSource(radio), Listener(ears, quat), AudioConfig())  # doctest: +SKIP
        >>> paths.distance.shape  # doctest: +SKIP
        (9,)
    """
    check_listener(listener)
    check_source(source)
    each = enumerate(producers or select_producers(config))
    found = [
        _offset_names(_apply_directivity(find(scene, source, listener, config), source), number)
        for number, find in each
    ]
    paths = jax.tree.map(lambda *parts: jnp.concatenate(parts), *found)
    return paths.replace(gain=jnp.where(is_unit_quat(listener.quat), paths.gain, 0.0))


def _apply_directivity(paths: Paths, source: SoundSource) -> Paths:
    """Apply the source's directivity to gains, and remove `departure`; raise `ConfigError` if it is needed but None."""
    if source.directivity is None:
        return paths.replace(departure=None)
    if paths.departure is None:
        raise ConfigError("a source with a directivity needs path producers that return `departure`")
    return paths.replace(gain=paths.gain * emission_gains(source, paths.departure), departure=None)


def _offset_names(paths: Paths, producer: int) -> Paths:
    """Make names unique across producers by adding `producer * MAX_PATH_NAMES`; without names, indices are used."""
    number = jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name
    return paths.replace(name=number + producer * MAX_PATH_NAMES)
