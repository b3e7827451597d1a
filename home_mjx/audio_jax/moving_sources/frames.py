"""Frames of sound while sources and listeners move."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.kernels.direct_filter import max_path_change
from home_mjx.audio_jax.moving_sources.dispatch import render_late_frame
from home_mjx.audio_jax.moving_sources.early import render_early_paths
from home_mjx.audio_jax.moving_sources.path_matching import match_paths
from home_mjx.audio_jax.moving_sources.receiver_state import ReceiverState, late_state


def render_frame(
    source: Float[Array, " w"],
    old: ReceiverState,
    new: ReceiverState,
    config: AudioConfig,
    head: MeasuredHead | None = None,
) -> Float[Array, "e m"]:
    """Render one frame of a source that moves relative to the receiver.

    Early paths have a delay per sample, which yields the Doppler shift. The late part, whose phase is random, and its
    tail are cross-faded from the old response to the new one.

    Args:
        source: Signal at 1 m, see `emitted_signal`: `config.memory_length` - 1 samples before the frame, the frame, and
            `config.num_lookahead` samples after it.
        old: State at the frame's start.
        new: State at its end, which is the next frame's `old`.
        config: Options with `motion=True`.
        head: Measured HRTFs of the listener; None: a rigid sphere.

    Returns:
        Pressure per channel, `config.frame` samples.
    """
    first, last = jax.tree.map(lambda x: x[None], (old, new))
    return render_frames(source[None], first, last, config, head)


def render_frames(
    sources: Float[Array, "n w"],
    old: ReceiverState,
    new: ReceiverState,
    config: AudioConfig,
    head: MeasuredHead | None = None,
) -> Float[Array, "e m"]:
    """Render the sum of several sources in one frame; they share the final filters and transforms.

    `sources`, `old` and `new` are as in `render_frame`, with a leading axis of sources; the result is their sum.

    Example:
        >>> from home_mjx.audio_jax import AudioConfig, Motion
        >>> from home_mjx.audio_jax.moving_sources.receiver_state import silent_state
        >>> config = AudioConfig(motion=Motion(tail_seconds=0.0), response_seconds=0.1)
        >>> none = jax.tree.map(lambda x: jnp.stack([x, x]), silent_state(config))
        >>> width = config.memory_length - 1 + config.frame + config.num_lookahead
        >>> render_frames(jnp.zeros((2, width)), none, none, config).shape
        (2, 1600)
    """
    return render_early(sources, old, new, config, head) + render_late(sources, old, new, config)


def render_early(
    sources: Float[Array, "n w"],
    old: ReceiverState,
    new: ReceiverState,
    config: AudioConfig,
    head: MeasuredHead | None = None,
) -> Float[Array, "e m"]:
    """Render the early sound of a frame, summed over sources; arguments and result as in `render_frames`."""
    pairs = jax.vmap(lambda a, b: match_paths(a.paths, b.paths, a.quat, b.quat, max_path_change(config)))(old, new)
    return render_early_paths(sources, config.memory_length - 1, pairs, config, head)


def render_late(
    sources: Float[Array, "n w"], old: ReceiverState, new: ReceiverState, config: AudioConfig
) -> Float[Array, "e m"]:
    """Render the late reverberation of a frame with its tail; arguments and result as in `render_frames`."""
    ends = jax.tree.map(lambda a, b: jnp.stack([a, b], axis=1), old, new)
    return render_late_frame(sources, jax.vmap(jax.vmap(lambda heard: late_state(heard, config)))(ends), config)
