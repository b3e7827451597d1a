"""Parameters of energy over time and of level: clarity, definition, centre time, DRR, sound strength.

All functions take energies with time along the last axis and any leading axes; times count from the direct sound.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.parameters.decay import missing_energy, samples_since_onset

LEVEL_1M_RE_10M = 20.0  # [dB], free-field level at 1 m, the reference of pressures, re that at 10 m
DIRECT_HALF_WIDTH = 0.0025  # [s], half width of the direct sound around the strongest sample


def early_energy(
    energy: Float[Array, "*c n"], dt: float, start: float, stop: float, first: Array | None = None
) -> Float[Array, "*c"]:
    """Sum the energy that arrives between two times after the direct sound.

    Args:
        energy: Squared response, or energy per bin.
        dt: Time of one sample or bin [s].
        start: Start time [s], rounded to samples; inclusive.
        stop: End time [s], rounded to samples; exclusive.
        first: Index of the direct sound's arrival; None: the onset of `energy`.
    """
    since = samples_since_onset(energy, first)
    return jnp.sum(jnp.where((since >= round(start / dt)) & (since < round(stop / dt)), energy, 0.0), axis=-1)


def definition(energy: Float[Array, "*c n"], dt: float, limit: float) -> Float[Array, "*c"]:
    """Compute the share of energy until `limit` [s] after the direct sound, 0 to 1 (ISO 3382-1:2009, A.11).

    `limit` is rounded to whole samples or bins; energy before the direct sound counts as early. The total
    includes `missing_energy`; the result is NaN in silence.
    """
    early = early_energy(energy, dt, -energy.shape[-1] * dt, limit)
    return early / (jnp.sum(energy, axis=-1) + missing_energy(energy))


def clarity(energy: Float[Array, "*c n"], dt: float, limit: float) -> Float[Array, "*c"]:
    """Compute the energy until `limit` [s] after the direct sound re that after it [dB] (ISO 3382-1:2009, A.10).

    Both are those of `definition`. The result is inf if no energy comes after the limit, and NaN in silence.
    """
    early = definition(energy, dt, limit)
    return 10 * jnp.log10(early / (1 - early))


def c50(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute C50, the clarity of speech: `clarity` at 50 ms [dB]."""
    return clarity(energy, dt, 0.05)


def c80(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute C80, the clarity of music: `clarity` at 80 ms [dB]."""
    return clarity(energy, dt, 0.08)


def d50(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute D50, the definition of speech: `definition` at 50 ms, 0 to 1."""
    return definition(energy, dt, 0.05)


def centre_time(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute Ts, the energy-weighted mean time after the direct sound [s] (ISO 3382-1:2009, A.13); NaN in silence.

    Energy before the direct sound counts with negative times. Energy beyond the end is not extrapolated.

    Example:
        >>> round(float(centre_time(10 ** (-6 * jnp.arange(2000) * 1e-3), 1e-3)), 4)  # T / (6 ln 10)
        0.0719
    """
    since = samples_since_onset(energy).astype(jnp.float32) * jnp.float32(dt)
    return jnp.sum(since * energy, axis=-1) / jnp.sum(energy, axis=-1)


def drr(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute the direct-to-reverberant ratio [dB]: energy within 2.5 ms before and after its maximum re the rest.

    2.5 ms are rounded to whole samples or bins. The result is inf if there is no rest, and NaN in silence.
    """
    near = jnp.abs(samples_since_onset(energy, jnp.argmax(energy, axis=-1).astype(jnp.int32))) <= round(
        DIRECT_HALF_WIDTH / dt
    )
    direct, rest = (jnp.sum(jnp.where(part, energy, 0.0), axis=-1) for part in (near, ~near))
    return 10 * jnp.log10(direct / rest)


def strength(energy: Float[Array, "*c n"]) -> Float[Array, "*c"]:
    """Compute the sound strength G [dB]: level re the same source at 10 m in the free field; -inf in silence.

    See ISO 3382-1:2009, A.6. Energies are re the free field at 1 m, as all of this package.

    Example:
        >>> float(strength(jnp.array([0.0, 0.01, 0.0])).round(3))
        0.0
    """
    return 10 * jnp.log10(jnp.sum(energy, axis=-1)) + LEVEL_1M_RE_10M
