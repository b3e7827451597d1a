"""Stateless convolution of sources with impulse responses, one frame at a time."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import SoundSources

RAMP_SECONDS = 0.005  # [s], fade in and out that avoids clicks
RATE_STEPS = 256  # playback rates are multiples of 1 / 256, so that positions in clips are exact
MAX_SCHEDULE_SAMPLES = 2**30  # [samples], infinite times are clipped to it: 18 hours at 16 kHz


def convolve_clip_frame(
    clip: Float[Array, " n"],
    phase: Int[Array, ""],
    response_old: Float[Array, "e l"],
    response_new: Float[Array, "e l"],
    config: AudioConfig,
) -> Float[Array, "e m"]:
    """Convolve one frame of an endlessly looped clip with the responses at the frame's start and end.

    Overlap-save convolution with a single FFT reads the past from the clip, so there is no state to keep or reset.
    Within the frame the output is cross-faded linearly from the old response to the new one, which the last sample has
    alone. With equal responses the frames are those of one long convolution.

    Args:
        clip: Pressure at 1 m from the source, any length.
        phase: Index of the sample emitted at the frame's first sample, modulo the clip's length.
        response_old: Response per channel at the frame's start.
        response_new: Response per channel at its end, which is the next frame's `response_old`.
        config: Options; provides the lengths.

    Returns:
        Pressure per channel, `config.frame` samples.

    Example:
        >>> config = AudioConfig()
        >>> pulse = jnp.zeros((2, config.response_length)).at[:, 100].set(0.5)
        >>> frame = convolve_clip_frame(jnp.ones(4000), jnp.int32(0), pulse, pulse, config)
        >>> frame.shape, round(float(frame[0, 0]), 3)
        ((2, 1600), 0.5)
    """
    return convolve_frame(clip[_sample_numbers(phase, config) % clip.shape[0]], response_old, response_new, config)


def emitted_signal(
    clips: Float[Array, "c n"],
    sounds: SoundSources,
    clip_index: Int[Array, " e"],
    phase: Int[Array, ""],
    time: Int[Array, ""],
    config: AudioConfig,
    playback_rate: Float[Array, ""] | None = None,
) -> Float[Array, "e w"]:
    """Return the pressure at 1 m that each source emits: in the memory before the frame, the frame, and the look-ahead.

    Args:
        clips: All clips.
        sounds: The sources, whose gains and schedules apply, see `schedule_gain`; their `clip` is ignored.
        clip_index: Index of the clip that each source plays; negative: silent.
        phase: Sample index in the clips, which repeat, that is emitted at the frame's first sample.
        time: Number of the frame's first sample, counted from the start of the schedules.
        config: Options; provides the lengths.
        playback_rate: Factor of pitch and tempo, rounded to 1 / `RATE_STEPS`; `phase` may then be up to `RATE_STEPS`
            times the clips' length. Samples are interpolated linearly, and a higher pitch aliases above half the sample
            rate. None: 1.

    Returns:
        Pressure at 1 m, w = `config.memory_length + config.frame - 1 + config.num_lookahead` samples: the input of
        `render_frame`, or of `convolve_frame` without `config.motion`.
    """
    span = jnp.arange(1 - config.memory_length, config.frame + config.num_lookahead, dtype=jnp.int32)

    def one(row: Array, gain: Array, every: Array, lasts: Array) -> Array:
        """Return the signal of one source; 0 if `row` is negative."""
        played = _read_loop(clips, jnp.maximum(row, 0), phase + span, playback_rate)
        on = schedule_gain(time + span, every, lasts, config.sample_rate)
        return jnp.where(row < 0, 0.0, gain * on * played)

    return jax.vmap(one)(clip_index, sounds.gain, sounds.period, sounds.duration)


def _read_loop(
    clips: Float[Array, "c n"], row: Int[Array, ""], number: Int[Array, " w"], playback_rate: Float[Array, ""] | None
) -> Float[Array, " w"]:
    """Return samples `number` of an endlessly repeated clip, played at a rate; see `emitted_signal`."""
    length = jnp.int32(clips.shape[1])
    if playback_rate is None:
        return clips[row, _remainder(number, length)]
    steps = jnp.round(playback_rate * RATE_STEPS).astype(jnp.int32)
    whole, rest = number // RATE_STEPS, number % RATE_STEPS * steps  # number * steps would overflow
    at = whole * steps + rest // RATE_STEPS
    share = (rest % RATE_STEPS).astype(jnp.float32) / RATE_STEPS
    before, after = (clips[row, _remainder(at + i, length)] for i in (0, 1))
    return before + share * (after - before)


def convolve_frame(
    emitted: Float[Array, " w"],
    response_old: Float[Array, "e l"],
    response_new: Float[Array, "e l"],
    config: AudioConfig,
) -> Float[Array, "e m"]:
    """Convolve an emitted signal with two responses and cross-fade linearly, as in `convolve_clip_frame`.

    Args:
        emitted: Signal at 1 m: `config.response_length` - 1 samples before the frame, then the frame.
        response_old: Response per channel at the frame's start.
        response_new: Response per channel at its end.
        config: Options; provides the lengths.

    Returns:
        Pressure per channel, `config.frame` samples.
    """
    length, frame = config.response_length, config.frame
    size = next_fast_len(length + frame - 1, real=True)
    emitted = jnp.fft.rfft(emitted, size)
    responses = jnp.fft.rfft(jnp.stack([response_old, response_new]), size)
    sound = jnp.fft.irfft(emitted[None, None] * responses, size)[..., length - 1 : length - 1 + frame]
    fade = jnp.arange(1, frame + 1, dtype=jnp.float32)[None] / frame
    return sound[0] + fade * (sound[1] - sound[0])


def _sample_numbers(first: Int[Array, ""], config: AudioConfig) -> Int[Array, " w"]:
    """Return sample numbers: `config.response_length` - 1 before `first`, then the frame from `first` on."""
    length = config.response_length
    return first - (length - 1) + jnp.arange(length + config.frame - 1, dtype=jnp.int32)


def schedule_gain(
    time: Int[Array, " n"], interval: Float[Array, ""], duration: Float[Array, ""], sample_rate: int
) -> Float[Array, " n"]:
    """Compute a schedule's gain at times: 0 off, 1 on, linear ramps of 5 ms inside; 1 if `duration` >= `interval`.

    `time` counts samples since the start, negative before it. `interval` and `duration` are `SoundSources.period` and
    `duration` [s], rounded to samples; from 2**30 samples on they count as infinite. With an infinite interval the
    source sounds once, from time 0 on.

    Example:
        >>> schedule_gain(jnp.array([500, 8500, 12000]), jnp.float32(1.0), jnp.float32(0.6), 16000).tolist()
        [1.0, 1.0, 0.0]
    """
    rate = jnp.float32(sample_rate)
    period, on = (
        jnp.where(x * rate < MAX_SCHEDULE_SAMPLES, jnp.round(x * rate), MAX_SCHEDULE_SAMPLES).astype(jnp.int32)
        for x in (interval, duration)
    )
    at = jnp.where(period < MAX_SCHEDULE_SAMPLES, _remainder(time, jnp.maximum(period, 1)), time)
    edge = jnp.minimum(at + 1, on - at).astype(jnp.float32) / jnp.float32(RAMP_SECONDS * sample_rate)
    return jnp.where(duration >= jnp.minimum(interval, MAX_SCHEDULE_SAMPLES / rate), 1.0, jnp.clip(edge, 0.0, 1.0))


def _remainder(value: Int[Array, " n"], divisor: Int[Array, ""]) -> Int[Array, " n"]:
    """Return `value` modulo a positive divisor, exactly, up to 2**30 each.

    Quotients are those of floats, which CPUs compute several at a time, unlike integer remainders. The first is off by
    up to 64 / `divisor` + 1; the second, of the rest that it leaves, by one.
    """
    inverse = 1.0 / divisor.astype(jnp.float32)
    for _ in range(2):
        value = value - jnp.floor(value.astype(jnp.float32) * inverse).astype(jnp.int32) * divisor
    value = jnp.where(value < 0, value + divisor, value)
    return jnp.where(value >= divisor, value - divisor, value)
