"""Responses in octave bands."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.filters import octave_gains

LEAD = 0.032  # [s], by which bands begin earlier than the response: zero-phase filters ring before a pulse, too


def octave_responses(response: Float[Array, "*c n"], sample_rate: int) -> Float[Array, "*c bands m"]:
    """A response in each octave band from 125 to 8000 Hz, scaled so that a unit pulse has energy 1 in every one.

    The filters are those of the engine, `octave_gains`, whose energies add up to one.

    Args:
        response: Pressure.
        sample_rate: [Hz].

    Returns:
        Pressure per band; begins `LEAD` seconds before the response.
    """
    length, lead = response.shape[-1], round(LEAD * sample_rate)
    size = 2 * length + 2 * lead
    gains = octave_gains(np.fft.rfftfreq(size, 1 / sample_rate))
    # a one-sided spectrum holds every frequency but the first and last twice
    twice = np.where(np.arange(gains.shape[1]) % (size // 2) == 0, 1.0, 2.0)
    share = np.maximum((gains * twice).sum(axis=1) / size, 1e-9)
    filters = jnp.asarray(np.sqrt(gains / share[:, None]), jnp.float32)
    filters = filters.reshape((1,) * (response.ndim - 1) + gains.shape).astype(jnp.complex64)
    bands = jnp.fft.irfft(jnp.fft.rfft(response, size)[..., None, :] * filters, size)
    return jnp.concatenate([bands[..., size - lead :], bands[..., :length]], axis=-1)
