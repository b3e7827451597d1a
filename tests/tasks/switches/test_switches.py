"""States of lamps and appliances: light, sound, toggling by pointing, resets and files, against oracles by hand."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from lit_scenes import table

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig
from home_mjx.raycast_render.lighting.lights import place_lights
from home_mjx.schema.categories import fine_index
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import EnvConfig, HouseholdEnv
from home_mjx.tasks.env.state_io import load_states, save_states
from home_mjx.tasks.switches.states import OFF, ON, object_states

LAMP, RADIO = SWITCH_KINDS.index("lamp"), SWITCH_KINDS.index("radio")
INTENSITIES = (1.0, 3.0)  # of the lamps [W/sr]
CONFIG = EnvConfig(
    sensors=("state", "nearby_switches"),
    actions="discrete",
    hands=True,
    switches="initial",
    max_aim_angle=10.0,
    physics=PhysicsConfig(impl="kinematic"),
)


def furnished():
    """A room with two boxes that carry lamps, a loudspeaker, and a stool: instances 1 to 4."""
    house = shoebox(
        furniture=[
            Furniture((1.5, 1.5), (0.3, 0.3, 1.2)),
            Furniture((-1.5, 1.5), (0.3, 0.3, 1.2)),
            Furniture((1.5, -1.5), (0.4, 0.4, 1.2), category="loudspeaker"),
            Furniture((-1.5, -1.5), (0.4, 0.4, 0.5), mass=3.0),
        ]
    )
    rows = house.semantics.copy()
    rows[house.instances.semantic[3], Semantic.FINE] = fine_index("loudspeaker")
    lamps = table(*({"instance": 1 + i, "intensity": (x,) * 3, "pos": (0, 0, 0.5)} for i, x in enumerate(INTENSITIES)))
    return HouseBank.from_compiled([replace(house, lights=lamps, semantics=rows)])


@pytest.fixture(scope="module")
def bank():
    return furnished()


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(CONFIG).bind(bank)


@pytest.fixture(scope="module")
def state(env):
    return jax.jit(env.reset)(jax.random.key(0))


def with_states(env, state, *on):
    """The state with these rows on, of two lamps and the loudspeaker."""
    rows = jnp.zeros_like(state.world.switch_on).at[: len(on)].set(jnp.array(on, bool))
    return state.replace(world=state.world.replace(switch_on=rows))


def test_the_table_has_lamps_and_appliances_of_the_house_and_nothing_else(bank):
    kinds = np.asarray(bank.switches.kind[0])
    assert np.asarray(bank.switches.instance[0])[:4].tolist() == [1, 2, 3, -1]
    assert kinds[:4].tolist() == [LAMP, LAMP, RADIO, -1]
    assert np.asarray(bank.switches.of_light[0])[:3].tolist() == [0, 1, -1]


def test_initial_states_are_lamps_on_and_appliances_off(bank, state):
    assert np.asarray(state.world.switch_on)[:4].tolist() == [True, True, False, False]
    words = object_states(bank, jnp.int32(0), state.world.switch_on)
    assert np.asarray(words)[:5].tolist() == [-1, ON, ON, OFF, -1]


@pytest.mark.parametrize("on", [(1, 1, 0), (0, 1, 0), (1, 0, 1), (0, 0, 0)])
def test_light_is_that_of_the_lamps_that_are_on(env, state, on):
    scene = env.core.snapshot(env.params, with_states(env, state, *on)).scene
    placed = place_lights(scene, 0.0)
    expected = [x * lit for x, lit in zip(INTENSITIES, on[:2], strict=True)]
    np.testing.assert_allclose(np.asarray(placed.intensity.x)[:2], expected)
    share = sum(expected) / sum(INTENSITIES)  # isotropic lamps: flux is proportional to intensity
    np.testing.assert_allclose(np.asarray(scene.appearance.lamps)[:2], share, rtol=1e-6)
    assert (np.asarray(scene.appearance.glow)[1:5] > 0).tolist() == [bool(x) for x in (*on, 0)]


def test_a_loudspeaker_sounds_at_its_place_only_while_it_is_on(env, state):
    step = jax.jit(env.step)
    turn = env.core.action_names.index("turn_left")
    off, on = (step(with_states(env, state, 0, 0, x), turn).world.sounds for x in (0, 1))
    assert np.asarray(off.clip).tolist() == [CLIPS.index("radio"), -1, -1, -1, -1]
    assert np.asarray(on.clip).tolist() == [CLIPS.index("radio"), CLIPS.index("radio"), -1, -1, -1]
    np.testing.assert_allclose(np.asarray(on.pos[1]), (1.5, -1.5, 0.6), atol=1e-5)
    assert int(on.body[1]) == int(env.bank.geometry.instance_object[0, 3])


def facing(env, state, distance):
    """The state with the agent before the first lamp, its eyes level."""
    pos = state.physics.qpos.at[:2].set(jnp.array([1.5 - 0.15 - distance, 1.5]))
    return state.replace(
        physics=state.physics.replace(qpos=pos.at[3].set(0.0)), world=state.world.replace(pitch=-0.4 * jnp.ones(1))
    )


def test_toggle_reverses_what_is_pointed_at_within_reach_and_nothing_else(env, state):
    step, toggle = jax.jit(env.step), env.core.action_names.index("toggle")
    near, far = facing(env, state, 0.6), facing(env, state, 1.6)
    once = step(near, toggle)
    assert np.asarray(once.world.switch_on)[:3].tolist() == [False, True, False]
    assert np.asarray(step(once, toggle).world.switch_on)[:3].tolist() == [True, True, False]
    assert np.asarray(step(far, toggle).world.switch_on)[:3].tolist() == [True, True, False]


def test_continuous_actions_switch_on_and_off_by_sign(bank, state):
    env = HouseholdEnv(CONFIG.replace(actions="continuous")).bind(bank)
    column = env.core.action_names.index("toggle")
    step = jax.jit(env.step)
    near = facing(env, jax.jit(env.reset)(jax.random.key(0)), 0.6)
    idle = jnp.zeros(len(env.core.action_names))
    lit = [bool(step(near, idle.at[column].set(x)).world.switch_on[0]) for x in (1.0, 0.4, -0.4, -1.0)]
    assert lit == [True, True, True, False]


def test_the_sensor_has_the_nearest_things_in_the_frame_of_the_agent(env, state):
    near = env.observe(facing(env, state, 0.6)).obs["nearby_switches"]
    first = np.asarray(near)[0]
    assert first[:2] == pytest.approx((0.75, 0.0), abs=1e-5)
    assert first[3:].tolist() == [LAMP, 1.0]
    assert np.asarray(near)[3:, 3].tolist() == [-1.0] * 5


def test_random_states_differ_by_key_and_survive_a_file(bank, tmp_path):
    env = HouseholdEnv(CONFIG.replace(switches="random")).bind(bank)
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(1), 32))
    on = np.asarray(states.world.switch_on)[:, :3]
    assert 0 < on.mean(axis=0).min() <= on.mean(axis=0).max() < 1
    assert len(np.unique(on, axis=0)) > 4
    save_states(tmp_path / "states.npz", states, env)
    assert np.array_equal(np.asarray(load_states(tmp_path / "states.npz", env).world.switch_on)[:, :3], on)


def test_without_the_option_nothing_has_states(bank):
    env = HouseholdEnv(CONFIG.replace(switches=None, sensors=("state",))).bind(bank)
    state = env.reset(jax.random.key(0))
    assert state.world.switch_on is None
    assert "toggle" not in env.core.action_names
    assert state.world.sounds.clip.shape == (1,)
    assert env.core.snapshot(env.params, state).scene.appearance is None


def test_wrong_options_are_refused():
    with pytest.raises(ConfigError, match="switches"):
        EnvConfig(switches="dimmed")
    with pytest.raises(ConfigError, match="nearby_switches"):
        HouseholdEnv(EnvConfig(sensors=("nearby_switches",)))
    with pytest.raises(ConfigError, match="no house has anything to switch"):
        HouseholdEnv(CONFIG).bind(HouseBank.from_compiled([shoebox()])).reset(jax.random.key(0))
