"""Rows of FetchFromContainer in a room with a chest of drawers: words, starts in drawers, and success out of them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from chest import home

from home_mjx import HouseBank, physics
from home_mjx.navigation import containers_at
from home_mjx.physics import PhysicsConfig
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.tasks import EnvConfig, HouseholdEnv
from home_mjx.tasks.env.reset import physics_template, put_bodies
from home_mjx.tasks.language.vocabulary import detokenize
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS
from home_mjx.tasks.suite import FetchFromContainer

CONFIG = EnvConfig(sensors=("state",), actions="discrete", hands=True, physics=PhysicsConfig(impl="kinematic"))
TASK = FetchFromContainer(num_tasks=2, stop=True, destinations=("start",), min_length=0.3)


@pytest.fixture(scope="module")
def env():
    house = compile_house(*home(blocked=False), CompileOptions(articulation=ArticulationOptions(8)))
    return HouseholdEnv(CONFIG, TASK).bind(HouseBank.from_compiled([house]))


@pytest.fixture(scope="module")
def states(env):
    keys = jax.random.split(jax.random.key(0), 2)
    return jax.jit(jax.vmap(env.core.reset, (None, 0, None, 0)))(env.params, keys, None, jnp.arange(2))


def test_words_name_the_thing_and_the_furniture_around_it(env):
    tokens = np.asarray(env.params.tasks.rows.columns["tokens"])
    assert {detokenize(row) for row in tokens} == {"bring the kitchenware inside the dresser here"}


def test_the_thing_begins_in_a_shut_drawer(env, states):
    template = physics_template(CONFIG, env.bank.spec)
    for at in range(2):
        data = jax.tree.map(lambda x, at=at: x[at], states.physics)
        angle, pos = physics.door_angle(template, data), physics.body_pose(template, data)[0]
        owner, opening = containers_at(env.bank, jnp.int32(0), angle, pos[:1])
        assert int(owner[0]) >= 0
        assert float(opening[0]) == pytest.approx(0, abs=1e-5)


def test_success_needs_the_thing_in_the_hand_and_out_of_its_drawer(env, states):
    """The agent is at the start all the time: only whether it holds the thing, and where that is, changes."""
    state, template = jax.tree.map(lambda x: x[0], states), physics_template(CONFIG, env.bank.spec)
    update = jax.jit(lambda params, state: env.core.task.update(env.core.snapshot(params, state), state.task))

    def after(state, outside, stops):
        """Stage after the next update with the thing in the hand."""
        data = state.physics.replace(held=jnp.zeros_like(state.physics.held))
        if outside:
            place = physics.agent_pose(template, data)[0][0] + jnp.array([0.4, 0.0, 0.0])
            moved = jnp.ones(1, bool), place[None], env.bank.physics.body_quat[0]
            data = put_bodies(CONFIG, env.bank, data, moved)
        world = state.world.replace(stopped=jnp.full_like(state.world.stopped, stops))
        task = update(env.params, state.replace(physics=data, world=world))
        return state.replace(physics=data, task=task)

    assert int(update(env.params, state).stage) == 0
    held = after(state, outside=False, stops=False)
    assert int(held.task.stage) == 1
    assert int(after(held, outside=False, stops=True).task.stage) == FAILURE
    assert int(after(held, outside=True, stops=True).task.stage) == SUCCESS


def test_houses_without_fronts_have_no_rows():
    bank = HouseBank.from_compiled([compile_house(*home(blocked=False))])
    with pytest.raises(ValueError, match="needs furniture that opens"):
        HouseholdEnv(CONFIG, TASK).bind(bank)
