"""What hands reach in furniture: nothing that is too thin for the rays that they test."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.tasks.sensors.front_reach import MIN_APPARENT_ANGLE, apparent_size

EYE = np.array([1.0, -2.0, 1.5])


@pytest.mark.parametrize("turn", [0.3, 2.0, 3.1, -2.9])
def test_apparent_size_is_that_of_points_in_the_box(turn, rng):
    """By the directions of many random corners and inner points, also around the seam of angles."""
    center = EYE + np.array([1.2 * np.cos(turn), 1.2 * np.sin(turn), -0.4])
    half = np.array([0.2, 0.05, 0.1])
    box = np.stack([center - half, center + half])
    share = rng.choice([0.0, 0.5, 1.0], size=(2000, 3))
    way = box[0] + share * (box[1] - box[0]) - EYE
    azimuth = np.angle(np.exp(1j * (np.arctan2(way[:, 1], way[:, 0]) - turn)))
    extents = np.ptp(azimuth), np.ptp(np.arctan2(way[:, 2], np.hypot(way[:, 0], way[:, 1])))
    found = apparent_size(jnp.asarray(EYE, jnp.float32), jnp.asarray(box, jnp.float32))
    np.testing.assert_allclose(found, extents, atol=1e-5)


def test_a_plate_is_too_thin_from_the_side_and_not_from_above():
    """It is 2 cm thick, 0.6 m away: 1.9° high in the plane of the eye; from above its depth counts."""
    half = np.array([0.12, 0.12, 0.01])
    for drop, fits in ((0.0, False), (0.6, True)):
        center = EYE + np.array([0.6 + half[0], 0.0, -drop])
        box = jnp.asarray(np.stack([center - half, center + half]), jnp.float32)
        size = np.asarray(apparent_size(jnp.asarray(EYE, jnp.float32), box))
        assert size[0] > MIN_APPARENT_ANGLE
        assert (size[1] >= MIN_APPARENT_ANGLE) == fits
