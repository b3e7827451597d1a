"""The spherical head against published values and its own limits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.receivers.spherical_head import (
    ear_angles,
    ear_energy,
    ear_spectrum,
    ear_table,
    sphere_spectrum,
    world_to_head,
)

RADIUS, SPEED, TAPS, RATE = 0.0875, 343.2, 512, 16000
OCTAVES = np.array([500.0, 1000.0, 2000.0, 4000.0, 8000.0])


def ears_at(azimuth: float, frequency: np.ndarray) -> np.ndarray:
    """Near and far ear for a source `azimuth` degrees to one side."""
    return sphere_spectrum(frequency, np.radians([90 - azimuth, 90 + azimuth]), RADIUS, SPEED)


@pytest.mark.parametrize(
    ("azimuth", "ild", "itd"),
    [
        (30, [1.5, 4.9, 4.4, 5.9, 7.9], 397),
        (60, [1.9, 4.3, 10.0, 9.7, 12.9], 680),
        (90, [1.8, 2.9, 3.9, 4.7, 6.1], 781),
    ],
)
def test_level_and_time_differences_of_a_rigid_sphere(azimuth, ild, itd):
    """Level differences per octave [dB] and the phase delay at 250 Hz [µs] of an independent implementation."""
    near, far = ears_at(azimuth, OCTAVES)
    np.testing.assert_allclose(20 * np.log10(np.abs(near / far)), ild, atol=0.06)
    near, far = ears_at(azimuth, np.array([250.0]))
    np.testing.assert_allclose(np.angle(near / far) / (2 * np.pi * 250) * 1e6, itd, atol=1)


def test_low_frequencies_pass_the_head_and_high_ones_double_on_it():
    """|H| -> 1 at 20 Hz everywhere; pressure doubles where a short wave meets the sphere head on."""
    low = sphere_spectrum(np.array([20.0]), np.linspace(0, np.pi, 7), RADIUS, SPEED)
    np.testing.assert_allclose(np.abs(low), 1, atol=0.01)
    high = sphere_spectrum(np.array([15000.0]), np.zeros(1), RADIUS, SPEED)
    np.testing.assert_allclose(np.abs(high), 2, atol=0.06)


def test_table_between_its_entries_equals_the_series():
    """Amplitude and phase, up to 7 kHz, above which the table is limited in band, at angles between the entries."""
    table = ear_table(TAPS, RATE, RADIUS, SPEED)
    angle = np.radians([0.5, 33.5, 89.5, 90.5, 137.5, 171.5])
    frequency = np.fft.rfftfreq(TAPS, 1 / RATE)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        spectrum, delay = ear_spectrum(table, jnp.asarray(angle, jnp.float32))
    ours = np.asarray(spectrum) * np.exp(-2j * np.pi * np.asarray(delay)[:, None] * frequency)
    exact = sphere_spectrum(frequency, angle, RADIUS, SPEED)
    assert np.max(np.abs(ours - exact)[:, frequency <= 7000]) < 0.01


def test_energy_is_the_mean_square_of_the_spectrum():
    table = ear_table(TAPS, RATE, RADIUS, SPEED)
    gains = np.asarray(ear_energy(table, jnp.float32([0.0, np.pi / 2, np.pi])))
    band = np.linspace(3000, 5300, 500)
    exact = np.mean(np.abs(sphere_spectrum(band, np.array([0.0, np.pi / 2, np.pi]), RADIUS, SPEED)) ** 2, axis=1)
    np.testing.assert_allclose(gains[:, 5], exact, rtol=0.03)


@pytest.mark.parametrize(
    ("direction", "nearer"),
    [([-1, 0, 0], "left"), ([1, 0, 0], "right"), ([0, 1, 0], "both"), ([0, 0, -1], "both"), ([-1, 1, -1], "left")],
)
def test_left_is_minus_x_of_the_head(direction, nearer):
    unit = jnp.float32([direction]) / np.linalg.norm(direction)
    left, right = np.asarray(ear_angles(unit, 90.0))[0]
    order = "both" if np.isclose(left, right) else "left" if left < right else "right"
    assert order == nearer


def test_to_head_undoes_the_heads_rotation(rng):
    """Against MuJoCo's quaternions."""
    import mujoco

    quat = rng.normal(size=4)
    quat /= np.linalg.norm(quat)
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quat)
    direction = rng.normal(size=(5, 3))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        ours = world_to_head(jnp.asarray(direction, jnp.float32), jnp.asarray(quat, jnp.float32))
    np.testing.assert_allclose(ours, direction @ matrix.reshape(3, 3), atol=1e-5)
