"""How fast sound decays: the decay curve and the times read from it.

All functions take energies, squared responses or histograms, with time along the last axis and any leading axes, such
as octave bands. Times count from the direct sound's arrival.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

ONSET = 0.01  # of the largest energy: the direct sound arrives where energy is first within 20 dB of it
LONGEST = 0.9  # share of a quarter's energy that the next may hold, for what is missing


def onset(energy: Float[Array, "*c n"]) -> Int[Array, "*c"]:
    """First index whose energy is within 20 dB of the largest (ISO 3382-1:2009, 5.3.1): the direct sound's arrival."""
    loudest = jnp.max(energy, axis=-1, keepdims=True)
    return jnp.argmax(energy >= ONSET * loudest, axis=-1).astype(jnp.int32)


def since_onset(energy: Float[Array, "*c n"], first: Int[Array, "*c"] | None = None) -> Int[Array, "*c n"]:
    """Index of each sample or bin, counted from the direct sound's arrival, or from `first`."""
    first = onset(energy) if first is None else first
    return jax.lax.broadcasted_iota(jnp.int32, energy.shape, energy.ndim - 1) - first[..., None]


def missing_energy(energy: Float[Array, "*c n"]) -> Float[Array, "*c"]:
    """Energy that a response would hold beyond its end, were it to fall on as over its second half.

    ISO 3382-1:2009, 5.3.3, adds such a constant to the integrated response. With the energies A and B of the third and
    the fourth quarter it is B² / (A − B), the sum of a geometric series; no more than nine times B.

    Example:
        >>> decay = 0.9 ** jnp.arange(40)
        >>> round(float(missing_energy(decay) / jnp.sum(0.9 ** jnp.arange(40, 400))), 3)
        1.0
    """
    length = energy.shape[-1]
    quarter = length // 4
    third = jnp.sum(energy[..., length - 2 * quarter : length - quarter], axis=-1)
    fourth = jnp.sum(energy[..., length - quarter :], axis=-1)
    ratio = jnp.where(fourth > 0, fourth / jnp.where(third > 0, third, 1.0), 0.0)
    ratio = jnp.minimum(jnp.where((third <= 0) & (fourth > 0), LONGEST, ratio), LONGEST)
    return fourth * ratio / (1 - ratio)


def decay_curve(energy: Float[Array, "*c n"]) -> Float[Array, "*c n"]:
    """Energy that is still to come [dB re all of it]: Schroeder's backward integral, ISO 3382-1:2009, equation 2.

    What is missing beyond the end is added, see `missing_energy`, so that a short response does not bend the curve.
    It is −inf where nothing is left, and NaN where there is no energy at all.

    Args:
        energy: Squared response, or energy per bin.

    Example:
        >>> decay_curve(jnp.array([9.0, 0.9, 0.1])).round(2).tolist()
        [0.0, -10.0, -20.0]
    """
    remaining = jax.lax.cumsum(energy, axis=energy.ndim - 1, reverse=True) + missing_energy(energy)[..., None]
    return 10 * jnp.log10(remaining / remaining[..., :1])


def decay_time(energy: Float[Array, "*c n"], dt: float, start: float, stop: float) -> Float[Array, "*c"]:
    """Time of a 60 dB decay [s]: from the least-squares line through the decay curve between two levels.

    ISO 3382-1:2009, 5.3.3 and A.2.2.

    Args:
        energy: Squared response, or energy per bin.
        dt: Time of one sample or bin [s].
        start: Level at which the line begins [dB], such as −5.
        stop: Level at which it ends [dB], such as −35.

    Returns:
        The time; NaN where the curve does not fall as far, or has fewer than two points between the levels.

    Example:
        >>> decay = 10 ** (-6 * jnp.arange(1000) * 1e-3)  # 60 dB in 1 s
        >>> round(float(decay_time(decay, 1e-3, -5.0, -35.0)), 3)
        1.0
    """
    level = decay_curve(energy)
    since = since_onset(energy)
    inside = (since >= 0) & (level <= start) & (level >= stop)
    falls = jnp.any(level <= stop, axis=-1)
    weight = inside.astype(jnp.float32)
    count = jnp.maximum(jnp.sum(weight, axis=-1, keepdims=True), 1.0)
    level = jnp.where(inside, level, 0.0)
    # Time counts from the middle of the range: squares of small numbers keep their digits.
    time = jnp.where(inside, since.astype(jnp.float32) * jnp.float32(dt), 0.0)
    time = weight * (time - jnp.sum(time, axis=-1, keepdims=True) / count)
    middle = jnp.sum(level, axis=-1, keepdims=True) / count
    slope = jnp.sum(time * (level - middle), axis=-1) / jnp.sum(time**2, axis=-1)
    return jnp.where(falls & (jnp.sum(weight, axis=-1) >= 2), -60 / slope, jnp.nan)


def t20(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Reverberation time from the decay between −5 and −25 dB [s], see `decay_time`."""
    return decay_time(energy, dt, -5.0, -25.0)


def t30(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Reverberation time from the decay between −5 and −35 dB [s], see `decay_time`."""
    return decay_time(energy, dt, -5.0, -35.0)


def edt(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Early decay time, from the first 10 dB [s], see `decay_time`."""
    return decay_time(energy, dt, 0.0, -10.0)
