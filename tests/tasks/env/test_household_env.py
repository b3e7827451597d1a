"""The environment's contract, on generated houses."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from checked import checked
from handmade import shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.categories import fine_index
from home_mjx.tasks import Status
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.base.state import EnvParams
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.sensors.cameras import agent_ids, render_images

SMALL = {
    "width": 16,
    "height": 16,
    "late": "traced",
    "num_rays": 16,
    "num_bounces": 3,
    "sensors": ("rgb", "depth", "instance", "fine", "audio", "state", "goal"),
}
LITTLE_SOUND = Status.RESPONSE_CUT | Status.UNHEARD  # 16 rays of 3 bounces hardly find the next room
NUM_ENVS = 4


@pytest.fixture(scope="session")
def env(generated_bank: HouseBank) -> Env:
    return home_mjx.make("PointNav-v0", generated_bank, **SMALL)


@pytest.fixture(scope="session")
def reset(env):
    return checked(jax.jit(jax.vmap(env.core.reset, (None, 0, 0))), LITTLE_SOUND)


@pytest.fixture(scope="session")
def traces() -> list[str]:
    """One entry for each time that `step` was traced."""
    return []


@pytest.fixture(scope="session")
def step(env, traces):
    def counted(*args):
        traces.append("step")
        return env.core.step(*args)

    return checked(jax.jit(jax.vmap(counted, (None, 0, 0))), LITTLE_SOUND)


def keys(num: int = NUM_ENVS, seed: int = 0) -> jax.Array:
    return jax.random.key_data(jax.random.split(jax.random.key(seed), num))


def some_actions(num: int = NUM_ENVS, seed: int = 1) -> jax.Array:
    return jax.random.uniform(jax.random.key(seed), (num, 4), jnp.float32, -1, 1)


def houses(env, num: int = NUM_ENVS) -> jax.Array:
    return jnp.arange(num, dtype=jnp.int32) % env.bank.num_houses


def assert_same(a, b):
    jax.tree.map(np.testing.assert_array_equal, a, b)


def test_observations_have_the_promised_shapes_and_ranges(env, reset, step):
    states = reset(env.params, keys(), houses(env))
    for _ in range(3):
        states = step(env.params, states, some_actions())
    obs = states.obs
    shapes = {
        "pixels/head_rgb": ((16, 16, 3), np.uint8),
        "pixels/head_depth": ((16, 16, 1), np.float32),
        "ids/head_instance": ((16, 16), np.int32),
        "ids/head_fine": ((16, 16), np.int32),
        "audio": ((2, 1600), np.float32),
        "state": ((10,), np.float32),
        "goal": ((4,), np.float32),
    }
    assert {k: (v.shape[1:], v.dtype.type) for k, v in obs.items()} == {k: (s, d) for k, (s, d) in shapes.items()}
    assert all(np.isfinite(v).all() for v in obs.values())
    assert (obs["pixels/head_depth"] > 0).all()
    assert (obs["pixels/head_depth"] <= env.config.max_depth).all()
    assert obs["pixels/head_rgb"].std() > 5
    assert np.abs(obs["audio"]).max() > 1e-4
    assert (obs["ids/head_fine"] >= 0).mean() > 0.95  # the houses are closed: rays hit something named


def test_step_keeps_the_structure_of_reset(env):
    state = jax.eval_shape(env.reset, jax.ShapeDtypeStruct((2,), jnp.uint32))
    after = jax.eval_shape(env.step, state, jax.ShapeDtypeStruct((4,), jnp.float32))
    assert jax.tree.structure(state) == jax.tree.structure(after)
    for before, now in zip(jax.tree.leaves(state), jax.tree.leaves(after), strict=True):
        assert (before.shape, before.dtype, before.weak_type) == (now.shape, now.dtype, now.weak_type)


def test_step_is_traced_once_for_all_houses_and_banks(env, other_bank, reset, step, traces):
    positions = []
    for bank in (env.bank, other_bank):
        for house in range(2):
            states = reset(EnvParams(bank), keys(), jnp.full(NUM_ENVS, house, jnp.int32))
            for _ in range(2):
                states = step(EnvParams(bank), states, some_actions())
            positions.append(np.asarray(states.obs["state"][:, :2]))
    assert traces == ["step"]
    assert len(np.unique(np.concatenate(positions), axis=0)) > NUM_ENVS  # they were different houses


def test_same_seed_same_result(env, reset, step):
    runs = []
    for _ in range(2):
        states = reset(env.params, keys(), houses(env))
        for i in range(3):
            states = step(env.params, states, some_actions(seed=i))
        runs.append(states)
    assert_same(*runs)


def test_permuting_the_batch_permutes_the_result_bit_for_bit(env, reset, step):
    order = np.array([2, 0, 3, 1])
    states = reset(env.params, keys(), houses(env))
    permuted = reset(env.params, keys()[order], houses(env)[order])
    for i in range(5):
        actions = some_actions(seed=i)
        states, permuted = step(env.params, states, actions), step(env.params, permuted, actions[order])
    assert_same(jax.tree.map(lambda x: x[order], states), permuted)


def test_neighbours_do_not_matter_bit_for_bit(env, reset, step):
    ours, theirs = keys(), keys(seed=9)
    mixed = jnp.concatenate([ours[:1], theirs[1:]])
    a = reset(env.params, ours, houses(env))
    b = reset(env.params, mixed, houses(env).at[1:].set(0))
    for i in range(5):
        a = step(env.params, a, some_actions(seed=i))
        b = step(env.params, b, some_actions(seed=i).at[1:].multiply(-1))
    assert_same(jax.tree.map(lambda x: x[0], a), jax.tree.map(lambda x: x[0], b))


def test_alone_is_as_in_a_batch(env, reset, step):
    blind = HouseholdEnv(env.config.replace(sensors=("state",)), env.task)
    alone_reset, alone_step = checked(jax.jit(blind.reset)), checked(jax.jit(blind.step))
    states = reset(env.params, keys(), houses(env))
    alone = alone_reset(env.params, keys()[1], houses(env)[1])
    for i in range(20):
        actions = some_actions(seed=i)
        states, alone = step(env.params, states, actions), alone_step(env.params, alone, actions[1])
    np.testing.assert_allclose(states.physics.qpos[1], alone.physics.qpos, atol=1e-4)
    np.testing.assert_allclose(states.obs["state"][1], alone.obs["state"], atol=1e-4)


def test_typed_and_raw_keys_begin_the_same_episode(env):
    typed = jax.jit(functools.partial(env.core.reset, observe=False))(env.params, jax.random.key(3))
    assert_same(typed, jax.jit(functools.partial(env.core.reset, observe=False))(env.params, jax.random.PRNGKey(3)))


def test_resets_choose_different_houses_and_poses(env, reset):
    states = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0)))(env.params, keys(64))
    assert set(np.asarray(states.world.house)) == set(range(env.bank.num_houses))
    assert len(np.unique(states.physics.qpos[:, :2], axis=0)) > 32


def test_progress_is_rewarded(env, reset, step):
    """The rewards of a walk add up to the distance gained, less the costs."""
    states = reset(env.params, keys(), houses(env))
    start = states.task.distance
    total, contacts = jnp.zeros(NUM_ENVS), jnp.zeros(NUM_ENVS)
    for i in range(10):
        states = step(env.params, states, some_actions(seed=i))
        total += states.reward
        contacts += states.metrics["contact"]
    gained = (start - states.task.distance)[:, 0]
    task = env.task
    expected = gained - 10 * task.step_cost - task.contact_cost * contacts
    alive = ~np.asarray(states.done)
    np.testing.assert_allclose(total[alive], expected[alive], atol=1e-4)


def test_autoreset_begins_anew_and_keeps_the_final_observation(generated_bank):
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("state", "goal"), episode_length=2)
    auto = AutoReset(env.core)
    step = checked(jax.jit(auto.step))
    first = jax.jit(auto.reset)(env.params, keys(8))
    second = step(env.params, first, jnp.zeros((8, 4)))
    third = step(env.params, second, jnp.zeros((8, 4)))
    np.testing.assert_array_equal(second.done, second.metrics["success"])
    running = ~np.asarray(second.done)
    np.testing.assert_array_equal(third.done[running], 1)
    np.testing.assert_array_equal(third.truncated[running], third.metrics["success"][running] == 0)
    np.testing.assert_array_equal(third.world.step[running], 0)
    # Standing still, the final observation is where the episode was, the present one somewhere else.
    before, final, now = (np.asarray(x["state"])[running, :2] for x in (second.obs, third.info["final_obs"], third.obs))
    np.testing.assert_allclose(final, before, atol=1e-2)
    assert (np.linalg.norm(now - before, axis=-1) > 0.05).mean() > 0.8
    assert jax.tree.structure(first) == jax.tree.structure(third)
    assert [x.dtype for x in jax.tree.leaves(first)] == [x.dtype for x in jax.tree.leaves(third)]


def test_agents_see_each_other():
    bank = HouseBank.from_compiled([shoebox()])
    config = make_config(num_agents=2, sensors=("instance", "fine"), width=16, height=16)
    floor = float(bank.physics.floor[0])
    centre = floor + config.body.height / 2
    pose = AgentPose(  # the second agent stands 1.5 m before the first and both look along +x
        pos=jnp.array([[-1.0, 0.0, centre], [0.5, 0.0, centre]]), yaw=jnp.zeros(2), pitch=jnp.full(2, -0.3)
    )
    bodies = bank.spec.num_bodies
    quats = jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (bodies, 1))
    scene = make_scene(
        bank, jnp.int32(0), jnp.zeros((bodies, 3)), quats, pose.pos, jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (2, 1))
    )
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        images = jax.jit(lambda scene, pose: render_images(config, scene, pose))(scene, pose)
    ids = np.asarray(images["ids/head_instance"])
    first, second = agent_ids(bank, 2)
    assert (ids[0] == second).mean() > 0.02
    assert (ids[0][:, 7:9] == second).any()
    assert not np.isin(ids[1], [first, second]).any()
    assert (images["ids/head_fine"][0][ids[0] == second] == fine_index("person")).all()


def test_two_agents_step_together(generated_bank):
    env = home_mjx.make("PointNav-v0", generated_bank, num_agents=2, sensors=("state", "goal"))
    state = jax.jit(env.core.reset)(env.params, jax.random.key(0))
    own = np.asarray(state.obs["state"])
    assert np.linalg.norm(own[0, :2] - own[1, :2]) > 4 * env.config.body.radius - 1e-3
    after = jax.eval_shape(env.step, state, jax.ShapeDtypeStruct((2, 4), jnp.float32))
    assert after.reward.shape == after.task.reached.shape == (2,)
    assert after.terminated.shape == ()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"widht": 3}, "Did you mean `width`"),
        ({"width": 0}, "at least 1"),
        ({"fovy": 200.0}, "fovy"),
        ({"ctrl_dt": 0.125}, "ctrl_dt"),
        ({"sample_rate": 16005}, "sample_rate"),
    ],
)
def test_wrong_options_are_refused(options, words):
    with pytest.raises(ConfigError, match=words):
        make_config(**options)


def test_unknown_sensors_are_refused():
    with pytest.raises(ConfigError, match="Did you mean `rgb`"):
        HouseholdEnv(make_config(sensors=("rgbb",)))


def test_unknown_environment_is_refused():
    with pytest.raises(ConfigError, match="Did you mean `PointNav-v0`"):
        home_mjx.make("PointNv-v0")
