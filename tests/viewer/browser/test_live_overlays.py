"""Lines of contacts and of sound paths in a room of known walls."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.viewer.browser.live_overlays import LiveLines

SIZE = np.array([6.0, 5.0, 3.0])  # [m], of the room


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([shoebox(tuple(SIZE))])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", ctrl_dt=0.1, clips=("noise",))


@pytest.fixture(scope="module")
def state(env):
    return jax.jit(env.core.reset)(env.params, jax.random.key(0))


def test_reflections_bend_at_walls_by_equal_angles(env, state):
    lines, colours = LiveLines(env).sound_paths(state)
    first, second = np.split(lines.astype(float), 2)
    ears, source = np.asarray(first[0, 0]), np.asarray(state.world.sounds.pos[0], float)
    assert np.allclose(first[:, 0], ears)
    assert np.allclose(second[:, 1], source, atol=1e-4)
    low, high = np.array([-3.0, -2.5, 0.0]), np.array([3.0, 2.5, 3.0])
    bends = first[1:, 1]  # the first path is direct
    assert len(bends) >= 4
    for bend in bends:
        gap = np.minimum(np.abs(bend - low), np.abs(bend - high))
        axis = int(np.argmin(gap))
        assert gap[axis] < 2e-3
        away = np.array([(p - bend) / np.linalg.norm(p - bend) for p in (ears, source)])
        assert abs(away[0, axis]) == pytest.approx(abs(away[1, axis]), abs=2e-3)
    assert len(colours) == len(lines)


def test_a_bar_is_as_long_as_the_force(env, state):
    impulse = jnp.zeros_like(state.physics.contact_impulse).at[0].set(10.0)  # 100 N in a step of 0.1 s
    place = jnp.zeros_like(state.physics.contact_pos).at[0].set(jnp.array([1.0, 0.5, 0.2]))
    touched = state.replace(physics=state.physics.replace(contact_impulse=impulse, contact_pos=place))
    lines, _ = LiveLines(env).contacts(touched)
    assert lines == pytest.approx(np.array([[[1.0, 0.5, 0.2], [1.0, 0.5, 0.4]]]), abs=1e-5)
    assert not len(LiveLines(env).contacts(state)[0])
