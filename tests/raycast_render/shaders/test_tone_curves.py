"""The tone curve AgX: its published values and what it does to colours."""

import jax.numpy as jnp
import numpy as np
import pytest
from lit_scenes import NIGHT, lit_bank, scene_of

from home_mjx.errors import ConfigError
from home_mjx.raycast_render.lighting.tone_curves import agx
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.lit import LitShader

# Display values of greys by the polynomial of B. Wrensch's "Minimal AgX implementation", from 0.18 by factors of 4.
PUBLISHED = {0.18 / 64: 0.0339, 0.18 / 16: 0.107, 0.18 / 4: 0.2657, 0.18: 0.4967, 0.72: 0.7375, 2.88: 0.909}


def shown(rows, exposure=1.0):
    return np.asarray(agx(Vec.unpack(jnp.asarray(rows, jnp.float32)), exposure).pack())


def test_greys_are_shown_as_published():
    greys = shown(np.array(list(PUBLISHED))[:, None] * np.ones(3))
    np.testing.assert_allclose(greys, greys[:, :1] * np.ones(3), atol=1e-6)
    np.testing.assert_allclose(greys[:, 0] ** (1 / 2.2), list(PUBLISHED.values()), atol=0.008)


def test_order_and_ends_are_kept_and_exposure_is_a_factor(rng):
    light = np.geomspace(1e-5, 1e3, 300)[:, None] * np.ones(3)
    assert (np.diff(shown(light)[:, 0]) >= 0).all()
    assert shown([[0.0, 0.0, 0.0]]).max() < 1e-3
    assert shown([[1e3, 1e3, 1e3]]).min() > 0.99
    colors = rng.uniform(0, 4, (20, 3))
    np.testing.assert_allclose(shown(colors, 2.0), shown(2 * colors), rtol=1e-5)


def test_bright_colours_fade_to_white_and_dark_ones_keep_their_hue():
    red = np.array([1.0, 0.05, 0.02])
    levels = shown(np.geomspace(0.1, 300, 12)[:, None] * red)
    saturation = 1 - levels.min(axis=1) / levels.max(axis=1)
    assert (np.diff(saturation) < 1e-3).all()
    assert saturation[0] > 0.7
    assert saturation[-1] < 0.2


def test_light_that_is_no_number_is_shown_all_the_same():
    assert np.isfinite(shown([[np.nan, np.inf, -np.inf], [np.inf, np.inf, np.inf]])).all()


def test_curves_are_options_of_the_shader():
    light = Vec.unpack(jnp.array([[0.3, 0.2, 0.1]], jnp.float32))
    given = LitShader(sun=0.0, tone_curve="agx", exposure=2.0).display(scene_of(lit_bank({})), light)
    np.testing.assert_allclose(given.pack(), shown(light.pack(), 2.0), rtol=1e-6)
    assert NIGHT.tone_curve == "reinhard"
    with pytest.raises(ConfigError, match="reinhard"):
        LitShader(tone_curve="reinhart")
