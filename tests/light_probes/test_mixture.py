"""Weights of light groups: suns that cannot shine are left out of the mixture, and change nothing."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.bank.records.lights import SUN_AZIMUTHS, SUNS
from home_mjx.raycast_render.lighting.probes import Daylight, group_weights
from home_mjx.raycast_render.scene.vec import Vec


@pytest.mark.parametrize(("azimuth", "suns"), [(250.0, {250.0}), (-10.0, {310.0, 10.0}), (100, {70.0, 130.0})])
def test_suns_of_weight_zero_are_left_out(azimuth, suns):
    day = Daylight(sky=2.0, horizon=Vec(1.0, 0.9, 0.8), sun=Vec(3.0, 2.0, 1.0), azimuth=azimuth)
    known = group_weights(day)
    traced = group_weights(day.replace(azimuth=jnp.float32(azimuth)))
    assert set(known) - set(range(SUNS)) == {SUNS + SUN_AZIMUTHS.index(angle) for angle in suns}
    assert len(traced) == SUNS + len(SUN_AZIMUTHS)
    for group, weight in traced.items():
        np.testing.assert_allclose(weight, known.get(group, np.zeros(3)), rtol=1e-5, atol=1e-6)
