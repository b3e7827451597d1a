"""From impulse responses to sound: one frame at a time, without state."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig


def sound_frame(
    clip: Float[Array, " n"],
    phase: Int[Array, ""],
    response_old: Float[Array, "2 l"],
    response_new: Float[Array, "2 l"],
    config: AudioConfig,
) -> Float[Array, "2 m"]:
    """One frame of what both ears hear of a clip that loops for ever.

    The clip is known, so its past is gathered instead of kept: overlap-save convolution with a single FFT, no tail to
    carry, nothing to reset. Within the frame the sound fades linearly from the old response to the new one; equal
    responses therefore give the same as one long convolution.

    Args:
        clip: Pressure at 1 m from the source, any length.
        phase: Index of the sample that leaves the source at the frame's first sample; taken modulo the clip's length.
        response_old: Response per ear at the frame's start.
        response_new: Response per ear at its end, which is the next frame's `response_old`.
        config: For the lengths.

    Returns:
        Pressure at the left and right ear, `config.frame` samples.

    Example:
        >>> config = AudioConfig()
        >>> pulse = jnp.zeros((2, config.response_length)).at[:, 100].set(0.5)
        >>> frame = sound_frame(jnp.ones(4000), jnp.int32(0), pulse, pulse, config)
        >>> frame.shape, round(float(frame[0, 0]), 3)
        ((2, 1600), 0.5)
    """
    length, frame = config.response_length, config.frame
    size = next_fast_len(length + frame - 1, real=True)
    index = phase - (length - 1) + jnp.arange(length + frame - 1, dtype=jnp.int32)
    heard = jnp.fft.rfft(clip[index % clip.shape[0]], size)
    responses = jnp.fft.rfft(jnp.stack([response_old, response_new]), size)
    sound = jnp.fft.irfft(heard[None, None] * responses, size)[..., length - 1 : length - 1 + frame]
    fade = jnp.arange(1, frame + 1, dtype=jnp.float32)[None] / frame
    return sound[0] + fade * (sound[1] - sound[0])
