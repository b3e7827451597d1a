"""Room-acoustic measures against closed forms and Pyroomacoustics."""

import numpy as np
import pytest
from numpy_measures import (
    c50,
    decay_curve,
    decay_time,
    drr,
    edt,
    octave_energies,
    octave_responses,
    t30,
)
from pyroomacoustics.experimental import measure_rt60

RATE = 16000


def exponential(rt60: float, seconds: float = 2.0) -> np.ndarray:
    """Energy that falls 60 dB in `rt60`."""
    return 10 ** (-6 * np.arange(int(seconds * RATE)) / RATE / rt60)


@pytest.mark.parametrize("rt60", [0.2, 0.6])
def test_times_of_an_exponential_decay(rt60):
    energy = exponential(rt60)
    assert t30(energy, 1 / RATE) == pytest.approx(rt60, rel=1e-3)
    assert edt(energy, 1 / RATE) == pytest.approx(rt60, rel=1e-3)
    expected = 10 * np.log10(10 ** (6 * 0.05 / rt60) - 1)
    assert c50(energy, 1 / RATE) == pytest.approx(expected, abs=0.02)


def test_times_tell_two_slopes_apart():
    energy = exponential(0.2) + 1e-2 * exponential(1.0)
    assert edt(energy, 1 / RATE) < 0.35
    assert decay_time(energy, 1 / RATE, -25.0, -45.0) == pytest.approx(1.0, rel=0.05)


def test_t30_equals_pyroomacoustics_on_noise(rng):
    response = rng.normal(size=2 * RATE) * np.sqrt(exponential(0.5))
    theirs = measure_rt60(response, fs=RATE, decay_db=30)
    assert t30(response**2, 1 / RATE) == pytest.approx(theirs, rel=0.02)


def test_silence_after_too_short_a_decay_is_not_a_number():
    assert np.isnan(t30(np.array([1.0, 0.0, 0.0]), 1e-3))


def test_decay_curve_starts_at_zero_and_falls():
    level = decay_curve(np.array([1.0, 2.0, 1.0]))
    np.testing.assert_allclose(level, 10 * np.log10([1, 3 / 4, 1 / 4]))


def test_drr_counts_what_surrounds_the_strongest_sample():
    energy = np.zeros(RATE)
    energy[[100, 130, 4000]] = 1.0, 0.5, 0.15
    assert drr(energy, 1 / RATE) == pytest.approx(10 * np.log10(1.5 / 0.15))


def test_octave_bands_of_a_pulse_and_of_a_tone():
    pulse = np.zeros((2, 4096))
    pulse[:, 50] = 1.0, 0.5
    np.testing.assert_allclose(octave_energies(pulse, RATE), [[1] * 7, [0.25] * 7], rtol=1e-9)
    tone = np.sin(2 * np.pi * 1000 * np.arange(RATE) / RATE)
    energies = octave_energies(tone, RATE)
    assert np.all(energies[[0, 1, 2, 4, 5, 6]] < 1e-3 * energies[3])


def test_octave_responses_add_up(rng):
    response = rng.normal(size=(2, 1000))
    bands = octave_responses(response, RATE)
    assert bands.shape == (2, 7, 1000)
    np.testing.assert_allclose(bands.sum(axis=1), response, atol=1e-9)
