"""One frame of sound while sources and heads move."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Head
from home_mjx.audio_jax.kernels.first import longest_step
from home_mjx.audio_jax.moving_sources.early import early_sound
from home_mjx.audio_jax.moving_sources.pairs import paired
from home_mjx.audio_jax.moving_sources.reception import Reception, late_sound
from home_mjx.audio_jax.moving_sources.synthesis import late_frame


def moving_frame(
    source: Float[Array, " w"], old: Reception, new: Reception, config: AudioConfig, head: Head | None = None
) -> Float[Array, "e m"]:
    """What both ears, or the channels of another receiver, hear in one frame of a source that moves relative to them.

    Early paths keep their pitch: each sample has its own delay. The late part, whose phase says nothing, fades from the
    old response to the new one, and so does its tail.

    Args:
        source: What leaves the source at 1 m, see `given_off`: `config.memory_length` - 1 samples from before the
            frame, the frame, and `config.ahead` samples after it.
        old: At the frame's start.
        new: At its end, which is the next frame's `old`.
        config: Options.
        head: Of the listener, where it is a measured one.
    """
    first, last = jax.tree.map(lambda x: x[None], (old, new))
    return moving_frames(source[None], first, last, config, head)


def moving_frames(
    sources: Float[Array, "n w"], old: Reception, new: Reception, config: AudioConfig, head: Head | None = None
) -> Float[Array, "e m"]:
    """The same of several sources together, which share the last filters and transforms.

    Args:
        sources: What leaves each source.
        old: At the frame's start, with a leading axis of sources.
        new: At its end.
        config: Options.
        head: Of the listener, where it is a measured one.

    Example:
        >>> from home_mjx.audio_jax import AudioConfig
        >>> from home_mjx.audio_jax.moving_sources.reception import silence
        >>> config = AudioConfig(motion=True, tail_seconds=0.0, response_seconds=0.1)
        >>> none = jax.tree.map(lambda x: jnp.stack([x, x]), silence(config))
        >>> width = config.memory_length - 1 + config.frame + config.ahead
        >>> moving_frames(jnp.zeros((2, width)), none, none, config).shape
        (2, 1600)
    """
    return moving_early(sources, old, new, config, head) + moving_late(sources, old, new, config)


def moving_early(
    sources: Float[Array, "n w"], old: Reception, new: Reception, config: AudioConfig, head: Head | None = None
) -> Float[Array, "e m"]:
    """Early sound of a frame. Arguments as of `moving_frames`."""
    pairs = jax.vmap(lambda a, b: paired(a.paths, b.paths, a.quat, b.quat, longest_step(config)))(old, new)
    return early_sound(sources, config.memory_length - 1, pairs, config, head)


def moving_late(
    sources: Float[Array, "n w"], old: Reception, new: Reception, config: AudioConfig
) -> Float[Array, "e m"]:
    """Late sound of a frame. Arguments as of `moving_frames`."""
    ends = jax.tree.map(lambda a, b: jnp.stack([a, b], axis=1), old, new)
    return late_frame(sources, jax.vmap(jax.vmap(lambda heard: late_sound(heard, config)))(ends), config)
