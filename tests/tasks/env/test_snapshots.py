"""One snapshot per instant: the count of builds while functions are traced, and the content of those that are kept."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks import AutoReset, HouseholdEnv, make_config
from home_mjx.tasks.env import reset
from home_mjx.tasks.env.hand_actions import decode_hand_commands
from home_mjx.tasks.suite import PointNav

KEYS = jax.ShapeDtypeStruct((2, 2), np.uint32)


class ControlsAgents(PointNav):
    """A task that may replace actions, but does not."""

    def control_agents(self, snapshot, state):
        return None


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox()])


@pytest.fixture
def builds(monkeypatch):
    """Scenes built since the last clearing; there is one per snapshot."""
    found, make_scene = [], reset.make_scene

    def counted(*args, **options):
        found.append(args)
        return make_scene(*args, **options)

    monkeypatch.setattr(reset, "make_scene", counted)
    return found


def count(builds, function, *args):
    builds.clear()
    out = jax.eval_shape(function, *args)
    return len(builds), out


@pytest.mark.parametrize(
    ("task", "options", "per_step"),
    [
        (PointNav(), {}, 1),
        (PointNav(), {"actions": "discrete"}, 1),
        (PointNav(), {"hands": True}, 2),
        (ControlsAgents(), {}, 2),
        (ControlsAgents(), {"hands": True, "actions": "discrete"}, 2),
    ],
)
def test_snapshots_of_one_environment(bank, builds, task, options, per_step):
    env = HouseholdEnv(make_config(sensors=("state", "depth"), width=4, height=4, **options), task).bind(bank)
    action = jax.ShapeDtypeStruct(env.action_spec.shape, env.action_spec.dtype)
    key = jax.ShapeDtypeStruct((2,), np.uint32)
    num, state = count(builds, env.reset, key)
    assert num == 1
    assert count(builds, env.step, state, action)[0] == per_step
    assert count(builds, env.observe, state)[0] == 1
    assert count(builds, functools.partial(env.core.observe, update=True), env.params, state)[0] == 1
    assert count(builds, functools.partial(env.core.reset, observe=False), env.params, key)[0] == 1
    assert count(builds, functools.partial(env.core.step, observe=False), env.params, state, action)[0] == per_step


@pytest.mark.parametrize(("final_obs", "per_step"), [("none", 3), ("cheap", 3), ("all", 5)])
def test_snapshots_of_automatic_resets(bank, builds, final_obs, per_step):
    """One of the step, one of the reset's branch, one of the observed instant; "all" renders in two more branches."""
    core = HouseholdEnv(make_config(sensors=("state", "depth"), width=4, height=4))
    batch = AutoReset(core, final_obs).bind(bank)
    num, states = count(builds, batch.reset, KEYS)
    assert num == 1
    assert count(builds, batch.step, states, jax.ShapeDtypeStruct((2, 4), np.float32))[0] == per_step


@pytest.fixture(scope="module")
def env(bank):
    options = {"num_agents": 2, "hands": True, "contact_sounds": ContactSoundConfig()}
    return HouseholdEnv(make_config(sensors=("state", "prev_reward"), **options)).bind(bank)


def test_the_snapshot_of_a_step_is_that_of_its_state(env):
    """Reward, sounds and contact sounds are filled in after the tasks have read it. One program: others round anew."""
    core, params = env.core, env.params

    def both(function):
        def run(*args):
            state, snapshot = function(*args)
            return state, snapshot, core.snapshot(params, state)

        return jax.jit(run)

    state, snapshot, again = both(core._init)(params, jax.random.key(0))
    jax.tree.map(np.testing.assert_array_equal, snapshot, again)
    advance = both(core._advance)
    for _ in range(3):
        state, snapshot, again = advance(params, state, jnp.full((2, core.action_size), 0.7))
        jax.tree.map(np.testing.assert_array_equal, snapshot, again)
    assert float(jnp.abs(state.world.reward).max()) > 0


def test_hands_do_not_read_velocities(env):
    """Commands of the snapshot before discrete moves set the agents' speed are those after it."""
    decode = jax.jit(functools.partial(decode_hand_commands, env.config))
    snapshot = jax.jit(env.core.snapshot)(env.params, jax.jit(env.reset)(jax.random.key(0)))
    fast = snapshot.replace(velocity=jnp.full_like(snapshot.velocity, jnp.nan))
    action = jnp.array([[1.0, 0.0, 1.0], [-1.0, 1.0, 0.0]])
    jax.tree.map(np.testing.assert_array_equal, decode(snapshot, action), decode(fast, action))


def test_observing_later_is_observing_at_once(env):
    core, params = env.core, env.params
    observe = jax.jit(functools.partial(core.observe, update=True))
    state = jax.jit(functools.partial(core.reset, observe=False))(params, jax.random.key(0))
    assert not any(np.any(value) for value in state.obs.values())
    whole = jax.jit(core.reset)(params, jax.random.key(0))
    jax.tree.map(np.testing.assert_array_equal, observe(params, state), whole)
    action = jnp.full((2, core.action_size), 0.7)
    blind = jax.jit(functools.partial(core.step, observe=False))(params, whole, action)
    jax.tree.map(np.testing.assert_array_equal, blind.obs, whole.obs)
    twin = jax.jit(core.step)(params, whole, action)
    jax.tree.map(functools.partial(np.testing.assert_allclose, atol=1e-6), observe(params, blind), twin)
