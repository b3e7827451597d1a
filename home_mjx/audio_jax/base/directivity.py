"""Source directivity: pressure gain per octave and angle, rotationally symmetric about the source's axis."""

import math
from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.core.checks import check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import BANDS

NUM_ANGLES = 181  # one per degree
TALKER_FRONT_TO_BACK = (2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 18.0)  # [dB], front-to-back ratio of talkers, 125 to 8000 Hz


class Directivity(Pytree):
    """Pressure in each direction re that on the axis; rotationally symmetric."""

    gain: Float[Array, "a bands"]  # by angle to the axis, from 0 to pi in equal steps


def stack_directivities(patterns: Sequence[Directivity]) -> Directivity:
    """Stack directivities with the same number of angles, one per source, along a new leading axis, for `SoundSources`.

    There must be one; different numbers of angles raise `ValueError`.

    Example:
        >>> stack_directivities([talker_directivity(), first_order_directivity(0.0)]).gain.shape
        (2, 181, 7)
    """
    return jax.tree.map(lambda *gain: jnp.stack(gain), *patterns)


def tabulated_directivity(gain: Float[np.ndarray, "a bands"]) -> Directivity:
    """Make a directivity from a table of measured gains, as they are: they are not normalised to 1 on the axis.

    Args:
        gain: Pressure re that on the axis, by angle from 0 to pi in equal steps, and octave from 125 to 8000 Hz.

    Raises:
        ConfigError: The shape is wrong, or a gain is negative or not finite.
    """
    table = np.asarray(gain, np.float32)
    if table.ndim != 2 or table.shape[0] < 2 or table.shape[1] != len(BANDS):
        raise ConfigError(f"a directivity needs (angles, {len(BANDS)}) gains of at least two angles, got {table.shape}")
    if not np.all(np.isfinite(table)) or np.any(table < 0):
        hint = "Gains are pressure magnitudes re the axis: use the absolute value where the polarity is inverted."
        raise ConfigError("gains of a directivity must be finite and not negative", hint=hint)
    return Directivity(jnp.asarray(table))


def first_order_directivity(
    weight: float | Sequence[float] = 0.5, exponent: float | Sequence[float] = 1.0
) -> Directivity:
    """Make the first-order directivity |1 - w + w cos θ|ⁿ, a pressure gain tabulated per degree.

    Its mean energy over the sphere is (1 - s |1 - 2w|²ⁿ⁺¹) / (2w (2n + 1)), s being the sign of 1 - 2w; 1 if w = 0.

    Args:
        weight: w, from 0 (omnidirectional) over 0.5 (cardioid) to 1 (figure of eight); one or one per octave.
        exponent: n, which narrows the pattern; one or one per octave.

    Raises:
        ConfigError: A value is out of range, or the number of values is neither one nor one per octave.

    Example:
        >>> first_order_directivity(0.5).gain[90].tolist()[:2]  # at 90 degrees
        [0.5, 0.5]
    """
    w, n = _per_octave("weight", weight, 1.0), _per_octave("exponent", exponent, math.inf)
    cosine = np.cos(_angles())[:, None]
    return tabulated_directivity(np.abs(1 - w + w * cosine) ** n)


def talker_directivity() -> Directivity:
    """Make the directivity of a human talker: the level is `TALKER_FRONT_TO_BACK` (1 - cos θ) / 2 dB below the axis.

    The front-to-back ratios are rounded figures of the order that Chu and Warnock report (Detailed directivity of sound
    fields around human talkers, NRC Canada IRC-RR-104, 2002). The 8 kHz ratio follows Monson, Hunter and Story (JASA
    132, 2012). Neither source tabulates these values. With k = ratio · ln(10) / 10 the mean energy over the sphere is
    (1 - exp(-k)) / k.

    Example:
        >>> level = 20 * np.log10(talker_directivity().gain[180])
        >>> level.round().tolist()
        [-2.0, -3.0, -5.0, -7.0, -10.0, -14.0, -18.0]
    """
    fall = (1 - np.cos(_angles()))[:, None] / 2 * np.array(TALKER_FRONT_TO_BACK)
    return tabulated_directivity(10 ** (-fall / 20))


def directivity_gains(pattern: Directivity, cosine: Float[Array, " n"]) -> Float[Array, "n bands"]:
    """Return pressure gains per octave at cosines, clipped to -1 .. 1, of angles to the axis.

    Their squares are interpolated linearly over the angle.
    """
    last = pattern.gain.shape[0] - 1
    place = jnp.arccos(jnp.clip(cosine, -1.0, 1.0)) * jnp.float32(last / math.pi)
    low = jnp.clip(place.astype(jnp.int32), 0, last - 1)
    rest = (place - low.astype(jnp.float32))[:, None]
    return jnp.sqrt(pattern.gain[low] ** 2 * (1 - rest) + pattern.gain[low + 1] ** 2 * rest)


def mean_energy(pattern: Directivity) -> Float[Array, " bands"]:
    """Compute the energy per octave, averaged over the sphere, re that on the axis: 1 / Q, with directivity factor Q.

    Example:
        >>> round(float(mean_energy(first_order_directivity(0.5))[0]), 4)  # a cardioid has Q = 3
        0.3333
    """
    weight = _solid_angles(pattern.gain.shape[0])
    return jnp.sum(jnp.asarray(weight)[:, None] * pattern.gain**2, axis=0)


def _solid_angles(count: int) -> Float[np.ndarray, " a"]:
    """Return weights, of sum 1, of `count` equally spaced angles 0 .. pi for means over the sphere.

    They are exact for energy that is linear between the angles.
    """
    step = math.pi / (count - 1)
    share = np.sin(np.arange(count) * step) * (1 - math.cos(step)) / step
    share[0] = share[-1] = (1 - math.sin(step) / step) / 2
    return share.astype(np.float32)


def _angles() -> Float[np.ndarray, " a"]:
    """Return `NUM_ANGLES` angles from 0 to pi [rad]."""
    return np.linspace(0, np.pi, NUM_ANGLES)


def _per_octave(name: str, value: float | Sequence[float], most: float) -> Float[np.ndarray, " bands"]:
    """Return one value per octave, a single one repeated; `ConfigError` for other counts, and outside 0 .. `most`."""
    values = [value] * len(BANDS) if isinstance(value, int | float) else list(value)
    if len(values) != len(BANDS):
        raise ConfigError(f"`{name}` must be one number or {len(BANDS)}, got {len(values)}")
    for number in values:
        check_number(name, number, 0.0, most)
    return np.array(values, float)
