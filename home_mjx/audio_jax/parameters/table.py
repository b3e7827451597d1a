"""All single-receiver parameters of one response, per octave band."""

from jaxtyping import Array, Float

from home_mjx.audio_jax.parameters.clarity import c50, c80, centre_time, d50, drr, strength
from home_mjx.audio_jax.parameters.decay import edt, t20, t30
from home_mjx.audio_jax.parameters.octaves import octave_responses
from home_mjx.core.pytree import Pytree


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
