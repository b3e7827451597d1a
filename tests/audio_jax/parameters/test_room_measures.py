"""Measures of rooms against closed forms and against NumPy."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import numpy_measures as oracle
import pytest

from home_mjx.audio_jax.parameters import (
    c50,
    c80,
    centre_time,
    d50,
    decay_curve,
    decay_time,
    drr,
    edt,
    iacc,
    lateral_fraction,
    measure_energy,
    measure_response,
    octave_responses,
    strength,
    t20,
    t30,
)

RATE = 16000
DT = 1 / RATE


def exponential(rt60: float, seconds: float) -> np.ndarray:
    """Energy that falls by 60 dB in `rt60`."""
    return 10 ** (-6 * np.arange(int(seconds * RATE)) / RATE / rt60)


@pytest.fixture(scope="module")
def measured():
    """`measure_energy`, compiled once under strict promotion."""

    def run(energy: np.ndarray):
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            return jax.tree.map(np.asarray, compiled(jnp.asarray(energy, jnp.float32)))

    compiled = jax.jit(functools.partial(measure_energy, dt=DT))
    return run


def test_an_exponential_decay_has_the_measures_that_calculus_gives(measured):
    times = np.array([0.2, 0.6, 1.5])  # the last one is cut at -40 dB
    found = measured(np.stack([exponential(t, 1.0) for t in times]))
    for value in (found.t20, found.t30, found.edt):
        np.testing.assert_allclose(value, times, rtol=2e-3)
    rate = 6 * np.log(10) / times
    np.testing.assert_allclose(found.d50, 1 - np.exp(-0.05 * rate), rtol=1e-3)
    np.testing.assert_allclose(found.c50, 10 * np.log10(np.expm1(0.05 * rate)), atol=0.01)
    np.testing.assert_allclose(found.c80, 10 * np.log10(np.expm1(0.08 * rate)), atol=0.01)
    np.testing.assert_allclose(found.centre_time[:2], 1 / rate[:2], atol=5e-5)  # half a sample
    np.testing.assert_allclose(found.strength[:2], 10 * np.log10(RATE / rate[:2]) + 20, atol=0.01)


def test_two_slopes_are_told_apart(measured):
    """Exact levels of the sum of two exponentials, and lines fitted to them by NumPy."""
    energy = exponential(0.25, 3.0) + 1e-2 * exponential(1.2, 3.0)
    found = measured(np.stack([energy, exponential(0.25, 3.0)]))
    rates = 6 * np.log(10) / np.array([0.25, 1.2])
    time = np.arange(3 * RATE) * DT
    level = np.log10(np.array([1, 1e-2]) / rates @ np.exp(-rates[:, None] * time)) * 10
    level -= level[0]
    for value, top, bottom in ((found.edt, 0, -10), (found.t20, -5, -25), (found.t30, -5, -35)):
        inside = (level <= top) & (level >= bottom)
        assert value[0] == pytest.approx(-60 / np.polyfit(time[inside], level[inside], 1)[0], rel=3e-3)
        assert value[1] == pytest.approx(0.25, rel=3e-3)
    assert decay_time(jnp.asarray(energy, jnp.float32), DT, -30.0, -45.0) == pytest.approx(1.2, rel=0.02)


def test_a_pulse_and_a_tail(measured):
    """Direct sound 10 ms after the start, a tail of a known energy from 15 ms after it on."""
    energy = np.zeros(2 * RATE)
    energy[160] = 2.0
    tail = exponential(0.5, 1.5)
    energy[400 : 400 + tail.size] = 0.5 * tail / tail.sum()
    found = measured(np.stack([energy, energy]))
    rate = 6 * np.log(10) / 0.5
    late = 0.5 * np.exp(-rate * (np.array([0.05, 0.08]) - 0.015))
    np.testing.assert_allclose(found.c50[0], 10 * np.log10(2.5 / late[0] - 1), atol=0.01)
    np.testing.assert_allclose(found.c80[0], 10 * np.log10(2.5 / late[1] - 1), atol=0.01)
    np.testing.assert_allclose(found.d50[0], 1 - late[0] / 2.5, rtol=1e-4)
    np.testing.assert_allclose(found.drr[0], 10 * np.log10(2 / 0.5), atol=1e-3)
    np.testing.assert_allclose(found.centre_time[0], 0.5 / 2.5 * (0.015 + 1 / rate), rtol=2e-3)
    np.testing.assert_allclose(found.strength[0], 10 * np.log10(2.5) + 20, atol=1e-3)


def test_all_measures_equal_numpy_on_noise(measured, rng):
    """An implementation without JAX, in double precision, on responses of random delay and decay."""
    noise = rng.normal(size=(5, 3 * RATE)) * np.sqrt(exponential(0.45, 3.0) + 1e-3 * exponential(0.8, 3.0))
    energy = np.stack([np.roll(n**2, k * 700) * (np.arange(n.size) >= k * 700) for k, n in enumerate(noise)])
    found = measured(energy)
    for row, e in enumerate(energy):
        e = e[oracle._first(e) :]  # NumPy's times start at the first sample
        assert found.t30[row] == pytest.approx(oracle.t30(e, DT), rel=2e-3)
        assert found.t20[row] == pytest.approx(oracle.decay_time(e, DT, -5, -25), rel=2e-3)
        assert found.edt[row] == pytest.approx(oracle.edt(e, DT), rel=0.01)
        early, late = oracle.split(energy[row], DT, 0.05)
        assert found.c50[row] == pytest.approx(10 * np.log10(early / late), abs=0.01)
        assert found.d50[row] == pytest.approx(early / (early + late), rel=1e-3)
        early, late = oracle.split(energy[row], DT, 0.08)
        assert found.c80[row] == pytest.approx(10 * np.log10(early / late), abs=0.01)
        assert found.drr[row] == pytest.approx(oracle.drr(energy[row], DT), abs=0.01)
        assert found.centre_time[row] == pytest.approx(oracle.centre_time(energy[row], DT), rel=1e-3)


def test_silence_has_no_measures_and_a_short_decay_no_times():
    silence = jnp.zeros(100)
    assert np.all(np.isnan([t20(silence, DT), t30(silence, DT), edt(silence, DT), c50(silence, DT)]))
    assert np.isnan([c80(silence, DT), d50(silence, DT), centre_time(silence, DT), drr(silence, DT)]).all()
    assert strength(silence) == -np.inf
    level = decay_curve(jnp.ones(400))
    assert level[0] == pytest.approx(0, abs=1e-5)
    assert np.isnan(t30(jnp.ones(400), DT))


@functools.partial(jax.jit, static_argnums=1)
def bands_of(response, rate):
    return octave_responses(response, rate)


def test_octaves_of_a_pulse_and_of_a_tone():
    """A unit pulse has energy 1 in each, and so level 20 dB in G; a tone only in its own."""
    pulse = np.zeros((2, RATE), np.float32)
    pulse[:, 30] = 1.0, 0.5
    pulse[1, 31:] = np.sin(2 * np.pi * 1000 * np.arange(RATE - 31) / RATE)
    pulse[1, 30] = 0
    energy = np.sum(np.asarray(bands_of(jnp.asarray(pulse), RATE)) ** 2, axis=-1)
    np.testing.assert_allclose(energy[0], 1, rtol=2e-3)
    assert np.all(energy[1, [0, 1, 2, 4, 5, 6]] < 1e-2 * energy[1, 3])


def test_measures_of_a_response_per_octave(rng):
    """Noise whose decay differs by octave; each band's time is found, as by NumPy on its own filters."""
    times = np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
    noise = rng.normal(size=2 * RATE)
    fall = np.stack([exponential(t, 2.0) for t in times])
    response = np.sum(oracle.octave_responses(noise, RATE) * np.sqrt(fall), axis=0)
    found = jax.jit(measure_response, static_argnums=1)(jnp.asarray(response, jnp.float32), RATE)
    np.testing.assert_allclose(found.t30[3:], times[3:], rtol=0.05)
    np.testing.assert_allclose(found.t30, times, rtol=0.15)  # noise of few degrees of freedom below
    theirs = [oracle.t30(b**2, DT) for b in oracle.octave_responses(response, RATE)]
    np.testing.assert_allclose(found.t30[2:], theirs[2:], rtol=0.05)


def test_correlation_of_the_ears(rng):
    """Equal, delayed by 0.5 ms and inverted, delayed by too much, independent; against sums in the time domain."""
    left = rng.normal(size=RATE // 4) * np.sqrt(exponential(0.3, 0.25))
    left[:10] = 0
    rights = [left, -np.roll(left, 8), np.roll(left, 40), rng.normal(size=left.size) * np.sqrt(exponential(0.3, 0.25))]
    ears = jnp.asarray([[left, right] for right in rights], jnp.float32)
    found = jax.jit(iacc, static_argnums=1)(ears, RATE)
    np.testing.assert_allclose(found[:2], 1, atol=2e-3)
    assert np.all(found[2:] < 0.2)
    np.testing.assert_allclose(found, [oracle.correlation(left, right, RATE) for right in rights], atol=1e-3)
    early, late = iacc(ears[3], RATE, 0.0, 0.08), iacc(ears[3], RATE, 0.08)
    first = oracle._first(np.sum(np.asarray(ears[3]) ** 2, axis=0))
    cut = first + round(0.08 * RATE)
    theirs = oracle.correlation(left[first:cut], rights[3][first:cut], RATE)
    assert early == pytest.approx(theirs, abs=1e-3)
    assert late == pytest.approx(oracle.correlation(left[cut:], rights[3][cut:], RATE), abs=1e-3)


def test_lateral_fraction_of_a_diffuse_field_and_of_three_pulses():
    """A third in a diffuse field, whose squared cosine is 1/3 on average; pulses by hand."""
    tail = jnp.asarray(exponential(0.5, 1.0), jnp.float32)
    rate = 6 * np.log(10) / 0.5
    share = (np.exp(-0.005 * rate) - np.exp(-0.08 * rate)) / (1 - np.exp(-0.08 * rate))
    assert lateral_fraction(tail / 3, tail, DT) == pytest.approx(share / 3, rel=1e-3)
    energy = np.zeros((2, 4000), np.float32)
    energy[1, [100, 160, 500, 3000]] = 4, 1, 2, 8  # 0, 3.75, 25 and 181 ms after the direct sound
    energy[0, [100, 160, 500, 3000]] = 0, 1, 1.5, 8
    assert lateral_fraction(*jnp.asarray(energy), DT) == pytest.approx(1.5 / 7)
