"""Pinna echoes, which distinguish up from down and front from back."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.receivers.spherical_head import basis_responses, fit_basis_weights
from home_mjx.schema.compiled import BANDS

# Brown and Duda, A structural model for binaural sound synthesis, IEEE Trans. Speech and Audio Processing 6 (1998),
# pinna coefficients: strength, and A, B (samples of 1 / PINNA_MODEL_RATE) and D of delays
# A cos(θ / 2) sin(D (90° - φ)) + B
PINNA_MODEL_RATE = 44100.0  # [Hz]
ECHO_STRENGTHS = (0.5, -1.0, 0.5, -0.25, 0.25)
ECHO_DELAY_SWINGS = (1.0, 5.0, 5.0, 5.0, 5.0)
ECHO_DELAY_OFFSETS = (2.0, 4.0, 7.0, 11.0, 13.0)
ECHO_ANGLE_FACTORS = (1.0, 0.5, 0.5, 0.5, 0.5)
FREQUENCIES_PER_OCTAVE = 8  # frequencies per octave over which energies are averaged
MAX_ECHO_DELAY, NUM_DELAY_STEPS = 36.0, 144  # tabulated delays: maximum [samples of PINNA_MODEL_RATE], and steps


def pinna_delays(toward: Float[Array, "*p 3"]) -> Float[Array, "*p echoes"]:
    """Compute the delay of each pinna echo after the direct sound [s]: A cos(θ / 2) sin(D (90° - φ)) + B.

    The constants A, B and D of each echo are those of Brown and Duda (1998). θ is the angle from the median plane, φ
    that around the interaural axis: 0 ahead, 90° above, 180° behind. The published model ends at 90°; here it continues
    to 180°, and returns from there linearly to its value below (-90°). Delays are at least 0.

    Args:
        toward: Unit vectors towards the directions of incidence, in the head frame: +x right, +y up, looking along -z.

    Example:
        >>> [round(float(x) * PINNA_MODEL_RATE, 2) for x in pinna_delays(jnp.array([0.0, 0.0, -1.0]))[:2]]  # ahead
        [3.0, 7.54]
    """
    side = jnp.arcsin(jnp.clip(toward[..., 0], -1.0, 1.0))
    around = jnp.arctan2(toward[..., 1], -toward[..., 2])
    around = jnp.where(around < -math.pi / 2, around + 2 * math.pi, around)  # -90° below .. 180° behind .. 270°
    pace, swing, middle = (
        jnp.asarray(x, jnp.float32).reshape((1,) * side.ndim + (-1,))
        for x in (ECHO_ANGLE_FACTORS, ECHO_DELAY_SWINGS, ECHO_DELAY_OFFSETS)
    )
    wave = jnp.sin(pace * (math.pi / 2 - jnp.minimum(around, math.pi))[..., None])
    back = (jnp.clip(around / math.pi - 1, 0.0, 0.5) * 2)[..., None]  # 0 behind .. 1 below
    wave = wave + back * (jnp.sin(pace * jnp.float32(math.pi)) - wave)
    samples = swing * jnp.cos(side / 2)[..., None] * wave + middle
    return jnp.maximum(samples, 0.0) / jnp.float32(PINNA_MODEL_RATE)


def add_echoes(
    ears: Complex[Array, "p 2 s"], delay: Float[Array, "p 2"], toward: Float[Array, "p 3"], sample_rate: int
) -> Complex[Array, "p 2 s"]:
    """Add pinna echoes, `ECHO_STRENGTHS` re the direct sound, to ear filters; echo delays are the same at both ears.

    Args:
        ears: Values of causal filters of the left and right ear at the knots of `filter_basis`.
        delay: Mean delay of these filters [s]. It is removed from them and tabulated together with each echo's delay,
            because the few knots do not resolve products of delays.
        toward: Unit vectors towards the directions of incidence, in the head frame.
        sample_rate: [Hz].
    """
    whole = jnp.maximum(pinna_delays(toward)[:, None] + delay[..., None], 0.0)
    place = whole * jnp.float32(PINNA_MODEL_RATE * NUM_DELAY_STEPS / MAX_ECHO_DELAY)
    low = jnp.clip(place.astype(jnp.int32), 0, NUM_DELAY_STEPS - 1)
    rest = jnp.clip(place - low.astype(jnp.float32), 0.0, 1.0)[..., None]
    strength = jnp.asarray(ECHO_STRENGTHS, jnp.float32)[None, None, :, None]
    real, imag = (
        jnp.sum(strength * (rows[low] * (1 - rest) + rows[low + 1] * rest), axis=2)
        for rows in (jnp.asarray(part) for part in _delay_filters(sample_rate))
    )
    angle = delay[..., None] * jnp.asarray(2 * math.pi * filter_basis(sample_rate).frequency, jnp.float32)[None, None]
    return ears + ears * jax.lax.complex(jnp.cos(angle), jnp.sin(angle)) * jax.lax.complex(real, imag)


@functools.cache
def _delay_filters(sample_rate: int) -> tuple[Float[np.ndarray, "d s"], Float[np.ndarray, "d s"]]:
    """Fit `filter_basis` to delays of 0 to `MAX_ECHO_DELAY`; return real, imaginary parts at its knots."""
    table, (frequency, response) = filter_basis(sample_rate), basis_responses(sample_rate)
    delay = np.linspace(0, MAX_ECHO_DELAY / PINNA_MODEL_RATE, NUM_DELAY_STEPS + 1)
    value = fit_basis_weights(response, np.exp(-2j * np.pi * delay[:, None] * frequency)) @ table.value
    return np.real(value).astype(np.float32), np.imag(value).astype(np.float32)


def echo_response(toward: Float[Array, "p 3"], frequency: Float[np.ndarray, " f"]) -> Complex[Array, "p f"]:
    """Compute the transfer function of direct sound and echoes at `frequency` [Hz]; `toward` as in `pinna_delays`."""
    angle = -2 * math.pi * pinna_delays(toward)[..., None] * jnp.asarray(frequency, jnp.float32)[None, None]
    strength = jnp.asarray(ECHO_STRENGTHS, jnp.float32)[None, :, None]
    real, imag = (jnp.sum(strength * part, axis=1) for part in (jnp.cos(angle), jnp.sin(angle)))
    return jax.lax.complex(1 + real, imag)


def pinna_energy(toward: Float[Array, "n 3"], sample_rate: int) -> Float[Array, "n bands"]:
    """Compute the mean energy of sound with echoes per octave re sound without; `toward` as in `pinna_delays`."""
    frequency = _octave_frequencies(sample_rate)
    power = jnp.abs(echo_response(toward, frequency.ravel())) ** 2
    return jnp.mean(power.reshape(-1, *frequency.shape), axis=-1)


@functools.cache
def _octave_frequencies(sample_rate: int) -> Float[np.ndarray, "bands parts"]:
    """Return `FREQUENCIES_PER_OCTAVE` equally spaced frequencies of each octave [Hz], below half the sample rate.

    Octaves end there, and those above it have frequencies from 0.4 of the rate on.
    """
    low = np.minimum(np.array(BANDS) / math.sqrt(2), 0.4 * sample_rate)
    high = np.minimum(np.array(BANDS) * math.sqrt(2), 0.5 * sample_rate)
    place = (np.arange(FREQUENCIES_PER_OCTAVE) + 0.5) / FREQUENCIES_PER_OCTAVE
    return low[:, None] + (high - low)[:, None] * place[None]
