"""Interaural cues per band: level difference, time difference and coherence, hardly dependent on the kind of sound.

Rakerd and Hartmann, "Localization of sound in rooms, III", JASA 78 (1985). Coherence falls with the distance in
reverberation: Faller and Merimaa, "Source localization in complex listening situations", JASA 116 (2004).
"""

import functools
import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.features import MIN_MEL_LEVEL, hz_to_mel, stft
from home_mjx.core.pytree import Pytree

NUM_BANDS = 12
MIN_FREQUENCY, MAX_FREQUENCY = 150.0, 7500.0  # [Hz] edges of the lowest and the highest band
MAX_LAG, NUM_LAGS = 0.0009, 37  # [s] maximum lead of an ear; number of lags, odd
MIN_BAND_LEVEL = -110.0  # [dB], level below which a band is silent and has no cues
MAX_LEVEL_DIFFERENCE = 40.0  # [dB]


class InterauralCues(Pytree):
    """Cues of b bands in one frame; 0 in silent bands, whose level is `MIN_MEL_LEVEL`."""

    level: Float[Array, "*c b"]  # [dB re 1], mean power of both ears
    level_difference: Float[Array, "*c b"]  # [dB], left less right
    time_difference: Float[Array, "*c b"]  # [s], lead of the left ear
    coherence: Float[Array, "*c b"]  # 0 .. 1, maximum of the normalized correlation over lags (IACC of ISO 3382-1)
    correlation: Float[Array, "*c l"]  # -1 .. 1, at each of `interaural_lags`, mean over bands that are not silent


def interaural_cues(sound: Float[Array, "*c 2 m"], sample_rate: int) -> InterauralCues:
    """Compute the cues of a frame of both ears, from its windows of 25 ms, see `stft_magnitude`.

    Cross-spectra are averaged over the windows before levels, lags and coherence are read off. Time differences are
    lags of the grid `interaural_lags`; above about 800 Hz they may be off by whole periods.

    Raises:
        ConfigError: The sound is shorter than one window.

    Example:
        >>> noise = jnp.asarray(np.random.default_rng(0).normal(size=4800), jnp.float32)
        >>> cues = interaural_cues(jnp.stack([noise, 0.5 * jnp.roll(noise, 4)]), 16000)
        >>> round(float(cues.level_difference[3])), round(float(cues.time_difference[3]) * 1e6)  # [dB], [µs]
        (6, 250)
    """
    spectra = stft(sound, sample_rate)
    left, right = spectra[..., 0, :, :], spectra[..., 1, :, :]
    bands = jnp.asarray(band_weights(sample_rate, spectra.shape[-1]), jnp.float32)
    powers = [jnp.einsum("...wk,bk->...b", jnp.abs(x) ** 2, bands, precision="highest") for x in (left, right)]
    powers = [power / spectra.shape[-2] for power in powers]
    cross = jnp.mean(jnp.conj(left) * right, axis=-2)
    turn = jnp.asarray(_lag_phases(sample_rate, spectra.shape[-1]), jnp.float32)
    real = jnp.einsum("...k,bk,kl->...bl", jnp.real(cross), bands, turn[0], precision="highest")
    imaginary = jnp.einsum("...k,bk,kl->...bl", jnp.imag(cross), bands, turn[1], precision="highest")
    floor = jnp.float32(10 ** (MIN_BAND_LEVEL / 10))
    heard = 0.5 * (powers[0] + powers[1]) > floor
    correlation = (real - imaginary) / jnp.sqrt(jnp.maximum(powers[0] * powers[1], floor**2 * 1e-4))[..., None]
    correlation = jnp.where(heard[..., None], jnp.clip(correlation, -1.0, 1.0), 0.0)
    levels = [10 * jnp.log10(jnp.maximum(power, floor * 1e-2)) for power in powers]
    lags = jnp.asarray(interaural_lags(), jnp.float32)
    mean_level = 10 * jnp.log10(jnp.maximum(0.5 * (powers[0] + powers[1]), 10 ** (MIN_MEL_LEVEL / 10)))
    apart = jnp.clip(levels[0] - levels[1], -MAX_LEVEL_DIFFERENCE, MAX_LEVEL_DIFFERENCE)
    count = jnp.maximum(jnp.sum(heard, axis=-1), 1).astype(jnp.float32)
    return InterauralCues(
        level=jnp.where(heard, mean_level, MIN_MEL_LEVEL),
        level_difference=jnp.where(heard, apart, 0.0),
        time_difference=jnp.where(heard, lags[jnp.argmax(correlation, axis=-1)], 0.0),
        coherence=jnp.max(jnp.maximum(correlation, 0.0), axis=-1),
        correlation=jnp.sum(correlation, axis=-2) / count[..., None],
    )


@functools.cache
def interaural_lags() -> Float[np.ndarray, " lags"]:
    """Return the leads of the left ear [s] at which ears are correlated: -`MAX_LAG` .. `MAX_LAG` in equal steps."""
    return np.linspace(-MAX_LAG, MAX_LAG, NUM_LAGS)


@functools.cache
def band_weights(sample_rate: int, num_bins: int) -> Float[np.ndarray, "bands bins"]:
    """Return 1 for each frequency of a band, else 0; bands are adjoining, equally wide on the mel scale.

    A band that would be empty, above half the sample rate, has no frequency and is silent.
    """
    mels = np.linspace(hz_to_mel(MIN_FREQUENCY), hz_to_mel(MAX_FREQUENCY), NUM_BANDS + 1)
    edges = 700 * (10 ** (mels / 2595) - 1)
    frequency = np.linspace(0, sample_rate / 2, num_bins)
    return ((frequency >= edges[:-1, None]) & (frequency < edges[1:, None])).astype(float)


@functools.cache
def _lag_phases(sample_rate: int, num_bins: int) -> Float[np.ndarray, "2 bins lags"]:
    """Return cosines and sines that turn a cross-spectrum into correlations at `interaural_lags`."""
    angle = 2 * math.pi * np.outer(np.linspace(0, sample_rate / 2, num_bins), interaural_lags())
    return np.stack([np.cos(angle), np.sin(angle)])
