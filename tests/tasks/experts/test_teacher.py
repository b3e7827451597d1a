"""The expert as an observation: what it says is what `expert_action` says, and following it succeeds."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import AutoReset, EnvConfig, ExpertObservationEnv, Task, add_expert, expert_action
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.experts.path_follower import should_wait, to_actions, without_small_turns
from home_mjx.tasks.rules.enums import NUM_DESCRIPTORS, SUCCESS, Feature
from home_mjx.tasks.rules.packing import pack_program
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.training.evaluation import evaluate, expert_policy, random_policy


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make("RoomNav-v0", generated_bank, sensors=("state",), num_tasks=8, impl="kinematic")


def test_it_is_the_action_for_each_state_also_after_automatic_resets(env):
    taught = add_expert(env)
    assert add_expert(taught) is taught
    spec = taught.observation_spec["expert"]
    assert (spec.shape, spec.dtype) == (env.action_spec.shape, env.action_spec.dtype)
    batch = AutoReset(taught.core)
    states = jax.jit(batch.reset)(env.params, jax.random.split(jax.random.key(0), 4))
    step = jax.jit(batch.step)

    def both(params, state):
        """As it would be asked, and by one that looks at everything anew instead of what the task has looked at."""
        snapshot = taught.core.snapshot(params, state)
        return tuple(expert_action(snapshot, task)[0] for task in (state.task, state.task.replace(features=None)))

    own = jax.jit(jax.vmap(both, (None, 0)))
    ended = 0
    for _ in range(80):
        told, anew = own(env.params, states)
        np.testing.assert_array_equal(states.obs["expert"], told)
        np.testing.assert_array_equal(told, anew)
        states = step(env.params, states, states.obs["expert"])
        ended += int(states.done.sum())
    assert ended >= 1
    assert np.array_equal(states.obs["state"].shape, (4, *env.observation_spec["state"].shape))


@pytest.mark.parametrize("looks_first", [False, True])
def test_a_view_is_made_level_before_walking_if_that_comes_first(looks_first: bool):
    """Six agents: 0.5 rad too low or level, straight ahead or to turn by 0.5 rad; the last two hold, or stop."""
    config = EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(num_agents=6))
    error, tilt = jnp.array([0.0, 0.5, 0.0, 0.5, 0.5, 0.0]), jnp.array([0.5, 0.5, 0.0, 0.0, 0.5, 0.5])
    hold, stop = jnp.arange(6) == 4, jnp.arange(6) == 5
    chosen = to_actions(config, error, tilt, hold, stop, looks_first)
    names = [config.action_names[i] for i in chosen.tolist()]
    first = ["look_up", "look_up"] if looks_first else ["move_forward", "turn_left"]
    assert names == [*first, "move_forward", "turn_left", "turn_left", "stop"]


def test_nobody_else_pays_for_what_an_expert_looks_at(env):
    looked = [jax.eval_shape(each.reset, jax.random.key(0)).task.features for each in (env, add_expert(env))]
    assert looked[0] is None
    assert jax.tree.leaves(looked[1])


def test_who_is_asked_for_time_in_a_place_waits_there_until_it_is_over(env):
    begun = jax.jit(lambda key: env.core.reset(env.params, key, None, 0, observe=False))(jax.random.key(0)).task
    inside, long = Condition(Feature.INSIDE, 0, minimum=1), Condition(Feature.TIME, minimum=80)
    columns = pack_program([Selector.rooms(room_type=0)], [TaskStage((Transition(SUCCESS, (inside, long)),), guide=0)])
    state = begun.replace(program=begun.program.replace(**{name: jnp.asarray(x) for name, x in columns.items()}))
    away = jnp.zeros((len(Feature), 1, NUM_DESCRIPTORS, NUM_DESCRIPTORS))
    there = away.at[Feature.INSIDE].set(1.0)
    waits = [bool(should_wait(state, values)[0]) for values in (away, there, there.at[Feature.TIME].set(80.0))]
    assert waits == [False, True, False]


def test_nothing_else_changes(env):
    taught = add_expert(env)
    plain = {name: spec for name, spec in taught.observation_spec.items() if name != "expert"}
    assert plain == env.observation_spec
    assert dataclasses.replace(taught.core.task, store_features=False) == env.core.task


def test_a_task_without_an_expert_is_refused(env):
    with pytest.raises(ConfigError, match="no expert is known for Task"):
        jax.eval_shape(
            ExpertObservationEnv(home_mjx.HouseholdEnv(env.config, Task())).reset, env.params, jax.random.key(0)
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", [{}, {"actions": "discrete", "stop": True, "success_distance": 0.2}], ids=["continuous", "Habitat's"]
)
def test_an_expert_finds_points(generated_bank, options: dict):
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("goal",), impl="kinematic", **options)
    found = evaluate(add_expert(env), expert_policy, num_episodes=64)
    chance = evaluate(env, random_policy(env.core), num_episodes=16)
    assert found["success"].mean() >= 0.95
    assert found["spl"][found["success"] > 0].mean() >= 0.9
    assert chance["success"].mean() < 0.5


def test_teachers_begin_no_small_turn_and_finish_those_that_they_have_begun():
    """One turn is 10 degrees; below 15 none begins."""
    config = EnvConfig(actions="discrete")
    left, right, rest = (np.eye(len(action_names(config)))[config.action_names.index(name)] for name in
                         ("turn_left", "turn_right", "move_forward"))  # fmt: skip
    last = jnp.array([rest, left, right, rest, right, left, rest, rest], jnp.float32)
    asked = jnp.deg2rad(jnp.array([12.0, 12, 12, -12, -12, -12, 16, -16]))
    kept = jnp.deg2rad(jnp.array([0.0, 12, 0, 0, -12, 0, 16, -16]))
    np.testing.assert_allclose(without_small_turns(config, last, asked), kept)
