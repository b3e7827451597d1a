"""Agents that a task keeps for itself: inside they are like all others, outwardly they are not there."""

import dataclasses
import io

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from parted import parted

from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig
from home_mjx.schema.agent import AgentBody
from home_mjx.tasks import AutoReset, EnvParams, ExpertObservationEnv, HouseholdEnv, make_config
from home_mjx.tasks.suite import PointNav
from home_mjx.viewer.episodes.keyboard import KeyboardPlayer

AGENTS, STEPS, LED = 3, 4, (0.7, 0.0, 0.5, 0.1)
KEY = jax.ShapeDtypeStruct((2,), np.uint32)
STOP, FORWARD = 0, 1
BODIES = (AgentBody(), AgentBody(eye_height=1.2), AgentBody(turn_rate=1.0))
CHEAP = ("state", "gps_compass", "prev_action", "prev_reward", "goal")
COSTLY = ("depth", "audio")


@dataclasses.dataclass(frozen=True)
class Kept(PointNav):
    """So many agents are the caller's; the task leads the others in circles."""

    acting: int = AGENTS

    @property
    def num_acting(self):
        return self.acting

    def control_agents(self, snapshot, state):
        agents = snapshot.stopped.shape[0]
        walks = jnp.tile(jnp.array(LED), (agents, 1)) if snapshot.config.discrete is None else jnp.full(agents, FORWARD)
        return jnp.arange(agents) >= self.acting, walks


@dataclasses.dataclass(frozen=True)
class EverybodyActs(PointNav):
    """It says so."""

    @property
    def num_acting(self):
        return 2


def core_of(acting, sensors=CHEAP, **options):
    physics = PhysicsConfig(impl="kinematic", num_agents=AGENTS, bodies=BODIES)
    sound = {"late": "traced", "num_rays": 16, "num_bounces": 2, "num_edges": 0}
    options = {"width": 8, "height": 8, **sound, **options}
    return HouseholdEnv(make_config(sensors=sensors, physics=physics, **options), Kept(acting=acting))


def played(core, bank, actions):
    """The state after a reset and after each step."""
    params = EnvParams(bank)
    reset, step = parted(core)
    states = [reset(params, jax.random.key(3))]
    for action in actions:
        states.append(step(params, states[-1], action))
    return states


@pytest.mark.parametrize(("acting", "sensors"), [(1, (*CHEAP, *COSTLY)), (2, CHEAP)])
def test_it_is_as_if_the_caller_led_everybody_and_looked_at_the_first(generated_bank, acting, sensors):
    """The others' actions told by the caller, in an environment in which all agents act."""
    told = np.random.default_rng(0).uniform(-1, 1, (STEPS, AGENTS, 4)).astype(np.float32)
    told[:, acting:] = LED
    own, all_act = core_of(acting, sensors), core_of(AGENTS, sensors)
    first = (lambda x: x[0]) if acting == 1 else (lambda x: x[:acting])
    some = played(own, generated_bank, told[:, 0] if acting == 1 else told[:, :acting])
    everybody = played(all_act, generated_bank, told)
    for ours, theirs in zip(some, everybody, strict=True):
        assert {name: x.shape for name, x in ours.obs.items()} == {
            name: spec.shape for name, spec in own.observation_spec.items()
        }
        for a, b in ((ours.obs, first_of(theirs.obs, first)), (ours.reward, first(theirs.reward))):
            jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, atol=1e-5), a, b)
        for name in ("physics", "task", "metrics"):
            same = getattr(ours, name), getattr(theirs, name)
            jax.tree.map(lambda x, y: np.testing.assert_allclose(x, y, atol=1e-5), *same)
        np.testing.assert_allclose(ours.world.reward, theirs.world.reward, atol=1e-6)
    gone = np.ptp([state.obs["gps"] for state in everybody], axis=0)[:, :2].max(axis=1)
    assert (gone > 0.01).all()


def first_of(obs, first):
    return {name: first(x) for name, x in obs.items()}


def test_sensors_remember_no_more_than_the_agents_that_act(generated_bank):
    def memory(acting):
        state = jax.eval_shape(core_of(acting, ("audio", "gps_compass")).reset, EnvParams(generated_bank), KEY)
        return state.world.sensor_states

    one, three = memory(1), memory(AGENTS)
    sizes = [{x.shape for x in jax.tree.leaves(memory["audio"].response)} for memory in (one, three)]
    assert sizes[0] == {(1, *shape[1:]) for shape in sizes[1]}
    assert three["gps_compass"].pos.shape == (AGENTS, 3)
    assert one["gps_compass"].pos.shape == (1, 3)


def test_a_task_that_keeps_nobody_is_the_same_program(generated_bank):
    """Whether it says so, or says nothing; neither options nor snapshots are made anew."""
    config, params = make_config(sensors=(*CHEAP, "depth"), num_agents=2, width=8, height=8), EnvParams(generated_bank)
    cores = HouseholdEnv(config, PointNav()), HouseholdEnv(config, EverybodyActs())
    states = [jax.eval_shape(core.reset, params, KEY) for core in cores]
    action = jnp.zeros((2, 4))
    lowered = [jax.jit(core.step).lower(params, state, action) for core, state in zip(cores, states, strict=True)]
    programs = [program.as_text() for program in lowered]
    assert programs[0] == programs[1]
    assert cores[0].acting_config is cores[0].config

    def snapshots(params, state):
        snapshot = cores[0].snapshot(params, state)
        assert snapshot.select_agents(2) is snapshot
        return snapshot.select_agents(1).pose

    assert jax.eval_shape(snapshots, params, states[0]).pos.shape == (1, 3)


def test_what_is_handed_on_is_of_the_agents_that_act(generated_bank):
    """Automatic resets, experts, and a person at the keyboard."""
    core, params, keys = core_of(2), EnvParams(generated_bank), jax.ShapeDtypeStruct((5, 2), np.uint32)
    batch = AutoReset(core, final_obs="all")
    state = jax.eval_shape(batch.reset, params, keys)
    state = jax.eval_shape(batch.step, params, state, jnp.zeros((5, 2, 4)))
    assert state.reward.shape == (5, 2)
    assert state.info["final_obs"]["state"].shape == (5, 2, 10)
    assert state.world.reward.shape == (5, AGENTS)
    assert batch.bind(params).num_agents == batch.num_agents == 2

    advised = ExpertObservationEnv(core_of(1, actions="discrete"))
    assert advised.observation_spec["expert"].shape == advised.action_spec.shape == ()
    assert jax.eval_shape(advised.reset, params, KEY).obs["expert"].shape == ()
    player = KeyboardPlayer(advised.acting_config, io.StringIO("w"))
    assert player.act(None) == advised.action_names.index("move_forward")


def test_the_episode_ends_when_those_who_act_have_stopped(generated_bank):
    told = np.array([[STOP, FORWARD], [FORWARD, STOP]])
    states = played(core_of(2, ("state",), actions="discrete"), generated_bank, told)
    assert [bool(state.terminated) for state in states] == [False, False, True]
    assert states[-1].world.stopped.tolist() == [True, True, False]


def test_actions_of_all_agents_are_refused(generated_bank):
    core, params = core_of(1), EnvParams(generated_bank)
    state = jax.eval_shape(core.reset, params, KEY)
    with pytest.raises(ConfigError, match=r"expected an action of shape \(4,\), got \(3, 4\)"):
        jax.eval_shape(core.step, params, state, jnp.zeros((AGENTS, 4)))


@pytest.mark.parametrize("number", [0, 4, 1.5, "two", True])
def test_numbers_of_agents_that_there_are_not(number):
    class Wrong(PointNav):
        num_acting = number

    with pytest.raises(ConfigError, match=f"num_acting of Wrong.* at most 3, got {number!r}"):
        HouseholdEnv(make_config(num_agents=AGENTS), Wrong())
