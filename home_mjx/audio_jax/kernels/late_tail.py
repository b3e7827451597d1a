"""Late part of a frame, and the reverberation tail after the end of a response.

Beyond a response each octave decays exponentially. The tail repeats the response's second half with decreasing gains.
Each repetition takes one transform of the source, and none of a response.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.receivers.diffuse_noise import noise_bin_table
from home_mjx.audio_jax.receivers.noise_gains import NoiseGains
from home_mjx.core.pytree import Pytree

MAX_DECAY_RATE, MIN_DECAY_RATE = 0.5, 1e-4  # [1/bin], maximum and minimum decay rate of energy
MIN_ENERGY = 1e-30  # minimum energy in logarithms


class LateResponse(Pytree):
    """Late sound at one time: gains of its response and of the tail after it."""

    shares: NoiseGains
    onset: Int[Array, "*n"]  # [samples], before which the response is zero
    tail: Float[Array, "*n x bands"]  # see `tail_gains`


def tail_gains(energy: Float[Array, "k e bands"], config: AudioConfig) -> Float[Array, "m bands"]:
    """Compute the gains with which a response's second half is repeated, once per its length.

    Octaves continue to decay at the rate d [1/bin] of that half's energy: the negated least-squares slope of the log
    energy summed over channels, within `MIN_DECAY_RATE` .. `MAX_DECAY_RATE`. Repetition i = 1, 2, ... has the gain
    exp(-d n i / 2), n being the bins of that half.

    Args:
        energy: Late energies, see `late_energy`; cross energies of ambisonics are not used.
        config: Options for the lengths.

    Returns:
        Amplitudes of the `config.num_tail_repeats` repetitions.

    Example:
        >>> from home_mjx.audio_jax.base.options import Motion
        >>> config = AudioConfig(motion=Motion(tail_seconds=0.4))
        >>> bins = jnp.exp(-0.05 * jnp.arange(config.num_bins))
        >>> tail = tail_gains(jnp.broadcast_to(bins[:, None, None], (config.num_bins, 2, 7)), config)
        >>> tail.shape, round(float(tail[1, 0]), 4) == round(float(jnp.exp(-0.05 * 62)), 4)
        ((2, 7), True)
    """
    count = config.tail_period // config.bin_samples
    whole = jnp.sum(energy[energy.shape[0] - count :, : config.num_channels], axis=1)
    level = jnp.log(jnp.maximum(whole, MIN_ENERGY))
    place = jnp.arange(count, dtype=jnp.float32) - (count - 1) / 2
    slope = jnp.sum(place[:, None] * level, axis=0) / max((count**3 - count) / 12, 1)
    decay = jnp.clip(-slope, MIN_DECAY_RATE, MAX_DECAY_RATE)
    times = jnp.arange(1, config.num_tail_repeats + 1, dtype=jnp.float32)
    return jnp.exp(-0.5 * count * times[:, None] * decay[None])


def late_spectra(
    source: Float[Array, " n"], late: Float[Array, "2 e l"], tail: Float[Array, "2 m bands"], config: AudioConfig
) -> Complex[Array, "2 e f"]:
    """Compute the spectra of a source through late responses and their tails; spectra of several sources can be added.

    The first spectrum belongs to the frame's start, the second is the change until its end. Their `irfft` are circular
    convolutions that have the frame from sample `late_frame_begin` on.

    Args:
        source: Emitted signal at 1 m, as in `render_frame`.
        late: Responses at the frame's start and end, per channel, of `config.response_length` samples.
        tail: Gains from `tail_gains` at both ends.
        config: Options.
    """
    size, first = _size(config), config.response_length - config.tail_period
    parts = jnp.fft.rfft(late[..., :first], size), jnp.fft.rfft(late[..., first:], size)
    now, once, *again = _windows(source, config)
    both = once[None]
    if again:
        levels = jnp.einsum("imb,bf->imf", tail, jnp.asarray(octave_table(config, _size(config))), precision="highest")
        both = both + sum(levels[:, i] * x[None] for i, x in enumerate(again))
    old, new = parts[0] * now[None, None] + parts[1] * both[:, None]
    return jnp.stack([old, new - old])


def render_late_by_xla(sources: Float[Array, "n w"], late: LateResponse, config: AudioConfig) -> Float[Array, "e s"]:
    """Render the late sound of several sources, summed, crossfaded linearly between the responses at both frame ends.

    Args:
        sources: Emitted signals at 1 m, as in `render_frames`.
        late: Late sound with leading axes of sources and of the frame's ends.
        config: Options.

    Returns:
        Pressure per channel, `config.frame` samples.
    """
    table = jnp.asarray(noise_bin_table(config))
    subscripts = "nikem,ekms->nieks" if table.ndim == 4 else "nikem,kms->nieks"  # noises per channel, or shared ones
    sound = jnp.einsum(subscripts, late.shares.bin_weights(), table, precision="highest")
    sound = sound.reshape(*sound.shape[:3], -1)
    responses = jax.vmap(jax.vmap(lambda noise, one: _shift_response(noise, one, config)))(sound, late)
    each = jax.vmap(lambda source, late, levels: late_spectra(source, late, levels, config))
    sound = jnp.fft.irfft(jnp.sum(each(sources, responses, late.tail), axis=0), _size(config))
    begin = late_frame_begin(config)
    sound = sound[..., begin : begin + config.frame]
    fade = jnp.arange(1, config.frame + 1, dtype=jnp.float32)[None] / config.frame
    return sound[0] + fade * sound[1]


def _shift_response(noise: Float[Array, "e l"], late: LateResponse, config: AudioConfig) -> Float[Array, "e l"]:
    """Roll a periodic noise response so that it begins at bin `start_bin`; zero it before the onset of direct sound."""
    heard = jnp.arange(config.response_length, dtype=jnp.int32) >= late.onset
    return jnp.where(heard[None], jnp.roll(noise, -late.shares.start_bin * config.bin_samples, axis=1), 0.0)


def late_frame_begin(config: AudioConfig) -> int:
    """Return the index of the frame's first sample in the circular convolutions of `render_late_by_xla`."""
    return config.response_length - config.tail_period - 1 + config.num_tail_ringing


def source_window_width(config: AudioConfig) -> int:
    """Return the number of source samples that a frame needs for each part of a response."""
    return config.response_length - config.tail_period - 1 + config.frame + 2 * config.num_tail_ringing


def _windows(source: Float[Array, " n"], config: AudioConfig) -> list[Complex[Array, " f"]]:
    """Return spectra of source windows: for a response's first part, its second half, then each tail repetition.

    Windows are zero outside the source. That of the second half begins earlier by the first part's length, and
    each later one by a `tail_period` more.
    """
    first, half, spread = config.response_length - config.tail_period, config.tail_period, config.num_tail_ringing
    width, before = source_window_width(config), first - half
    padded = jnp.pad(source, (before, spread))
    begins = [before + config.memory_length - first - spread]
    begins += [begins[0] - first - i * half for i in range(config.num_tail_repeats + 1)]
    windows = jnp.stack([padded[begin : begin + width] for begin in begins])
    return list(jnp.fft.rfft(windows, _size(config)))


def _size(config: AudioConfig) -> int:
    """Return the transform size of source windows [samples]."""
    return int(next_fast_len(source_window_width(config), real=True) or 0)


@functools.cache
def octave_table(config: AudioConfig, size: int) -> Float[np.ndarray, "bands f"]:
    """Return gains of zero-phase octave filters at the `rfft` frequencies of `size` samples; `config` must have a tail.

    The filters are those of `octave_gains`, faded out (cosine squared) over `num_tail_ringing` samples on each side.
    """
    spread = config.num_tail_ringing
    kernel = np.fft.irfft(octave_gains(np.fft.rfftfreq(8 * size, 1 / config.sample_rate)), 8 * size)
    place = np.minimum(np.arange(size), size - np.arange(size))
    near = np.where(place == np.arange(size), place, -place)  # samples before time 0 are at the end
    fade = np.cos(np.pi / 2 * np.clip(place / spread, 0, 1)) ** 2
    return np.fft.rfft(kernel[:, near] * fade).real.astype(np.float32)
