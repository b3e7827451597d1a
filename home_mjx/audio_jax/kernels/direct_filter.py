"""Octave filters of the first path, for both ends of a frame.

The first path may pass through walls, whose spectra the shared filters of all other paths approximate poorly.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filter_basis import octave_spectra
from home_mjx.audio_jax.base.filters import MAX_RINGING_SECONDS
from home_mjx.audio_jax.kernels.delay_reads import read_margin, sample_times

MAX_PATH_SPEED = 10.0  # [m/s], maximum rate of change of a path length; faster paths are faded
MIN_SPEED_OF_SOUND = 250.0  # [m/s], lower bound of the speed of sound over all options


def max_path_change(config: AudioConfig) -> float:
    """Return the change of a path length in a frame [m] from which on a path is not matched but faded.

    It is `MAX_PATH_SPEED` times the duration of a frame.
    """
    return MAX_PATH_SPEED * config.frame / config.sample_rate


def delay_margin(config: AudioConfig) -> int:
    """Return an upper bound of delay changes in a frame [samples]: by motion, between ears, by turns of the head.

    Motion counts at `MAX_PATH_SPEED` over all samples of a bus, the others as twice the maximum lead.
    """
    grown = sample_times(config).shape[0] / config.frame * max_path_change(config) / MIN_SPEED_OF_SOUND
    return math.ceil((grown + 2 * config.max_lead_seconds) * config.sample_rate)


def num_output_samples(config: AudioConfig) -> int:
    """Return the number of samples m that `filter_direct_by_xla` returns."""
    return sample_times(config).shape[0] + 2 * delay_margin(config) + 2 * read_margin(config)


def num_filter_samples(config: AudioConfig) -> int:
    """Return the length of the octave filters [samples]; as many source samples before `begin` are read."""
    return math.ceil(MAX_RINGING_SECONDS * config.sample_rate)


def filter_direct_by_xla(
    source: Float[Array, " n"], begin: Int[Array, ""], gain: Float[Array, "ends bands"], config: AudioConfig
) -> Float[Array, "ends m"]:
    """Filter a source with minimum-phase octave filters per frame end; return `num_output_samples` from `begin` on.

    Args:
        source: Emitted signal; zero outside its samples.
        begin: Index in `source` of the first output sample, from -`delay_margin` to the signal's length.
        gain: Pressure gains of octaves, at least 0, one row per end of the frame; a row of zeros yields silence.
        config: Options for the lengths.
    """
    ringing, length, before = num_filter_samples(config), num_output_samples(config), delay_margin(config)
    size = int(next_fast_len(length + ringing, real=True) or 0)
    window = jax.lax.dynamic_slice_in_dim(jnp.pad(source, (ringing + before, size)), begin + before, size)
    filters = octave_spectra(gain, size, config.sample_rate)
    return jnp.fft.irfft(jnp.fft.rfft(window, size)[None] * filters, size)[:, ringing : ringing + length]
