"""Automatic resets: who ends begins anew, everybody is observed once."""

import functools
import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from checked import checked
from handmade import Furniture, shoebox

from home_mjx import AutoReset, HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config

NUM = 5
LENGTH = 3


@pytest.fixture(scope="module")
def core() -> HouseholdEnv:
    options = {
        "sensors": ("depth", "audio", "state", "goal"),
        "width": 8,
        "height": 8,
        "late": "traced",
        "num_rays": 8,
        "num_bounces": 2,
        "num_edges": 0,
    }
    return HouseholdEnv(make_config(episode_length=LENGTH, **options))


@pytest.fixture(scope="module")
def params(core):
    return core.bind(HouseBank.from_compiled([shoebox()])).params


@pytest.fixture(scope="module")
def program(core):
    """A step without automatic resets."""
    return jax.jit(jax.vmap(core.step, (None, 0, 0)))


@pytest.fixture(scope="module")
def plain(program):
    return checked(program)


@pytest.fixture(scope="module")
def lowered(core, params):
    """Last images of up to two environments are rendered alone, of more for the whole batch."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("home_mjx.tasks.env.autoreset.MAX_SEPARATE_RENDERS", 2)
        batch = AutoReset(core, "all")
        shapes = jax.eval_shape(batch.reset, params, keys())
        return batch, jax.jit(batch.step).lower(params, shapes, jnp.zeros((NUM, 4)))


@pytest.fixture(scope="module")
def auto(lowered):
    batch, program = lowered
    return jax.jit(batch.reset), checked(program.compile())


@pytest.fixture(scope="module")
def perceive(core):
    return jax.jit(jax.vmap(functools.partial(core.observe, update=True), (None, 0)))


def keys():
    return jax.random.split(jax.random.key(0), NUM)


def casts(lowered) -> int:
    """Ray casts that a lowered program runs: those of a function count at each call of it."""
    parts = re.split(r"func\.func (?:public |private )?@", lowered.as_text())[1:]
    functions = {part.partition("(")[0]: part for part in parts}

    @functools.cache
    def count(name: str) -> int:
        calls = re.findall(r"(?<!custom_)call @([^(]+)\(", functions[name])
        return functions[name].count("home_mjx_cast") + sum(map(count, calls))

    return count("main")


def test_everybody_is_observed_once(core, params, program, lowered):
    """Programs of a step with and without automatic resets cast the same rays."""
    states = jax.eval_shape(jax.vmap(core.reset, (None, 0)), params, keys())
    once = casts(program.lower(params, states, jnp.zeros((NUM, 4))))
    batch = AutoReset(core, "cheap")
    states = jax.eval_shape(batch.reset, params, keys())
    assert once > 0
    assert casts(jax.jit(batch.step).lower(params, states, jnp.zeros((NUM, 4)))) == once
    assert casts(lowered[1]) == 3 * once  # besides: a few, or the whole batch


@pytest.mark.parametrize("ages", [[0, 2, 1, 2, 0], [2, 2, 1, 2, 2], [0, 1, 0, 1, 0]], ids=["few", "many", "none"])
def test_final_observations_are_those_before_the_reset(params, auto, plain, perceive, ages):
    """Environments that end at different steps; a twin without resets says what each saw and heard last."""
    reset, step = auto
    states = reset(params, keys())
    ages = jnp.array(ages, jnp.int32)
    states = states.replace(world=states.world.replace(step=ages))
    action = jnp.tile(jnp.array([1.0, 0.0, 0.5, 0.0]), (NUM, 1))
    twin, new = plain(params, states, action), step(params, states, action)
    ended = np.asarray(ages) == LENGTH - 1
    np.testing.assert_array_equal(new.done, ended)
    final = new.info["final_obs"]
    assert set(final) == set(twin.obs)
    for name, value in final.items():
        np.testing.assert_allclose(value, twin.obs[name], atol=2e-4, err_msg=name)
        np.testing.assert_array_equal(value[~ended], new.obs[name][~ended])
        differ = np.abs(np.asarray(value - new.obs[name], np.float64)).reshape(NUM, -1).max(axis=1)
        assert (differ[ended] > 1e-3).all(), name
    np.testing.assert_array_equal(new.world.step, np.where(ended, 0, ages + 1))
    np.testing.assert_allclose(new.reward, twin.reward, atol=1e-5)
    # The first frame of an episode does not fade from the last one's response.
    np.testing.assert_array_equal(new.world.sensor_states["audio"].phase[ended], 0)
    again = perceive(params, new)
    np.testing.assert_allclose(again.obs["audio"][ended], new.obs["audio"][ended], atol=1e-6)


def test_cheap_final_observations_leave_out_what_casts_rays(core, params):
    shapes = jax.eval_shape(AutoReset(core).reset, params, keys())
    assert set(shapes.info["final_obs"]) == {"state", "goal"}
    assert "final_obs" not in jax.eval_shape(AutoReset(core, "none").reset, params, keys()).info


def test_observing_again_changes_nothing(core, params, plain):
    observe = jax.jit(jax.vmap(core.observe, (None, 0)))
    states = jax.jit(jax.vmap(core.reset, (None, 0)))(params, keys())
    for _ in range(3):
        states = plain(params, states, jnp.tile(jnp.array([1.0, 0.0, 1.0, 0.0]), (NUM, 1)))
        again = observe(params, observe(params, states))
        same = jax.tree.map(lambda a, b: bool(jnp.all(a == b)), again.replace(obs={}), states.replace(obs={}))
        assert all(jax.tree.leaves(same))
        for name, value in states.obs.items():
            np.testing.assert_allclose(again.obs[name], value, atol=1e-6, err_msg=name)


def test_scratch_space_is_handed_on(core, params):
    state = jax.eval_shape(core.reset, params, jax.random.key(0)).replace(info={"mine": jnp.float32(7)})
    after = jax.eval_shape(core.step, params, state, jnp.zeros(4))
    assert jax.tree.structure(after) == jax.tree.structure(state)


def test_wrong_use_is_refused(core, params):
    env = core.bind(params)
    state = jax.eval_shape(env.reset, jax.random.key(0))
    with pytest.raises(ConfigError, match="Did you mean `cheap`"):
        AutoReset(core, "cheep")
    with pytest.raises(ConfigError, match="batch of random keys"):
        AutoReset(core).bind(params).reset(jax.random.key(0))
    with pytest.raises(ConfigError, match="one random key"):
        env.reset(keys())
    with pytest.raises(ConfigError, match="real numbers"):
        env.step(state, jnp.zeros(4, bool))
    with pytest.raises(ConfigError, match="an action of shape"):
        env.step(state, jnp.zeros((2, 4)))


@pytest.mark.parametrize("impl", ["fused", pytest.param("kinematic", marks=pytest.mark.slow)])
def test_a_new_episode_begins_with_empty_hands_and_everything_in_its_place(impl):
    """Three agents carry a crate when the episode of the second ends: the others notice nothing."""
    crate = Furniture((0.6, 0.0), size=(0.3, 0.3, 1.7), mass=5.0)
    bank = HouseBank.from_compiled([shoebox(furniture=[crate])])
    core = HouseholdEnv(make_config(sensors=("state",), hands=True, episode_length=10, impl=impl))
    batch = AutoReset(core).bind(bank)
    rows = core.template(bank).layout.body_qpos
    begun = jax.jit(batch.reset)(keys()[:3])
    facing = begun.physics.qpos.at[:, :4].set(jnp.array([0.0, 0.0, 0.8, 0.0]))
    states = begun.replace(physics=begun.physics.replace(qpos=facing))
    step, alone = jax.jit(batch.step), jax.jit(jax.vmap(core.step, (None, 0, 0)))
    still, pick = (jnp.zeros((3, core.action_size)).at[:, 4].set(command) for command in (0.0, 1.0))
    for action in (pick, still, still):
        states = step(states, action)
    assert states.physics.held[:, 0].tolist() == [0, 0, 0]
    assert float(jnp.abs(states.physics.qpos[:, rows][:, :3] - bank.physics.body_pos[0, 0]).max(axis=1).min()) > 0.01
    states = states.replace(world=states.world.replace(step=jnp.array([3, 9, 3], jnp.int32)))
    after, twin = step(states, still), alone(batch.params, states, still)
    assert after.truncated.tolist() == [False, True, False]
    assert after.physics.held[:, 0].tolist() == [0, -1, 0]
    others = np.array([0, 2])
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[others], b[others]), after.physics, twin.physics)
    fresh = after.physics.replace(qpos=after.physics.qpos.at[1, :4].set(begun.physics.qpos[1, :4]))
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[1], b[1]), fresh, begun.physics)
    for _ in range(3):
        after = step(after, still)
    np.testing.assert_allclose(after.physics.qpos[1, rows], begun.physics.qpos[1, rows], atol=2e-3)
    assert after.physics.held[:, 0].tolist() == [0, -1, 0]
