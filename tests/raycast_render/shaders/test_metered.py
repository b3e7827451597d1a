"""The exposure that the lit preset chooses for an image."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.raycast_render.lighting.tone_curves import tone_map
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.lit import LitShader, auto_exposure


def shown(light: np.ndarray) -> np.ndarray:
    vec = Vec.unpack(jnp.asarray(light, jnp.float32))
    return np.asarray(tone_map(vec, auto_exposure(vec)).pack())


def test_an_even_image_is_shown_in_middle_grey_however_bright_it_is():
    """By hand: luminance 0.5 becomes 0.5 (1 + 0.5 / 25) / 1.5."""
    for brightness in (0.01, 1.0, 500.0):
        np.testing.assert_allclose(shown(np.full((4, 6, 3), brightness)), 0.34, rtol=1e-4)


def test_images_look_the_same_in_light_of_any_strength(rng):
    light = rng.uniform(0.1, 3.0, (8, 8, 3))
    np.testing.assert_allclose(shown(light), shown(40 * light), rtol=1e-4)
    np.testing.assert_array_equal(shown(np.zeros((4, 4, 3))), 0)  # no light, no picture


def test_the_option_is_a_number_or_none():
    assert LitShader(exposure=None).exposure is None
    assert LitShader().exposure == 2.3  # as before: images of one house can be compared
    with pytest.raises(ConfigError, match="exposure"):
        LitShader(exposure=-1.0)
