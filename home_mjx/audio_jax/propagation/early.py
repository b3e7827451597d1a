"""All early sound: what the options name, one producer of paths after the other."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source, check_listener
from home_mjx.audio_jax.propagation.diffraction import bent_paths
from home_mjx.audio_jax.propagation.home_paths import home_paths
from home_mjx.audio_jax.propagation.mirrored import mirrored_paths
from home_mjx.audio_jax.propagation.paths import MOST_NAMES, PathProducer, Paths, direct_path, reflected_paths
from home_mjx.core.transforms import is_unit
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
        house's number of mirror planes if that is less. Silent to a head whose quaternion is not of unit length.

    Raises:
        ConfigError: That quaternion is known, not traced.

    Example:
        >>> paths = early_paths(scene, Source(radio), Listener(ears, quat), AudioConfig())  # doctest: +SKIP
        >>> paths.distance.shape  # doctest: +SKIP
        (9,)
    """
    check_listener(listener)
    each = enumerate(producers or producers_of(config))
    found = [_named(find(scene, source, listener, config), number) for number, find in each]
    paths = jax.tree.map(lambda *parts: jnp.concatenate(parts), *found)
    return paths.replace(gain=jnp.where(is_unit(listener.quat), paths.gain, 0.0))


def _named(paths: Paths, producer: int) -> Paths:
    """With names that no other producer gives."""
    number = jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name
    return paths.replace(name=number + producer * MOST_NAMES)
