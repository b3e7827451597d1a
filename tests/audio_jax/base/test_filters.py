"""Octave filters."""

import numpy as np

from home_mjx.audio_jax.base.filters import high_pass, octave_gains
from home_mjx.schema.compiled import BANDS

FREQUENCY = np.linspace(0, 24000, 5000)


def test_bands_add_up_to_one_in_amplitude_and_their_roots_in_energy():
    gains = octave_gains(FREQUENCY)
    assert np.all(gains >= 0)
    np.testing.assert_allclose(gains.sum(axis=0), 1, atol=1e-12)
    np.testing.assert_allclose((np.sqrt(gains) ** 2).sum(axis=0), 1, atol=1e-12)


def test_each_band_is_alone_at_its_centre_and_half_at_its_edges():
    np.testing.assert_allclose(octave_gains(np.array(BANDS)), np.eye(7), atol=1e-12)
    edges = octave_gains(np.array(BANDS[:-1]) * np.sqrt(2))
    np.testing.assert_allclose(np.diag(edges[:-1]), 0.5, atol=1e-12)
    np.testing.assert_allclose(np.diag(edges[1:]), 0.5, atol=1e-12)


def test_high_pass_stops_zero_frequency_and_leaves_the_bands():
    assert high_pass(np.array([0.0]))[0] == 0
    assert np.isclose(high_pass(np.array([20.0]))[0] ** 2, 0.5)
    assert np.all(20 * np.log10(high_pass(np.array(BANDS))) > -0.1)
