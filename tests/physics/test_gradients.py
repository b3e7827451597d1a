"""Gradients of MJX while an agent pushes a box, against difference quotients.

A contact that begins a physics step earlier makes the box's way jump a little, which no derivative sees. So quotients
are taken between actions so near that all contacts begin and end in the same steps.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, PhysicsSetup, Template
from home_mjx.schema import Timing

BOX = Box((0.26, 0.02, 0.15), (0.15, 0.15, 0.15), mass=5)  # a centimetre before the agent, and a little to its left
ACTION = jnp.array([0.6, 0.2, 0.3])
NEAR, FAR = 1e-3, 1e-2  # differences of actions


def pushed(impl: str, seconds: float, iterations: int = PhysicsConfig().iterations):
    """The box's place [m] after a control step, as a function of the action."""
    bank = make_bank([TinyHouse(movable=[BOX])], num_bodies=1)
    config = PhysicsSetup(impl=impl, iterations=iterations, timing=Timing(ctrl_dt=seconds))
    template, house = Template(config, bank.spec), jnp.int32(0)
    start = physics.reset(template, bank, house, jnp.zeros((1, 3)), jnp.zeros(1))
    return lambda action: physics.step(template, bank, house, start, action[None]).qpos[4:7]


def quotients(places, difference: float) -> np.ndarray:
    """Central ones (place, action), of a function of many actions."""
    ways = difference * jnp.eye(3)
    ahead, behind = (np.asarray(places(ACTION + sign * ways), float) for sign in (1, -1))
    return (ahead - behind).T / (2 * difference)


@pytest.fixture(scope="module")
def in_c():
    """The box's places after 0.3 s by C MuJoCo, converged."""
    with jax.default_device(jax.devices("cpu")[0]):
        run = jax.jit(jax.vmap(pushed("c", 0.3)))
        return {difference: quotients(run, difference) for difference in (NEAR, FAR)}


@pytest.mark.slow
def test_forward_gradients_of_pushing_are_slopes_of_c(in_c):
    end = pushed("jax", 0.3)
    place, slope = jax.jit(lambda action: (end(action), jax.jacfwd(end)(action)))(ACTION)
    assert place[0] > BOX.pos[0] + 0.1
    assert slope[0, 0] > 0.1
    assert_allclose(slope, in_c[NEAR], atol=1e-4)


def test_wide_differences_of_c_span_other_contacts(in_c):
    """Why quotients over a hundredth of the action are no slopes, in C no more than in MJX."""
    assert abs(in_c[FAR] - in_c[NEAR])[2, 0] > 0.03


@pytest.mark.slow
def test_reverse_gradients_of_pushing_are_slopes_of_the_same_step():
    """With one iteration MJX has not converged, so its slopes are its own, not those of C."""
    end = pushed("jax", 0.15, iterations=1)

    @jax.jit
    def run(actions):
        """Places, and of each coordinate its gradient, in one program: MJX takes long to compile."""
        place, back = jax.vjp(jax.vmap(end), actions)
        return place, jnp.stack([back(jnp.zeros_like(place).at[:, i].set(1.0))[0] for i in range(3)], axis=1)

    place, slope = run(jnp.tile(ACTION, (3, 1)))
    assert place[0, 0] > BOX.pos[0] + 0.01
    assert slope[0, 0, 0] > 0.01
    assert_allclose(slope[0], quotients(lambda actions: run(actions)[0], NEAR), atol=2e-4)
