"""What goes wrong inside a jitted step is told outside of it."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx import AutoReset, HouseBank, HouseholdEnv
from home_mjx.errors import DatasetError
from home_mjx.tasks import Status, StatusError, check_status, load_states, make_config, save_states

STILL = jnp.zeros(4)


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    crates = [Furniture((x, 0.0), size=(0.5, 0.5, 0.5), mass=5.0) for x in (-1.5, 0.0, 1.5)]
    return HouseBank.from_compiled([shoebox(furniture=crates)])


def make_env(bank, **options):
    return HouseholdEnv(make_config(**{"sensors": ("state",)} | options)).bind(bank)


def placed(env, x, y):
    """A state with the agent's axis at (x, y)."""
    state = env.reset(jax.random.key(0))
    return state.replace(physics=state.physics.replace(qpos=state.physics.qpos.at[:2].set(jnp.array([x, y]))))


def status_of(env, state):
    return Status(int(jax.jit(env.step)(state, STILL).status))


def test_nothing_is_lost_in_an_ordinary_walk(generated_bank):
    env = make_env(generated_bank)
    states = jax.vmap(env.reset)(jax.random.split(jax.random.key(1), 8))
    step = jax.jit(jax.vmap(env.step))
    for i in range(20):
        states = step(states, jax.random.uniform(jax.random.key(i), (8, 4), minval=-1.0, maxval=1.0))
        check_status(states, ignore=Status.STATIC_BOXES)
    assert states.status.shape == (8,)


def test_a_broken_pose_ends_its_environment_alone(bank):
    """Speeds of 1e38 m/s overflow: that step is undone, its neighbours do not notice."""
    env = make_env(bank)
    states = jax.vmap(env.reset)(jax.random.split(jax.random.key(0), 4))
    fast = states.physics.qvel.at[2].set(1e38)
    step = jax.jit(jax.vmap(env.step))
    calm, wild = (
        step(s, jnp.zeros((4, 4))) for s in (states, states.replace(physics=states.physics.replace(qvel=fast)))
    )
    assert [Status(int(s)) for s in wild.status] == [0, 0, Status.NOT_A_NUMBER, 0]
    assert wild.terminated.tolist() == [False, False, True, False]
    assert not wild.truncated.any()
    assert float(wild.reward[2]) == 0.0
    assert np.isfinite(np.concatenate([np.ravel(x) for x in jax.tree.leaves(wild.obs)])).all()
    np.testing.assert_array_equal(wild.physics.qpos[2], states.physics.qpos[2])
    others = np.array([0, 1, 3])
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[others], b[others]), calm, wild)
    with pytest.raises(StatusError, match=r"1 of 4 environments.*environment 2: NOT_A_NUMBER"):
        check_status(wild)


def test_a_fault_is_counted_and_reset(bank):
    auto = AutoReset(make_env(bank).core).bind(bank)
    states = auto.reset(jax.random.split(jax.random.key(0), 2))
    states = states.replace(physics=states.physics.replace(qvel=states.physics.qvel.at[0].set(1e38)))
    states = jax.jit(auto.step)(states, jnp.zeros((2, 4)))
    assert states.world.faults.tolist() == [1, 0]
    assert states.world.step.tolist() == [0, 1]
    assert Status(int(states.status[0])) == Status.NOT_A_NUMBER
    states = jax.jit(auto.step)(states, jnp.zeros((2, 4)))
    assert states.world.faults.tolist() == [1, 0]
    assert not states.status.any()


def test_static_boxes_beyond_the_slots_are_told(bank):
    corner = (-2.95, -2.45)  # of a room of 6 m x 5 m: two walls are touched
    assert Status.STATIC_BOXES in status_of(
        make_env(bank, agent_slots=1), placed(make_env(bank, agent_slots=1), *corner)
    )
    assert Status.STATIC_BOXES not in status_of(make_env(bank), placed(make_env(bank), *corner))


def test_pairs_that_the_broad_phase_leaves_out_are_told(bank):
    few = make_env(bank, max_geom_pairs=1)
    assert Status.CONTACT_PAIRS in status_of(few, placed(few, -2.95, -2.45))
    plenty = make_env(bank)
    assert Status.CONTACT_PAIRS not in status_of(plenty, placed(plenty, -2.95, -2.45))


def test_too_few_contact_points_are_told(bank):
    few = make_env(bank, max_contact_points=1)
    assert Status.CONTACT_POINTS in status_of(few, placed(few, 0.0, -2.0))
    plenty = make_env(bank)
    assert Status.CONTACT_POINTS not in status_of(plenty, placed(plenty, 0.0, -2.0))


def test_responses_that_end_too_early_are_told(bank):
    options = {"sensors": ("audio",), "num_rays": 64, "num_bounces": 8}
    short, long = (make_env(bank, response_seconds=s, **options) for s in (0.04, 2.0))
    for env, cut in ((short, True), (long, False)):
        state = jax.jit(env.reset)(jax.random.key(0))
        assert (Status.RESPONSE_CUT in Status(int(state.status))) == cut


def test_states_are_kept_and_go_on(bank, tmp_path):
    env = make_env(bank)
    states = jax.vmap(env.reset)(jax.random.split(jax.random.key(0), 3))
    states = states.replace(status=jnp.array([0, 1, 0], jnp.int32))
    assert save_states(tmp_path / "all.npz", states) == 3
    assert save_states(tmp_path / "wrong.npz", states, faulty_only=True) == 1
    back = load_states(tmp_path / "wrong.npz", env)
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[0], b[1]), back, states)
    step = jax.jit(jax.vmap(env.step))
    again, first = step(back, jnp.zeros((1, 4))), step(states, jnp.zeros((3, 4)))
    np.testing.assert_allclose(again.obs["state"][0], first.obs["state"][1], atol=1e-5)
    with pytest.raises(DatasetError, match="cannot be read"):
        load_states(tmp_path / "none.npz", env)
    with pytest.raises(DatasetError, match=r"qpos|pitch"):
        load_states(tmp_path / "all.npz", make_env(bank, num_agents=2))


def test_flags_have_names():
    assert Status.names(Status.CONTACT_PAIRS | Status.RESPONSE_CUT) == ["CONTACT_PAIRS", "RESPONSE_CUT"]
    assert len({int(flag) for flag in Status}) == len(Status)
    assert dataclasses.is_dataclass(make_config())
