"""Sun and sky by the time of day, beside what is known of the sun."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.raycast_render.lighting.sun_and_sky import sky_share, sun_position, sun_redness, sun_share
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.lit import LitShader


def test_the_sun_is_due_south_at_noon_as_high_as_latitude_and_declination_say():
    for latitude, declination in ((48.0, 0.0), (48.0, 23.44), (0.0, -10.0), (60.0, -23.44)):
        azimuth, elevation = sun_position(12.0, latitude, declination)
        assert elevation == pytest.approx(90 - abs(latitude - declination))
        assert azimuth == pytest.approx(270.0)  # -y


def test_the_sun_rises_in_the_east_at_the_equinox_and_day_and_night_are_equal():
    azimuth, elevation = sun_position(6.0, 48.0, 0.0)
    assert elevation == pytest.approx(0.0, abs=1e-9)
    assert np.cos(np.deg2rad(azimuth)) == pytest.approx(1.0)
    assert sun_position(18.0, 48.0, 0.0)[0] == pytest.approx(180.0)
    up = [sun_position(hour, 48.0, 0.0)[1] > 0 for hour in np.arange(0.05, 24, 0.1)]
    assert np.mean(up) == pytest.approx(0.5, abs=0.01)


def test_positions_follow_a_unit_vector_that_turns_about_the_pole():
    """The direction to the sun, rotated by hand about the axis of the earth."""
    latitude, declination = np.deg2rad(48.0), np.deg2rad(12.0)
    pole = np.array([0.0, np.cos(latitude), np.sin(latitude)])
    noon = np.array([0.0, -np.sin(latitude), np.cos(latitude)]) * np.cos(declination) + pole * np.sin(declination)
    for hour in (5.5, 9.0, 14.25, 20.0):
        turn = -np.deg2rad(15 * (hour - 12))
        along = pole * (pole @ noon)
        sun = along + (noon - along) * np.cos(turn) + np.cross(pole, noon) * np.sin(turn)
        azimuth, elevation = (np.deg2rad(angle) for angle in sun_position(hour))
        found = [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
        np.testing.assert_allclose(found, sun, atol=1e-9)


def test_light_is_that_of_the_defaults_at_their_elevation_and_less_when_the_sun_is_low():
    assert sun_share(35.0) == pytest.approx(1.0, abs=5e-3)
    assert sky_share(35.0) == pytest.approx(1.0)
    heights = np.linspace(-20, 60, 81)
    for share in (sun_share, sky_share):
        assert (np.diff([share(float(h)) for h in heights]) >= 0).all()
    assert sun_share(-1.0) == 0
    assert sky_share(-9.0) == pytest.approx(sky_share(0.0) / 100)
    assert (sun_redness(0.0), sun_redness(35.0)) == (1.0, 0.0)


def test_presets_of_hours():
    noon, dusk, night = LitShader.from_hour(12), LitShader.from_hour(18.5, num_lights=2), LitShader.from_hour(0)
    assert noon.sun > dusk.sun > night.sun == 0
    assert noon.sky > dusk.sky > night.sky > 0
    assert dusk.num_lights == 2
    assert LitShader.from_hour(12, sky=0.5).sky == 0.5
    for hour in (-1, 25, float("nan"), True):
        with pytest.raises(ConfigError, match="hour"):
            LitShader.from_hour(hour)


def test_the_horizon_is_red_at_dusk_and_as_ever_by_day():
    ahead = Vec(jnp.float32(1), jnp.float32(0), jnp.float32(0))
    red, _, blue = np.asarray(lit.sky_radiance(ahead, LitShader.from_hour(18.8)).pack())
    assert red > 2 * blue
    np.testing.assert_allclose(
        lit.sky_radiance(ahead, LitShader()).pack(), np.multiply(lit.HORIZON_COLOR, LitShader.sky), rtol=1e-6
    )
