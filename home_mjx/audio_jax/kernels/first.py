"""What the first path's own filters, those of both ends of a frame, make of what its source gives off.

That path may go through walls, which the few filters that all paths share do not follow well.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS
from home_mjx.audio_jax.base.shapes import octave_spectra
from home_mjx.audio_jax.kernels.reads import margin, times

FASTEST = 10.0  # [m/s], at which paths may grow or shrink; faster ones are faded
SLOWEST_SOUND = 250.0  # [m/s], of all airs that can be chosen


def longest_step(config: AudioConfig) -> float:
    """[m], by which a path may grow or shrink in a frame."""
    return FASTEST * config.frame / config.sample_rate


def slack(config: AudioConfig) -> int:
    """Samples on both sides by which delays differ in one frame, of ears, by motion and by turns of the head."""
    grown = times(config).shape[0] / config.frame * longest_step(config) / SLOWEST_SOUND
    return math.ceil((grown + 2 * config.lead_seconds) * config.sample_rate)


def num_filtered(config: AudioConfig) -> int:
    """Samples that filters make."""
    return times(config).shape[0] + 2 * slack(config) + 2 * margin(config)


def num_ringing(config: AudioConfig) -> int:
    """Samples for which filters ring, which are read before those that they make."""
    return math.ceil(CAUSAL_SECONDS * config.sample_rate)


def filtered_by_xla(
    source: Float[Array, " n"], begin: Int[Array, ""], gain: Float[Array, "ends bands"], config: AudioConfig
) -> Float[Array, "ends m"]:
    """What causal octave filters make of a source from its sample `begin` on; there is silence around it.

    Args:
        source: What it gives off.
        begin: No less than -`slack`, and no more than its length.
        gain: Of octaves, at both ends of the frame.
        config: For the lengths.
    """
    ringing, length, before = num_ringing(config), num_filtered(config), slack(config)
    size = int(next_fast_len(length + ringing, real=True) or 0)
    window = jax.lax.dynamic_slice_in_dim(jnp.pad(source, (ringing + before, size)), begin + before, size)
    filters = octave_spectra(gain, size, config.sample_rate)
    return jnp.fft.irfft(jnp.fft.rfft(window, size)[None] * filters, size)[:, ringing : ringing + length]
