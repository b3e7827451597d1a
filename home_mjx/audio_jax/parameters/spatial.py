"""Spatial parameters: interaural cross-correlation and lateral energy fraction."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.parameters.clarity import early_energy
from home_mjx.audio_jax.parameters.decay import onset, samples_since_onset

MAX_EAR_DELAY = 0.001  # [s], maximum delay between the ears


def iacc(
    response: Float[Array, "*c 2 n"], sample_rate: int, start: float = 0.0, stop: float = float("inf")
) -> Float[Array, "*c"]:
    """Compute the interaural cross-correlation coefficient, 0 to 1 (ISO 3382-1:2009, annex B).

    It is the largest absolute value of the normalised correlation of both ears, at delays up to 1 ms. It is NaN if an
    ear has no energy in the evaluated part. Times count from the `onset` of both ears' summed energy.

    Args:
        response: Pressure at the left and right ear; leading axes may be octave bands, see `octave_responses`.
        sample_rate: [Hz].
        start: Start of the evaluated part after the direct sound [s]: 0 for IACC_E and IACC_A, 0.08 for IACC_L.
        stop: End of the evaluated part [s]: 0.08 for IACC_E, otherwise inf.

    Example:
        >>> ears = jnp.zeros((2, 400)).at[0, 10].set(1.0).at[1, 14].set(-0.5)  # 0.25 ms apart
        >>> float(iacc(ears, 16000).round(3))
        1.0
    """
    length = response.shape[-1]
    since = samples_since_onset(jnp.sum(response**2, axis=-2))[..., None, :]
    begin, end = round(start * sample_rate), min(round(min(stop, 1e4) * sample_rate), length)
    part = jnp.where((since >= begin) & (since < end), response, 0.0)
    spectrum = jnp.fft.rfft(part, 2 * length)
    cross = jnp.fft.irfft(spectrum[..., 0, :] * jnp.conj(spectrum[..., 1, :]), 2 * length)
    delays = round(MAX_EAR_DELAY * sample_rate)
    cross = jnp.concatenate([cross[..., : delays + 1], cross[..., 2 * length - delays :]], axis=-1)
    return jnp.max(jnp.abs(cross), axis=-1) / jnp.sqrt(jnp.prod(jnp.sum(part**2, axis=-1), axis=-1))


def lateral_fraction(lateral: Float[Array, "*c n"], energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute the early lateral energy fraction LF, 0 to 1 (ISO 3382-1:2009, A.14).

    LF is the energy of a figure-of-eight along the axis of the ears from 5 to 80 ms, re that of an omnidirectional
    microphone from 0 to 80 ms. Times count from the direct sound in `energy`. It is NaN in silence.

    Args:
        lateral: Energy weighted by the squared cosine between its direction and the axis of the ears.
        energy: Energy without weights.
        dt: Time of one sample or bin [s].
    """
    first = onset(energy)
    return early_energy(lateral, dt, 0.005, 0.08, first) / early_energy(energy, dt, 0.0, 0.08, first)
