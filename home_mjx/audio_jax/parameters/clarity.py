"""How sound is spread over time: clarity, definition, centre time, direct-to-reverberant ratio; and how strong it is.

All functions take energies with time along the last axis and any leading axes; times count from the direct sound.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.parameters.decay import missing_energy, since_onset

TEN_METRES = 20.0  # [dB], from the free field at 1 m, to which pressures relate, down to that at 10 m
DIRECT = 0.0025  # [s], on either side of the strongest sample


def early_energy(
    energy: Float[Array, "*c n"], dt: float, start: float, stop: float, first: Array | None = None
) -> Float[Array, "*c"]:
    """Energy that arrives between two times after the direct sound.

    Args:
        energy: Squared response, or energy per bin.
        dt: Time of one sample or bin [s].
        start: [s].
        stop: [s]; whole samples only, as `start`.
        first: Index at which the direct sound arrives; None: where `energy` has its onset.
    """
    since = since_onset(energy, first)
    return jnp.sum(jnp.where((since >= round(start / dt)) & (since < round(stop / dt)), energy, 0.0), axis=-1)


def definition(energy: Float[Array, "*c n"], dt: float, limit: float) -> Float[Array, "*c"]:
    """Share of the energy that arrives within a time limit after the direct sound, 0 to 1 (ISO 3382-1:2009, A.11)."""
    early = early_energy(energy, dt, -energy.shape[-1] * dt, limit)
    return early / (jnp.sum(energy, axis=-1) + missing_energy(energy))


def clarity(energy: Float[Array, "*c n"], dt: float, limit: float) -> Float[Array, "*c"]:
    """Energy within a time limit after the direct sound over the rest [dB] (ISO 3382-1:2009, A.10)."""
    early = definition(energy, dt, limit)
    return 10 * jnp.log10(early / (1 - early))


def c50(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Clarity of speech: `clarity` at 50 ms [dB]."""
    return clarity(energy, dt, 0.05)


def c80(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Clarity of music: `clarity` at 80 ms [dB]."""
    return clarity(energy, dt, 0.08)


def d50(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Definition of speech: `definition` at 50 ms, 0 to 1."""
    return definition(energy, dt, 0.05)


def centre_time(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Centre of gravity of the squared response after the direct sound, Ts [s] (ISO 3382-1:2009, A.13).

    Example:
        >>> round(float(centre_time(10 ** (-6 * jnp.arange(2000) * 1e-3), 1e-3)), 4)  # T / (6 ln 10)
        0.0719
    """
    since = since_onset(energy).astype(jnp.float32) * jnp.float32(dt)
    return jnp.sum(since * energy, axis=-1) / jnp.sum(energy, axis=-1)


def drr(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Direct-to-reverberant ratio [dB]: energy within 2.5 ms of the strongest sample over all other energy."""
    near = jnp.abs(since_onset(energy, jnp.argmax(energy, axis=-1).astype(jnp.int32))) <= round(DIRECT / dt)
    direct, rest = (jnp.sum(jnp.where(part, energy, 0.0), axis=-1) for part in (near, ~near))
    return 10 * jnp.log10(direct / rest)


def strength(energy: Float[Array, "*c n"]) -> Float[Array, "*c"]:
    """Sound strength G [dB]: level above that of the same source in the free field at 10 m (ISO 3382-1:2009, A.6).

    Args:
        energy: Squared response, or energy per bin, relative to the free field at 1 m, as all of the engine's are.

    Example:
        >>> float(strength(jnp.array([0.0, 0.01, 0.0])).round(3))
        0.0
    """
    return 10 * jnp.log10(jnp.sum(energy, axis=-1)) + TEN_METRES
