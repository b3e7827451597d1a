"""Rays in homes of several storeys: below an eye is the floor or ramp of the grid, above it a ceiling."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import HOMES, homes_bank

from home_mjx.audio_jax.base.endpoints import is_indoors
from home_mjx.raycast_render import cast, make_scene

EYE = 1.5  # [m] above the feet
NAMES = tuple(HOMES)


@pytest.mark.parametrize("name", NAMES)
def test_floors_are_below_and_rooms_around_on_every_storey(name):
    bank, house = homes_bank(), jnp.int32(NAMES.index(name))
    bodies = bank.physics.body_pos[house], bank.physics.body_quat[house]
    scene = make_scene(bank, house, *bodies, jnp.zeros((0, 3)), jnp.zeros((0, 4)))
    eyes = bank.navigation.start[house] + jnp.array([0.0, 0.0, EYE])
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0]), eyes.shape)
    hit = jax.jit(cast)(scene, eyes, down)
    np.testing.assert_allclose(hit.t, EYE, atol=0.02)
    up = jax.jit(cast)(scene, eyes, -down)
    assert (np.asarray(up.t) < 6.0).mean() > 0.99  # the opening over stairs shows the ceiling above
    assert jax.jit(jax.vmap(lambda point: is_indoors(scene, point)))(eyes).all()
