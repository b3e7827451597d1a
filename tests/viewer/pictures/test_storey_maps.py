"""Maps of sound cover the storey that navigation finds for their source."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import home

from home_mjx import HouseBank
from home_mjx.navigation import cell_below
from home_mjx.viewer.pictures.storey_maps import _receiver_grid


@pytest.mark.parametrize("above", [-0.03, 0.0, 0.03, 1.5])
def test_a_source_is_on_the_storey_of_navigation(above):
    """Up to 5 cm below a floor it is on that floor, as bodies that rest there."""
    bank = HouseBank.from_compiled([home("straight")])
    floor = np.asarray(bank.navigation.floor[0])
    for level, height in enumerate(floor.tolist()):
        source = np.array([6.0, 3.0, height + above], np.float32)
        place = _receiver_grid(bank, source)[2]
        assert int(jax.jit(cell_below)(bank, jnp.int32(0), jnp.asarray(source))[0]) == level
        assert place[0, 0, 2] - height == pytest.approx(1.5, abs=0.2)
