"""All early sound: what the options name, one producer of paths after the other."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source, check_listener, check_source, given_toward
from home_mjx.audio_jax.propagation.diffraction import bent_paths
from home_mjx.audio_jax.propagation.home_paths import home_paths
from home_mjx.audio_jax.propagation.mirrored import mirrored_paths
from home_mjx.audio_jax.propagation.paths import MOST_NAMES, PathProducer, Paths, direct_path, reflected_paths
from home_mjx.core.transforms import is_unit
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.types import Scene


def producers_of(config: AudioConfig) -> tuple[PathProducer, ...]:
    """What finds early paths; the first gives the direct one.

    Example:
        >>> [find.__name__ for find in producers_of(AudioConfig(num_edges=8))]
        ['bent_paths', 'reflected_paths']
    """
    if config.early == "home":
        return (home_paths,)
    first_order = config.reflection_order == 1
    return bent_paths if config.num_edges else direct_path, reflected_paths if first_order else mirrored_paths


def early_paths(
    scene: Scene,
    source: Source,
    listener: Listener,
    config: AudioConfig,
    producers: Sequence[PathProducer] | None = None,
) -> Paths:
    """The direct path, what bends around edges, and the strongest reflections.

    Args:
        scene: The environment.
        source: Who sounds.
        listener: Who hears.
        config: Options.
        producers: What finds the paths; the first gives the direct one. None: what the options say.

    Returns:
        The paths of all producers, one after the other: by default 1 + R, R being `config.num_reflections` or the
        house's number of mirror planes if that is less; as loud as the source is in their directions, which are then
        forgotten. Silent to a head whose quaternion is not of unit length.

    Raises:
        ConfigError: That quaternion is known, not traced; or the source has a directivity, and a producer does not tell
            in which directions paths leave.

    Example:
        >>> paths = early_paths(scene, Source(radio), Listener(ears, quat), AudioConfig())  # doctest: +SKIP
        >>> paths.distance.shape  # doctest: +SKIP
        (9,)
    """
    check_listener(listener)
    check_source(source)
    each = enumerate(producers or producers_of(config))
    found = [_named(_aimed(find(scene, source, listener, config), source), number) for number, find in each]
    paths = jax.tree.map(lambda *parts: jnp.concatenate(parts), *found)
    return paths.replace(gain=jnp.where(is_unit(listener.quat), paths.gain, 0.0))


def _aimed(paths: Paths, source: Source) -> Paths:
    """As loud as the source is in the direction in which each leaves it."""
    if source.directivity is None:
        return paths.replace(departure=None)
    if paths.departure is None:
        raise ConfigError("a source with a directivity needs paths whose producer tells their `departure`")
    return paths.replace(gain=paths.gain * given_toward(source, paths.departure), departure=None)


def _named(paths: Paths, producer: int) -> Paths:
    """With names that no other producer gives."""
    number = jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name
    return paths.replace(name=number + producer * MOST_NAMES)
