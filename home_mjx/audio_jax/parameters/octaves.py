"""Octave-band filtering of responses."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.filters import octave_gains

FILTER_LEAD = 0.032  # [s], start of bands before the response, because zero-phase filters also ring before a pulse


def octave_responses(response: Float[Array, "*c n"], sample_rate: int) -> Float[Array, "*c bands m"]:
    """Filter a response into octave bands from 125 to 8000 Hz, in each of which a unit pulse has energy 1.

    The filters have the gains of `octave_gains`, whose energies add up to one.

    Args:
        response: Pressure over time.
        sample_rate: [Hz].

    Returns:
        Pressure per band, from `FILTER_LEAD` seconds before the response on.
    """
    length, lead = response.shape[-1], round(FILTER_LEAD * sample_rate)
    size = 2 * length + 2 * lead
    gains = octave_gains(np.fft.rfftfreq(size, 1 / sample_rate))
    # A one-sided spectrum represents all frequencies but the first and the last twice.
    twice = np.where(np.arange(gains.shape[1]) % (size // 2) == 0, 1.0, 2.0)
    share = np.maximum((gains * twice).sum(axis=1) / size, 1e-9)
    filters = jnp.asarray(np.sqrt(gains / share[:, None]), jnp.float32)
    filters = filters.reshape((1,) * (response.ndim - 1) + gains.shape).astype(jnp.complex64)
    bands = jnp.fft.irfft(jnp.fft.rfft(response, size)[..., None, :] * filters, size)
    return jnp.concatenate([bands[..., size - lead :], bands[..., :length]], axis=-1)
