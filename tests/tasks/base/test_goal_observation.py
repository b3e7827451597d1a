"""The observation `goal`: where a goal point is from an agent, and how far up or down."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import homes_bank
from whole_episodes import begun

import home_mjx
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, HouseholdEnv, sample_episodes
from home_mjx.tasks.rules.enums import TargetKind
from home_mjx.tasks.suite import HouseTasks, PointGoals, RoomNav

TOLERANCE = 0.02  # [m], of feet on floors


@pytest.fixture(scope="module")
def bank():
    return homes_bank(("straight", "to and fro"))


def relative(feet, yaw, goal):
    """Plan distance, cosine and sine of the bearing, height above the feet, with NumPy."""
    x, y, z = (goal - feet).T
    bearing = np.arctan2(y, x) - yaw
    return np.stack([np.hypot(x, y), np.cos(bearing), np.sin(bearing), z], axis=-1)


def test_point_nav_says_how_far_up_or_down_the_goal_is(bank):
    episodes = sample_episodes(bank, 64)
    env = home_mjx.make("PointNav-v0", bank, sensors=("goal",), impl="kinematic").with_tasks(episodes)
    assert env.observation_spec["goal"].shape == (4,)
    low, high = env.observation_spec["goal"].bounds()
    seen = np.asarray(begun(env).obs["goal"])
    goals = np.asarray(bank.navigation.goal)[np.asarray(episodes.house), np.asarray(episodes.columns["goal"])]
    start = np.asarray(episodes.start)
    np.testing.assert_allclose(seen, relative(start, np.asarray(episodes.yaw), goals), atol=TOLERANCE)
    assert (seen >= low).all()
    assert (seen <= high).all()
    rise = np.round(seen[:, 3] / 2.8).astype(int)  # in storeys
    assert {-2, -1, 0, 1, 2} <= set(rise.tolist())


def test_several_agents_each_have_their_own_height(bank):
    env = home_mjx.make("PointNav-v0", bank, sensors=("goal", "state"), impl="kinematic", num_agents=2)
    state = jax.jit(env.reset)(jax.random.key(3))
    goal = np.asarray(bank.navigation.goal)[int(state.world.house), int(state.task.goal)]
    feet = np.asarray(state.obs["state"])[:, 2] - env.config.body.height / 2
    assert state.obs["goal"].shape == (2, 4)
    np.testing.assert_allclose(np.asarray(state.obs["goal"])[:, 3], goal[2] - feet, atol=1e-5)


def test_rows_to_points_observe_the_same_and_other_goals_nothing(bank):
    task = HouseTasks(tasks=(PointGoals(), RoomNav()), num_tasks=24)
    config = EnvConfig(sensors=("goal",), physics=PhysicsConfig(impl="kinematic"))
    env = HouseholdEnv(config, task).bind(bank)
    rows = env.params.tasks.rows
    seen, point = np.asarray(begun(env).obs["goal"]), np.asarray(rows.columns["place"])[:, 0]
    is_point = np.asarray(rows.columns["descriptor"])[:, 0, 0] == TargetKind.PLACE
    assert env.observation_spec["goal"].shape == (4,)
    wanted = relative(np.asarray(rows.start)[is_point], np.asarray(rows.yaw)[is_point], point[is_point])
    np.testing.assert_allclose(seen[is_point], wanted, atol=TOLERANCE)
    assert (abs(seen[is_point, 3]) > 2).any()
    assert is_point.any()
    assert not is_point.all()
    np.testing.assert_array_equal(seen[~is_point], 0)


def test_on_stairs_the_height_falls_by_what_is_climbed(bank):
    """A body on a ramp: the fourth number is that of its feet, whatever the storey."""
    env = home_mjx.make("PointNav-v0", bank, sensors=("goal", "state"), impl="kinematic")
    ramps = np.asarray(bank.physics.ramp)[0]
    ramp = ramps[np.argmax(ramps[:, 4] * np.abs(ramps[:, 7]))]
    up = np.linspace(-0.8, 0.8, 9)[:, None] * ramp[4] * np.sign(ramp[7])
    feet = np.concatenate([ramp[:2] + up * ramp[2:4], ramp[6] + up * ramp[7]], axis=1)
    begin = jax.jit(env.core.reset)(env.params, jax.random.key(0), jnp.int32(0))
    half = env.config.body.height / 2

    def look(place):
        qpos = begin.physics.qpos.at[:3].set(place + jnp.array([0.0, 0.0, half]))
        return env.core.observe(env.params, begin.replace(physics=begin.physics.replace(qpos=qpos))).obs["goal"]

    seen = np.asarray(jax.jit(jax.vmap(look))(jnp.asarray(feet, jnp.float32)))
    np.testing.assert_allclose(np.diff(seen[:, 3]), -np.diff(feet[:, 2]), atol=1e-4)
