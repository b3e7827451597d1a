"""Rows of Toggle: balanced verbs and kinds, starts in the opposite state, success only by `stop` in the right one."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from parted import parted

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, HouseholdEnv
from home_mjx.tasks.language.vocabulary import detokenize
from home_mjx.tasks.suite import Toggle

CONFIG = EnvConfig(
    sensors=("state",), actions="discrete", hands=True, switches="random", physics=PhysicsConfig(impl="kinematic")
)


@pytest.fixture(scope="module")
def env():
    things = [Furniture((1.5, 1.5), (0.4, 0.4, 1.2), category="television")]
    things += [Furniture((-1.5, 1.5), (0.4, 0.4, 0.9), category="sink"), Furniture((0.0, -1.5), mass=3.0)]
    bank = HouseBank.from_compiled([shoebox(furniture=things)])
    return HouseholdEnv(CONFIG, Toggle(num_tasks=8, stop=True, min_length=0.3)).bind(bank)


def texts(env):
    return [detokenize(tokens) for tokens in np.asarray(env.params.tasks.rows.columns["tokens"])]


def test_words_are_balanced(env):
    words = [text.split() for text in texts(env)]
    assert {word[0] for word in words} <= {"turn", "switch"}
    assert sorted((word[1], word[3]) for word in words) == sorted(
        2 * [(state, thing) for state in ("on", "off") for thing in ("television", "sink")]
    )


def test_a_thing_begins_in_the_opposite_state_and_stop_succeeds_in_the_right_one_only(env):
    rows = jnp.arange(8)
    reset, step = parted(env.core, batched=True)
    states = reset(env.params, jax.random.split(jax.random.key(3), 8), None, rows)
    wanted = np.array([text.split()[1] == "on" for text in texts(env)])
    fine = np.array([text.split()[3] for text in texts(env)])
    row = np.where(fine == "television", 0, 1)  # instances are in the order of the furniture
    assert np.array_equal(np.asarray(states.world.switch_on)[rows, row], ~wanted)
    assert not np.asarray(states.task.is_fulfilled_at_start).any()
    stop, turn = (jnp.full(8, env.core.action_names.index(name)) for name in ("stop", "turn_left"))
    assert np.asarray(step(env.params, states, stop).metrics["success"]).tolist() == [0.0] * 8
    right = states.world.switch_on.at[rows, row].set(jnp.asarray(wanted))
    ready = step(env.params, states.replace(world=states.world.replace(switch_on=right)), turn)
    assert np.asarray(ready.task.stage).tolist() == [1] * 8
    assert np.asarray(step(env.params, ready, stop).metrics["success"]).tolist() == [1.0] * 8


def test_wrong_kinds_are_refused_and_states_are_required():
    with pytest.raises(ConfigError, match="kinds"):
        Toggle(kinds=())
    with pytest.raises(ConfigError, match="needs states of lamps and appliances"):
        HouseholdEnv(CONFIG.replace(switches=None), Toggle(stop=True))
