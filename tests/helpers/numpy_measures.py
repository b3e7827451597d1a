"""Room-acoustic measures of ISO 3382 in NumPy, apart from the engine: an oracle of `audio_jax.parameters`."""

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.base.filters import octave_gains


def decay_curve(energy: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Schroeder's backward integral of an energy (squared response or histogram) [dB re its total].

    NaN where there is no energy at all.
    """
    remaining = np.cumsum(np.asarray(energy, np.float64)[::-1])[::-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return 10 * np.log10(remaining / remaining[0])


def decay_time(energy: Float[np.ndarray, " n"], dt: float, start: float = -5.0, stop: float = -35.0) -> float:
    """Time of a 60 dB decay [s], from a line through the decay curve between two levels.

    Args:
        energy: Squared response, or energy per bin.
        dt: Time of one sample or bin [s].
        start: Upper end of the fit [dB]: -5 for T30 and T20, 0 for EDT.
        stop: Lower end [dB]: -35 for T30, -25 for T20, -10 for EDT.

    Returns:
        The decay time, NaN where fewer than two samples lie between the levels.

    Example:
        >>> decay = np.exp(-13.8155 * np.arange(1000) * 1e-3)  # 60 dB in 1 s
        >>> round(decay_time(decay, 1e-3), 2)
        1.0
    """
    level = decay_curve(energy)
    inside = np.flatnonzero((level <= start) & (level >= stop))
    if inside.size < 2:
        return float("nan")
    slope, _ = np.polyfit(inside * dt, level[inside], 1)
    return float(-60 / slope)


def t30(energy: Float[np.ndarray, " n"], dt: float) -> float:
    """Reverberation time from the decay between -5 and -35 dB [s]."""
    return decay_time(energy, dt)


def edt(energy: Float[np.ndarray, " n"], dt: float) -> float:
    """Early decay time, from the first 10 dB [s]."""
    return decay_time(energy, dt, 0.0, -10.0)


def c50(energy: Float[np.ndarray, " n"], dt: float) -> float:
    """Clarity [dB]: energy within 50 ms of the first arrival over the energy after."""
    split = _first(energy) + round(0.05 / dt)
    return _ratio(energy[:split], energy[split:])


def drr(energy: Float[np.ndarray, " n"], dt: float) -> float:
    """Direct-to-reverberant ratio [dB]: energy within 2.5 ms around the strongest sample over the rest."""
    peak, half = int(np.argmax(energy)), round(0.0025 / dt)
    direct = slice(max(peak - half, 0), peak + half + 1)
    return _ratio(energy[direct], np.delete(energy, direct))


def octave_energies(response: Float[np.ndarray, "*c n"], sample_rate: int) -> Float[np.ndarray, "*c bands"]:
    """Energy of a response in each octave band, over the share of the spectrum that the band holds.

    A unit pulse therefore has energy 1 in every band.
    """
    response = np.asarray(response, np.float64)
    size = 2 * response.shape[-1]
    spectrum = np.abs(np.fft.rfft(response, size)) ** 2
    # a one-sided spectrum holds every frequency but the first and last twice
    weight = np.where(np.arange(spectrum.shape[-1]) % (size // 2) == 0, 1.0, 2.0)
    gains = octave_gains(np.fft.rfftfreq(size, 1 / sample_rate)) * weight
    return spectrum @ gains.T / np.maximum(gains.sum(axis=1), 1e-9)


def octave_responses(response: Float[np.ndarray, "*c n"], sample_rate: int) -> Float[np.ndarray, "*c bands n"]:
    """A response split into octave bands that add up to it."""
    response = np.asarray(response, np.float64)
    length = response.shape[-1]
    spectrum = np.fft.rfft(response, 2 * length)[..., None, :]
    gains = octave_gains(np.fft.rfftfreq(2 * length, 1 / sample_rate))
    return np.fft.irfft(spectrum * gains, 2 * length)[..., :length]


def _first(energy: Float[np.ndarray, " n"]) -> int:
    """First sample within 20 dB of the strongest."""
    return int(np.argmax(energy >= 0.01 * np.max(energy)))


def _ratio(part: Float[np.ndarray, " a"], rest: Float[np.ndarray, " b"]) -> float:
    with np.errstate(divide="ignore"):
        return float(10 * np.log10(np.sum(part, dtype=np.float64) / np.sum(rest, dtype=np.float64)))


def split(energy: np.ndarray, dt: float, seconds: float) -> tuple[float, float]:
    """Energy before and after a time since the direct sound."""
    at = _first(energy) + round(seconds / dt)
    return float(np.sum(energy[:at], dtype=np.float64)), float(np.sum(energy[at:], dtype=np.float64))


def centre_time(energy: np.ndarray, dt: float) -> float:
    """Centre of gravity after the direct sound [s]."""
    since = (np.arange(len(energy)) - _first(energy)) * dt
    return float(np.sum(since * energy) / np.sum(energy, dtype=np.float64))


def correlation(left: np.ndarray, right: np.ndarray, sample_rate: int) -> float:
    """Largest normalised correlation of two ears within 1 ms, in the time domain."""
    lags, length = round(0.001 * sample_rate), len(left)
    shifts = range(-lags, lags + 1)
    sums = [np.dot(left[max(k, 0) : length + min(k, 0)], right[max(-k, 0) : length - max(k, 0)]) for k in shifts]
    return float(np.max(np.abs(sums)) / np.sqrt(np.dot(left, left) * np.dot(right, right)))
