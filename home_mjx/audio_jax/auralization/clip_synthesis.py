"""Synthesized household clips: functions from a length in samples and a sample rate to a seamless loop."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

Samples = Float[np.ndarray, "_"]


def _repeat(shape: Samples, seconds: float, sample_rate: int) -> Samples:
    """Sum copies of `shape`, as long as the loop, rotated by 0, 1, 2, ... periods of `seconds`.

    A copy whose period ends after the loop is left out. The loop must last at least one period.
    """
    period = round(seconds * sample_rate)
    return np.sum([np.roll(shape, start) for start in range(0, len(shape) - period + 1, period)], axis=0)


def _time(length: int, sample_rate: int) -> Samples:
    """Return the time of each sample [s]."""
    return np.arange(length) / sample_rate


def _pulse(time: Samples, begin: float, end: float, ramp: float = 0.01) -> Samples:
    """Return a window: 1 between two times [s] except for linear ramps of `ramp` [s] inside them, 0 outside."""
    return np.clip(np.minimum(time - begin, end - time) / ramp, 0, 1)


def _noise(length: int, seed: int) -> Samples:
    """Return white Gaussian noise of unit variance."""
    return np.random.default_rng(seed).normal(size=length)


def ring(length: int, sample_rate: int) -> Samples:
    """Synthesize a telephone: 440 and 480 Hz together, in two bursts of 0.4 s with 0.2 s between, every 2 s."""
    time = _time(length, sample_rate)
    tone = np.sin(2 * np.pi * 440 * time) + np.sin(2 * np.pi * 480 * time)
    return _repeat(tone * (_pulse(time, 0, 0.4) + _pulse(time, 0.6, 1.0)), 2, sample_rate)


def chirp(length: int, sample_rate: int) -> Samples:
    """Synthesize a bird: a tone that rises from 1.5 to 3 kHz in 0.15 s, twice a second."""
    time = _time(length, sample_rate)
    phase = 2 * np.pi * (1500 * time + 5000 * time**2)
    return _repeat(np.sin(phase) * _pulse(time, 0, 0.15), 0.5, sample_rate)


def knock(length: int, sample_rate: int) -> Samples:
    """Synthesize knuckles on wood: three thuds of 180 and 420 Hz, 0.3 s apart, every 2 s; they decay by exp(-40 t)."""
    time = _time(length, sample_rate)
    thud = (np.sin(2 * np.pi * 180 * time) + 0.6 * np.sin(2 * np.pi * 420 * time)) * np.exp(-40 * time)
    thud = thud * np.minimum(time / 0.002, 1)
    three = sum(np.roll(thud, round(begin * sample_rate)) for begin in (0.1, 0.4, 0.7))
    return _repeat(np.asarray(three), 2, sample_rate)


def bell(length: int, sample_rate: int) -> Samples:
    """Synthesize a bell of 600 Hz with its partials, struck every 2 s, as a seamless loop.

    Strikes ring on over later ones and over the loop's end. The level is not normalised.
    """
    time = _time(length, sample_rate)
    partials = np.array([0.5, 1.0, 1.2, 1.5, 2.0, 2.67])[:, None]
    strike = np.sin(2 * np.pi * 600 * partials * time) * np.exp(-2 * partials * time) / partials
    return _repeat(strike.sum(axis=0) * np.minimum(time / 0.003, 1), 2, sample_rate)


def alarm(length: int, sample_rate: int) -> Samples:
    """Synthesize an alarm: 800 and 1000 Hz in turn, 0.25 s each, both with the third harmonic at 1/3 amplitude."""
    time = _time(length, sample_rate)
    low, high = (sum(np.sin(2 * np.pi * pitch * n * time) / n for n in (1, 3)) for pitch in (800, 1000))
    return _repeat(low * _pulse(time, 0, 0.25) + high * _pulse(time, 0.25, 0.5), 0.5, sample_rate)


def bursts(length: int, sample_rate: int) -> Samples:
    """Synthesize bursts of white noise of 0.08 s, four times a second."""
    return _repeat(_noise(length, 3) * _pulse(_time(length, sample_rate), 0, 0.08), 0.25, sample_rate)


def whistle(length: int, sample_rate: int) -> Samples:
    """Synthesize a whistle: a tone of 1.2 kHz with a vibrato of ±150 Hz at 5 Hz."""
    time = _time(length, sample_rate)
    return np.sin(2 * np.pi * 1200 * time + 30 * np.sin(2 * np.pi * 5 * time))


def hum(length: int, sample_rate: int) -> Samples:
    """Synthesize a fridge: harmonics n = 2, 3, 4, 6, 8 and 12 of 50 Hz, constant, with amplitudes 1 / n."""
    time = _time(length, sample_rate)
    return np.sum([np.sin(2 * np.pi * 50 * n * time + n) / n for n in (2, 3, 4, 6, 8, 12)], axis=0)


def ticking(length: int, sample_rate: int) -> Samples:
    """Synthesize a clock: strokes of 2.5 kHz that decay by exp(-150 t), twice a second."""
    time = _time(length, sample_rate)
    return _repeat(np.sin(2 * np.pi * 2500 * time) * np.exp(-150 * time), 0.5, sample_rate)


def water(length: int, sample_rate: int) -> Samples:
    """Synthesize a running tap: 400 bubbles a second with radii r of 0.5 to 5 mm, ringing at (3 m/s) / r (Minnaert).

    Times and amplitudes are random, radii log-uniform; amplitudes are also proportional to radii. Decay rates are
    0.13 / r + 0.0072 / r^1.5 [1/s]: van den Doel, Physically based models for liquid sounds, ACM Transactions on
    Applied Perception 2, 534, 2005.
    """
    rng, time = np.random.default_rng(4), _time(round(0.1 * sample_rate), sample_rate)
    stream = np.zeros(length)
    for _ in range(round(400 * length / sample_rate)):
        radius = 0.0005 * 10 ** rng.uniform(0, 1)
        decay, pitch = 0.13 / radius + 0.0072 / radius**1.5, 3 / radius
        bubble = np.sin(2 * np.pi * pitch * time) * np.exp(-decay * time) * rng.uniform() * radius
        stream[(rng.integers(length) + np.arange(time.size)) % length] += bubble
    return stream


def static(length: int, sample_rate: int) -> Samples:
    """Synthesize a television without a programme: white noise times f² / (f² + 300²), as from a small loudspeaker."""
    frequency = np.fft.rfftfreq(length, 1 / sample_rate)
    gain = (frequency / 300) ** 2 / (1 + (frequency / 300) ** 2)
    return np.fft.irfft(np.fft.rfft(_noise(length, 5)) * gain, length)


# Other clips follow these in `CLIPS`: task files store names, but task arrays store indices.
HOUSEHOLD_CLIPS: dict[str, Callable[[int, int], Samples]] = {
    maker.__name__: maker for maker in (ring, chirp, knock, bell, alarm, bursts, whistle, hum, ticking, water, static)
}
