"""Sensor noise has the published statistics."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.raycast_render.images.noise import kinect_depth, sensor_rgb, stereo_depth
from home_mjx.raycast_render.lighting.texture import SRGB_TO_LINEAR

SIZE = 200


def noisy(key, *args, **options):
    function = kinect_depth if args[0].dtype == jnp.float32 else sensor_rgb
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(jax.jit(lambda k, *a: function(k, *a, **options))(key, *args))


@pytest.mark.parametrize("distance", [1.0, 2.0, 4.0])
def test_errors_of_depth_grow_with_the_square_of_the_distance(distance):
    image = noisy(jax.random.key(0), jnp.full((SIZE, SIZE, 1), distance, jnp.float32))
    step = distance**2 / 351.3
    # A Gaussian of a sixth of a step, then rounding to whole steps; the distance lies anywhere within its step.
    assert np.std(image) < step * np.hypot(1 / 6, 0.5)
    assert abs(image - distance).max() < 1.3 * step
    disparity = 351.3 / image
    np.testing.assert_allclose(disparity, np.round(disparity), atol=1e-3)


def test_edges_of_depth_are_torn_and_far_readings_are_lost():
    half = jnp.concatenate([jnp.full((SIZE, SIZE // 2, 1), 1.0), jnp.full((SIZE, SIZE // 2, 1), 3.0)], axis=1)
    image = noisy(jax.random.key(1), half)
    swapped = abs(image - half) > 1
    columns = np.nonzero(swapped.any(axis=(0, 2)))[0]
    assert 20 < swapped.sum() < SIZE * 4
    assert abs(columns - SIZE / 2 + 0.5).max() <= 3
    for lost in (0.3, 9.0, np.inf):
        assert np.isinf(noisy(jax.random.key(0), jnp.full((4, 4, 1), lost, jnp.float32))).all()


def test_the_variance_of_colours_grows_with_the_light():
    for value in (60, 128, 200):
        image = noisy(jax.random.key(value), jnp.full((SIZE, SIZE, 3), value, jnp.uint8), shot=0.0005, read=0.00002)
        linear = SRGB_TO_LINEAR[image.astype(int)]
        assert linear.mean() == pytest.approx(SRGB_TO_LINEAR[value], rel=0.01)
        assert linear.var() == pytest.approx(0.0005 * SRGB_TO_LINEAR[value] + 0.00002, rel=0.05)


@pytest.mark.parametrize("distance", [1.0, 2.0, 4.0])
def test_errors_of_stereo_depth_are_those_of_its_disparity(distance):
    """By hand: z^2 / (f b) times the error of a disparity, which is a Gaussian and its rounding to 1/32 px."""
    depth = jnp.full((SIZE, SIZE, 1), distance, jnp.float32)
    image = np.asarray(jax.jit(lambda k: stereo_depth(k, depth, 1.0))(jax.random.key(0)))
    expected = distance**2 / (645 * 0.05) * np.hypot(0.08, 1 / 32 / np.sqrt(12))
    assert np.std(image) == pytest.approx(expected, rel=0.03)
    assert abs(np.mean(image) - distance) < 0.1 * expected + distance * (expected / distance) ** 2 * 2


def test_stereo_depth_has_a_shadow_left_of_near_things_as_wide_as_their_parallax():
    focal = SIZE / 2 / np.tan(0.5)
    scene = np.full((SIZE, SIZE, 1), 4.0, np.float32)
    scene[:, 100:150] = 0.5
    image = np.asarray(jax.jit(lambda k, z: stereo_depth(k, z, 1.0, strength=0.0))(jax.random.key(0), scene))
    lost = np.isinf(image[..., 0])
    width = focal * 0.05 * (1 / 0.5 - 1 / 4)
    assert lost[:, 100:].sum() == 0
    assert (lost.sum(axis=1) == np.floor(width)).all()
    assert lost[0, 100 - int(width) : 100].all()
    np.testing.assert_allclose(image[..., 0][~lost], scene[..., 0][~lost], rtol=0.05)


def test_stereo_depth_has_no_reading_out_of_its_range():
    for lost in (0.2, 11.0, np.inf, np.nan):
        assert np.isinf(stereo_depth(jax.random.key(0), jnp.full((4, 4, 1), lost, jnp.float32), 1.0)).all()
