"""Octave-band responses, and all single-receiver parameters of one response per band."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.parameters.clarity import c50, c80, centre_time, d50, drr, strength
from home_mjx.audio_jax.parameters.decay import edt, t20, t30
from home_mjx.core.pytree import Pytree

FILTER_LEAD = 0.032  # [s], start of bands before the response, because zero-phase filters also ring before a pulse


def octave_responses(response: Float[Array, "*c n"], sample_rate: int) -> Float[Array, "*c bands m"]:
    """Filter a pressure response into octave bands from 125 to 8000 Hz, in each of which a unit pulse has energy 1.

    Filters have zero phase; their energy gains are those of `octave_gains`, scaled to that energy. Results begin
    `FILTER_LEAD` seconds before the response and end with it.
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


class RoomParameters(Pytree):
    """Room acoustic parameters of ISO 3382-1 per octave band; NaN where a response does not decay far enough."""

    t20: Float[Array, "*c bands"]  # [s]
    t30: Float[Array, "*c bands"]  # [s]
    edt: Float[Array, "*c bands"]  # [s]
    c50: Float[Array, "*c bands"]  # [dB]
    c80: Float[Array, "*c bands"]  # [dB]
    d50: Float[Array, "*c bands"]  # 0 to 1
    centre_time: Float[Array, "*c bands"]  # [s]
    drr: Float[Array, "*c bands"]  # [dB]
    strength: Float[Array, "*c bands"]  # [dB]


def measure_energy(energy: Float[Array, "*c n"], dt: float) -> RoomParameters:
    """Compute all parameters from energies over time, along the last axis.

    Args:
        energy: Squared responses per band, or energy per bin, re the free field at 1 m.
        dt: Time of one sample or bin [s].
    """
    return RoomParameters(
        t20=t20(energy, dt),
        t30=t30(energy, dt),
        edt=edt(energy, dt),
        c50=c50(energy, dt),
        c80=c80(energy, dt),
        d50=d50(energy, dt),
        centre_time=centre_time(energy, dt),
        drr=drr(energy, dt),
        strength=strength(energy),
    )


def measure_response(response: Float[Array, "*c n"], sample_rate: int) -> RoomParameters:
    """Compute all parameters of an omnidirectional response, in octave bands.

    Args:
        response: Pressure re the source's free field at 1 m.
        sample_rate: [Hz]; bands above half of it are meaningless.

    Example:
        >>> import jax, jax.numpy as jnp, numpy as np
        >>> noise = np.random.default_rng(0).normal(size=16000)
        >>> response = jnp.asarray(noise * 10 ** (-3 * np.arange(16000) / 8000), jnp.float32)  # 60 dB in 0.5 s
        >>> measured = jax.jit(measure_response, static_argnums=1)(response, 16000)
        >>> measured.t30[3:].round(1).tolist()
        [0.5, 0.5, 0.5, 0.5]
    """
    return measure_energy(octave_responses(response, sample_rate) ** 2, 1 / sample_rate)
