"""What reaches a head at one moment, in the parts that change in different ways."""

import jax
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.response import after_direct, ear_gains, late_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.motion.tail import continued
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths, early_paths
from home_mjx.audio_jax.propagation.tracing import trace
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.types import Scene


class Reception(Pytree):
    """From one source to one head."""

    paths: Paths
    quat: Float[Array, "4"]  # of the head, wxyz
    late: Float[Array, "2 l"]  # response of both ears without the paths
    tail: Float[Array, "j 2 bands"]  # energy beyond it, in each of the following frames


def reception(scene: Scene, source: Source, listener: Listener, key: Array, config: AudioConfig) -> Reception:
    """What `impulse_response` gives, in parts, and what comes after it.

    Args:
        scene: The environment.
        source: Who sounds.
        listener: Who hears.
        key: Random key; keep it while a listener moves, and give it to `moving_frame`.
        config: Options.

    Example:
        >>> heard = reception(scene, Source(radio), Listener(ears, quat), jax.random.key(0), config)  # doctest: +SKIP
        >>> heard.late.shape  # doctest: +SKIP
        (2, 8000)
    """
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    rays = trace(scene, source, listener, trace_key, config)
    energy = energy_histogram(rays, ear_gains(rays.direction, listener.quat, config), config)
    return received(paths, energy, listener.quat, noise_key, config)


def received(
    paths: Paths, energy: Float[Array, "k 2 bands"], head_quat: Float[Array, "4"], key: Array, config: AudioConfig
) -> Reception:
    """The same from paths and an energy histogram; `key` chooses the noise."""
    late = after_direct(late_response(energy, key, config, head_quat), paths, config)
    return Reception(paths, head_quat, late, continued(energy, config))
