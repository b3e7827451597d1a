"""Parts of synthesized sounds: shaped noise, oscillators, modes of bodies, events at random times."""

import functools
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

Samples = Float[np.ndarray, "_"]
Random = np.random.Generator
ClipFamily = Callable[[int, int, Random], Samples]  # length [samples], sample rate [Hz], random parameters

MAX_FREQUENCY_SHARE = 0.45  # maximum frequency of partials as a fraction of the sample rate


def shaped_noise(
    length: int, sample_rate: int, random: Random, gain: Callable[[Samples], Samples], octaves: float = 0.0
) -> Samples:
    """Return seamless Gaussian noise whose amplitude spectrum is `gain` of the frequency [Hz], of unit RMS.

    With `octaves` its spectrum also has random ripples: ± this many octaves of amplitude, on average, per band.
    """
    frequency = np.fft.rfftfreq(length, 1 / sample_rate)
    shape = gain(np.maximum(frequency, 1.0))
    if octaves:
        knots = np.geomspace(50, sample_rate / 2, 14)
        shape = shape * 2 ** np.interp(np.log(np.maximum(frequency, 1)), np.log(knots), random.normal(0, octaves, 14))
    noise = np.fft.irfft(np.fft.rfft(random.normal(size=length)) * shape, length)
    return noise / np.sqrt(np.mean(noise**2))


def band_gain(low: float, high: float, order: int = 2) -> Callable[[Samples], Samples]:
    """Return the amplitude gain of a band-pass from `low` to `high` [Hz], with slopes of 6 `order` dB per octave."""
    return lambda f: 1 / np.sqrt((1 + (low / f) ** (2 * order)) * (1 + (f / high) ** (2 * order)))


def slow_curve(length: int, random: Random, num_knots: int) -> Samples:
    """Return a smooth seamless random curve: Gaussian values at `num_knots` times, of unit variance there."""
    bins = np.zeros(length // 2 + 1, complex)
    count = min(num_knots, bins.size - 1)
    bins[1 : count + 1] = random.normal(size=count) + 1j * random.normal(size=count)
    curve = np.fft.irfft(bins, length)
    return curve / curve.std()


def oscillator_phase(pitch: Samples, sample_rate: int) -> Samples:
    """Return the phase [rad] of an oscillator whose frequency is `pitch` [Hz], scaled to whole cycles per loop."""
    cycles = np.cumsum(pitch) / sample_rate
    return 2 * np.pi * (cycles - cycles[0]) * (max(round(cycles[-1]), 1) / cycles[-1])


def harmonic_tone(phase: Samples, pitch: float, sample_rate: int, amplitudes: Samples) -> Samples:
    """Return the sum of harmonics 1, 2, ... of `phase` with these amplitudes, as far as they are below the limit.

    `pitch` is the maximum frequency [Hz] of the first one.
    """
    count = min(len(amplitudes), int(MAX_FREQUENCY_SHARE * sample_rate / pitch))
    turn, power, total = np.exp(1j * phase), np.ones(phase.size, complex), np.zeros(phase.size)
    for amplitude in amplitudes[:count]:
        power = power * turn
        total += amplitude * np.imag(power)
    return total


def modal_strike(
    seconds: float, sample_rate: int, frequencies: Samples, decays: Samples, amplitudes: Samples, attack: float = 0.001
) -> Samples:
    """Return one strike of a body: sines that decay by exp(-decay t), after an attack [s]; it ends at 0.

    Frequencies above the limit of partials are left out.
    """
    time = np.arange(max(round(seconds * sample_rate), 2)) / sample_rate
    kept = frequencies < MAX_FREQUENCY_SHARE * sample_rate
    rings = np.sin(2 * np.pi * np.outer(frequencies[kept], time)) * np.exp(-np.outer(decays[kept], time))
    fades = np.minimum(time / attack, 1) * np.minimum((time[-1] - time) / (0.2 * time[-1]), 1)
    return amplitudes[kept] @ rings * fades


def noise_burst(
    seconds: float, sample_rate: int, random: Random, low: float, high: float, decay: float, attack: float = 0.001
) -> Samples:
    """Return a burst of noise from `low` to `high` [Hz] that decays by exp(-decay t) after an attack [s]."""
    count = max(round(seconds * sample_rate), 16)
    time = np.arange(count) / sample_rate
    noise = shaped_noise(count, sample_rate, random, band_gain(low, high))
    return noise * np.exp(-decay * time) * np.minimum(time / attack, 1) * np.minimum((time[-1] - time) / 0.005, 1)


def random_times(length: int, random: Random, count: int, irregularity: float = 1.0) -> np.ndarray:
    """Return `count` sample numbers of events, around an even grid: irregularity 0 is even, 1 nearly random."""
    even = (np.arange(count) + irregularity * random.uniform(-0.5, 0.5, count)) * length / count
    return np.round(even + random.uniform(0, length)).astype(int) % length


def add_events(length: int, starts: np.ndarray, event: Callable[[int], Samples]) -> Samples:
    """Return the sum of `event(i)`, each beginning at `starts[i]`, around the loop; events longer than it wrap."""
    total = np.zeros(length)
    for number, start in enumerate(starts):
        samples = event(number)
        np.add.at(total, (start + np.arange(samples.size)) % length, samples)
    return total


def num_events(length: int, sample_rate: int, rate: float) -> int:
    """Return the number of events per loop at `rate` per second, at least 1."""
    return max(round(rate * length / sample_rate), 1)


def draw_log(random: Random, low: float, high: float) -> float:
    """Draw a number log-uniformly."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def make_variants(families: tuple[ClipFamily, ...], count: int, seed: int) -> dict[str, Callable[[int, int], Samples]]:
    """Return `count` clips of each family by name, such as `engine_0`: functions of length and sample rate.

    The random parameters of a clip depend on `seed`, on the family's place and on the number of the clip only.
    """

    def make(family: ClipFamily, place: int, number: int, length: int, sample_rate: int) -> Samples:
        """Synthesize one clip with the random generator of its own."""
        return family(length, sample_rate, np.random.default_rng((seed, place, number)))

    return {
        f"{family.__name__}_{number}": functools.partial(make, family, place, number)
        for place, family in enumerate(families)
        for number in range(count)
    }
