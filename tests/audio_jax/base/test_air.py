"""Air against the tables of ISO 9613."""

import numpy as np
import pytest

from home_mjx.audio_jax.base.air import air_absorption, energy_attenuation, speed_of_sound

MIDBANDS = 1000.0 * 10 ** (0.3 * np.arange(-4, 4))  # exact octave midbands 63 .. 8000 Hz


@pytest.mark.parametrize(
    ("temperature", "humidity", "table"),
    [
        (10.0, 70.0, [0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117]),
        (20.0, 70.0, [0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6]),
        (15.0, 20.0, [0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202]),
        (15.0, 50.0, [0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129]),
        (30.0, 70.0, [0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3]),
    ],
)
def test_absorption_equals_iso_9613_2_table_2(temperature, humidity, table):
    """To the rounding of the printed table [dB/km]."""
    ours = 1000 * air_absorption(MIDBANDS, temperature, humidity)
    np.testing.assert_allclose(ours, table, rtol=0.006, atol=0.06)


def test_speed_of_sound():
    assert speed_of_sound(0.0) == 331.3
    assert speed_of_sound(20.0) == pytest.approx(343.2146, abs=1e-4)


def test_energy_attenuation_is_the_same_loss():
    """4.343 m r dB over r metres."""
    loss = air_absorption(np.array([8000.0]))
    remaining = np.exp(-energy_attenuation(loss) * 100)
    np.testing.assert_allclose(10 * np.log10(remaining), -100 * loss)
