"""Decay curve, and the decay times T20, T30 and EDT.

All functions take energies, squared responses or histograms, with time along the last axis and any leading axes, such
as octave bands. Times count from the direct sound's arrival.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

ONSET_THRESHOLD = 0.01  # energy of the direct sound's arrival re the largest energy, −20 dB
MAX_QUARTER_RATIO = 0.9  # maximum energy ratio of successive quarters, for `missing_energy`


def onset(energy: Float[Array, "*c n"]) -> Int[Array, "*c"]:
    """Return the first index within 20 dB of the maximum, the direct sound's arrival (ISO 3382-1); 0 in silence."""
    loudest = jnp.max(energy, axis=-1, keepdims=True)
    return jnp.argmax(energy >= ONSET_THRESHOLD * loudest, axis=-1).astype(jnp.int32)


def samples_since_onset(energy: Float[Array, "*c n"], first: Int[Array, "*c"] | None = None) -> Int[Array, "*c n"]:
    """Return the index of each sample re `first`, or re `onset` if that is None; negative before it."""
    first = onset(energy) if first is None else first
    return jax.lax.broadcasted_iota(jnp.int32, energy.shape, energy.ndim - 1) - first[..., None]


def missing_energy(energy: Float[Array, "*c n"]) -> Float[Array, "*c"]:
    """Estimate a response's energy beyond its end, by extrapolation of the decay over its second half.

    ISO 3382-1:2009, 5.3.3, adds such a constant to the integrated response. With the energies A and B of the third and
    the fourth quarter it is B² / (A − B), the sum of a geometric series. It is at most nine times B, also if B >= A; it
    is 0 for fewer than four samples.

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
    ratio = jnp.minimum(jnp.where((third <= 0) & (fourth > 0), MAX_QUARTER_RATIO, ratio), MAX_QUARTER_RATIO)
    return fourth * ratio / (1 - ratio)


def decay_curve(energy: Float[Array, "*c n"]) -> Float[Array, "*c n"]:
    """Compute the decay curve [dB re total energy] of a squared response or of energies per bin.

    It is Schroeder's backward integral (ISO 3382-1:2009, equation 2). Energy beyond the end is added, see
    `missing_energy`, so that the curve of a short response does not bend down. The curve is −inf where no energy
    remains, and NaN if there is no energy at all.

    Example:
        >>> decay_curve(jnp.array([9.0, 0.9, 0.1])).round(2).tolist()
        [0.0, -10.0, -20.0]
    """
    remaining = jax.lax.cumsum(energy, axis=energy.ndim - 1, reverse=True) + missing_energy(energy)[..., None]
    return 10 * jnp.log10(remaining / remaining[..., :1])


def decay_time(energy: Float[Array, "*c n"], dt: float, start: float, stop: float) -> Float[Array, "*c"]:
    """Compute the time of a 60 dB decay [s] from a least-squares line through `decay_curve` between two levels.

    Points before the direct sound do not count. See ISO 3382-1:2009, 5.3.3 and A.2.2.

    Args:
        energy: Squared response, or energy per bin.
        dt: Time of one sample or bin [s].
        start: Upper level [dB], such as −5.
        stop: Lower level [dB], such as −35.

    Returns:
        The time; NaN if the curve does not reach `stop`, or has fewer than two points between the levels.

    Example:
        >>> decay = 10 ** (-6 * jnp.arange(1000) * 1e-3)  # 60 dB in 1 s
        >>> round(float(decay_time(decay, 1e-3, -5.0, -35.0)), 3)
        1.0
    """
    level = decay_curve(energy)
    since = samples_since_onset(energy)
    inside = (since >= 0) & (level <= start) & (level >= stop)
    falls = jnp.any(level <= stop, axis=-1)
    weight = inside.astype(jnp.float32)
    count = jnp.maximum(jnp.sum(weight, axis=-1, keepdims=True), 1.0)
    level = jnp.where(inside, level, 0.0)
    # Times are centred before squaring, for float32 precision.
    time = jnp.where(inside, since.astype(jnp.float32) * jnp.float32(dt), 0.0)
    time = weight * (time - jnp.sum(time, axis=-1, keepdims=True) / count)
    middle = jnp.sum(level, axis=-1, keepdims=True) / count
    slope = jnp.sum(time * (level - middle), axis=-1) / jnp.sum(time**2, axis=-1)
    return jnp.where(falls & (jnp.sum(weight, axis=-1) >= 2), -60 / slope, jnp.nan)


def t20(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute the time of a 60 dB decay [s] from that between −5 and −25 dB; NaN if the curve ends before −25."""
    return decay_time(energy, dt, -5.0, -25.0)


def t30(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute the time of a 60 dB decay [s] from that between −5 and −35 dB; NaN if the curve ends before −35."""
    return decay_time(energy, dt, -5.0, -35.0)


def edt(energy: Float[Array, "*c n"], dt: float) -> Float[Array, "*c"]:
    """Compute the early decay time, extrapolated to 60 dB from the first 10 dB [s]; NaN as in `decay_time`."""
    return decay_time(energy, dt, 0.0, -10.0)
