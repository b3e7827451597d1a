"""What goes wrong inside a jitted step is told outside of it."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from handmade import Furniture, shoebox
from mujoco import mjx

from home_mjx import AutoReset, HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.physics.mjx.overflow import GeomPairs, GeomSizes, are_points_full, numeric_limit
from home_mjx.tasks import (
    Status,
    StatusError,
    check_status,
    dump_flagged,
    load_flagged,
    load_states,
    make_config,
    save_states,
)
from home_mjx.tasks.sensors.hearing import is_response_cut

NUM = 4


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    crates = [Furniture((x, 0.0), size=(0.5, 0.5, 0.5), mass=5.0) for x in (-1.5, 0.0, 1.5)]
    return HouseBank.from_compiled([shoebox(furniture=crates)])


@pytest.fixture(scope="module", params=["jax", "fused"])
def batch(bank, request):
    """Environments whose agents have one slot for static boxes, where the physics has slots."""
    return AutoReset(HouseholdEnv(make_config(sensors=("state",), agent_slots=1, impl=request.param))).bind(bank)


@pytest.fixture(scope="module")
def step(batch):
    return jax.jit(batch.step)


@pytest.fixture(scope="module")
def begun(batch):
    return jax.jit(batch.reset)(jax.random.split(jax.random.key(0), NUM))


def test_a_broken_pose_ends_its_environment_alone(begun, step):
    """At 1e38 m/s nothing is right any more: that step is undone, the fault counted, the neighbours do not notice."""
    fast = begun.physics.replace(qvel=begun.physics.qvel.at[2].set(1e38))
    calm, wild = (step(states, jnp.zeros((NUM, 4))) for states in (begun, begun.replace(physics=fast)))
    assert [Status(int(s)) for s in wild.status] == [0, 0, Status.NOT_A_NUMBER, 0]
    assert wild.terminated.tolist() == [False, False, True, False]
    assert not wild.truncated.any()
    assert float(wild.reward[2]) == 0.0
    assert wild.world.num_faults.tolist() == [0, 0, 1, 0]
    assert wild.world.step.tolist() == [1, 1, 0, 1]
    others = np.array([0, 1, 3])
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[others], b[others]), calm, wild)
    np.testing.assert_allclose(wild.info["final_obs"]["state"][2, :2], begun.obs["state"][2, :2])
    with pytest.raises(StatusError, match=r"1 of 4 environments.*environment 2: NOT_A_NUMBER"):
        check_status(wild)
    after = step(wild, jnp.zeros((NUM, 4)))
    check_status(after)
    assert after.world.num_faults.tolist() == [0, 0, 1, 0]
    assert all(np.isfinite(x).all() for x in jax.tree.leaves((after.obs, after.reward, after.physics.qpos)))


def test_static_boxes_beyond_the_slots_are_told(batch, begun, step):
    """In a corner of a room of 6 m x 5 m two walls are touched; in the open nothing is. The fused step has no slots."""
    places = jnp.array([[-2.95, -2.45], [0.0, -1.5], [2.95, 2.45], [0.0, 1.5]])
    placed = begun.physics.replace(qpos=begun.physics.qpos.at[:, :2].set(places))
    status = step(begun.replace(physics=placed), jnp.zeros((NUM, 4))).status
    slots = batch.core.config.physics.impl == "jax"
    assert [Status.STATIC_BOXES in Status(int(s)) for s in status] == [slots, False, slots, False]


MODEL = """
<mujoco>
  <custom>
    <numeric name="max_geom_pairs" data="1"/>
    <numeric name="max_contact_points" data="2"/>
  </custom>
  <worldbody>
    <geom name="big" type="box" size="9 .1 9" contype="0" conaffinity="0"/>
    <body name="a" pos="0 {first} 0"><freejoint/>
      <geom name="a" type="box" size=".1 .1 .1" contype="0" conaffinity="0"/></body>
    <body name="b" pos="0 {second} 0"><freejoint/>
      <geom name="b" type="box" size=".1 .1 .1" contype="0" conaffinity="0"/></body>
  </worldbody>
  <contact><pair geom1="a" geom2="big" condim="3"/><pair geom1="a" geom2="b" condim="3"/></contact>
</mujoco>
"""


@pytest.mark.parametrize(
    ("first", "second", "pairs", "points"),
    # MJX tests the one pair that is nearest by bounding spheres: always `a` and the big box.
    [(0.15, 0.3, True, True), (0.15, 0.5, False, True), (0.5, 1.0, False, False)],
)
def test_contacts_that_do_not_fit_are_told(first, second, pairs, points):
    """Against MuJoCo in C, which has no such limits: how many pairs touch."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(first=first, second=second))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    touching = {frozenset(data.contact.geom[i].tolist()) for i in range(data.ncon)}
    device = mjx.put_model(model)
    with jax.numpy_dtype_promotion("standard"), jax.numpy_rank_promotion("allow"):
        moved = jax.jit(mjx.collision)(device, jax.jit(mjx.kinematics)(device, mjx.make_data(model)))
    sizes = GeomSizes(size=device.geom_size, rbound=device.geom_rbound)
    found = bool(jax.jit(GeomPairs.from_model(model).find_overflow)(sizes, moved))
    assert found == pairs == (len(touching) > 1)
    assert bool(are_points_full(moved, numeric_limit(model, "max_contact_points"))) == points == (data.ncon > 1)


def test_responses_that_end_too_early_are_told():
    """Exponential decays of a known time: 60 dB in one second fall by 30 dB in half a second."""
    config = make_config(response_seconds=0.5).audio
    time = np.arange(config.response_length) / config.sample_rate
    for seconds, cut in ((0.9, False), (1.2, True)):
        response = jnp.asarray(np.tile(10 ** (-3 * time / seconds), (2, 1)), jnp.float32)
        assert bool(is_response_cut(response, config)) == cut


def test_states_are_kept_and_go_on(begun, step, batch, tmp_path):
    env = batch.core.core.bind(batch.params)
    states = begun.replace(status=jnp.array([0, 1, 0, 0], jnp.int32))
    assert save_states(tmp_path / "all.npz", states) == NUM
    back = load_states(tmp_path / "all.npz", env)
    jax.tree.map(np.testing.assert_array_equal, back, states.replace(info={}))
    one = jax.tree.map(lambda x: x[1], states)
    assert save_states(tmp_path / "one.npz", one) == 1
    loaded = load_states(tmp_path / "one.npz", env)
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a[0], b), loaded, one.replace(info={}))
    again = step(jax.tree.map(jnp.asarray, back).replace(info=states.info), jnp.zeros((NUM, 4)))
    jax.tree.map(np.testing.assert_array_equal, again, step(states, jnp.zeros((NUM, 4))))
    with pytest.raises(DatasetError):
        load_states(tmp_path / "none.npz", env)
    with np.load(tmp_path / "all.npz") as file:
        arrays = dict(file)
    np.savez(tmp_path / "cut.npz", **arrays | {".world.step": arrays[".world.step"][:2]})
    with pytest.raises(DatasetError, match=r"expected 4 environments.*\.world\.step"):
        load_states(tmp_path / "cut.npz", env)
    two = HouseholdEnv(make_config(sensors=("state",), num_agents=2)).bind(batch.bank)
    with pytest.raises(DatasetError, match=r"qpos|qvel|physics"):
        load_states(tmp_path / "all.npz", two)


# How MJX breaks is shown above; a step of its own without automatic resets takes long to compile.
@pytest.mark.parametrize("batch", ["fused", pytest.param("jax", marks=pytest.mark.slow)], indirect=True, scope="module")
def test_a_step_that_breaks_is_kept_and_breaks_again(begun, step, batch, tmp_path):
    """The second environment breaks, the fourth leaves the lot; automatic resets have gone on when the dump is made."""
    core, path = batch.core.core, tmp_path / "broken.npz"
    actions = jax.random.uniform(jax.random.key(3), (NUM, 4), minval=-1.0)
    wild = begun.physics.replace(qvel=begun.physics.qvel.at[1].set(1e38), qpos=begun.physics.qpos.at[3, 0].set(100.0))
    before = begun.replace(physics=wild)
    after, good = step(before, actions), step(begun, actions)
    assert dump_flagged(path, begun, actions, good) == 0
    assert not path.exists()
    assert dump_flagged(path, before, actions, after) == 1
    assert dump_flagged(tmp_path / "both.npz", before, actions, after, Status.NOT_A_NUMBER | Status.OUTSIDE) == 2
    again = jax.jit(jax.vmap(core.step, (None, 0, 0)))
    states, kept = load_flagged(tmp_path / "both.npz", core.bind(batch.params))
    np.testing.assert_array_equal(kept, actions[jnp.array([1, 3])])
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a, b[np.array([1, 3])]), states, before.replace(info={}))
    assert again(batch.params, states, kept).status.tolist() == after.status[jnp.array([1, 3])].tolist()
    assert "NOT_A_NUMBER" in Status.names(after.status[1])
    assert all(isinstance(leaf, jax.Array) for leaf in jax.tree.leaves(states))  # one of them can be stepped as it is
    states, kept = load_flagged(path, core.bind(batch.params))
    assert kept.shape == (1, 4)
    save_states(path, states)
    with pytest.raises(DatasetError, match="action"):
        load_flagged(path, core.bind(batch.params))


@pytest.fixture(scope="module")
def core():
    return HouseholdEnv(make_config(sensors=("state",), impl="kinematic", episode_length=2))


@pytest.fixture(scope="module")
def banks():
    """Of one spec: the same house, another one, and one that has the same id by mistake."""
    houses = [shoebox(furniture=[Furniture((x, 0.5), size=(1.0, 0.3, 1.0))]) for x in (0.0, 1.0)]
    houses = [houses[0], replace(houses[1], id="other"), houses[1]]
    banks = [HouseBank.from_compiled([house]) for house in houses]
    assert banks[0].spec == banks[1].spec == banks[2].spec
    return banks


def test_states_of_another_house_are_refused_where_it_is_known(core, banks, tmp_path):
    """In a program, where it is not, they end at once, without reward, and with a flag; automatic resets go on."""
    here, *others = (core.bind(bank) for bank in banks)
    states = jax.jit(jax.vmap(here.reset))(jax.random.split(jax.random.key(0), 2))
    step = jax.jit(jax.vmap(core.step, (None, 0, 0)))
    batch = AutoReset(core)
    going = jax.jit(batch.step)
    save_states(tmp_path / "here.npz", states)
    load_states(tmp_path / "here.npz", here)
    assert step(here.params, states, jnp.zeros((2, 4))).status.tolist() == [0, 0]
    for other in others:
        one = jax.tree.map(lambda x: x[0], states)
        with pytest.raises(ConfigError, match="reset in another house than"):
            other.step(one, jnp.zeros(4))
        with pytest.raises(ConfigError, match="environment 0"):
            batch.step(other.params, states, jnp.zeros((2, 4)))
        with pytest.raises(DatasetError, match="reset in another house than"):
            load_states(tmp_path / "here.npz", other)
        after = step(other.params, states, jnp.ones((2, 4)))
        assert [Status(int(s)) for s in after.status] == [Status.OTHER_HOUSE] * 2
        assert after.terminated.all()
        assert not after.reward.any()
        begun = jax.jit(batch.reset)(here.params, jax.random.split(jax.random.key(0), 2))
        begun = going(other.params, begun, jnp.ones((2, 4)))
        assert [Status(int(s)) for s in begun.status] == [Status.OTHER_HOUSE] * 2
        assert going(other.params, begun, jnp.zeros((2, 4))).status.tolist() == [0, 0]


def test_states_of_another_environment_are_refused(core, banks):
    """By their shapes, which every trace knows."""
    crates = [Furniture((x, 0.0), size=(0.5, 0.5, 0.5), mass=5.0) for x in np.linspace(-2, 2, 9)]
    other = core.bind(HouseBank.from_compiled([shoebox(furniture=crates)]))
    state = jax.eval_shape(core.reset, core.bind(banks[0]).params, jax.random.key(0))
    with pytest.raises(ConfigError, match="it is of another environment"):
        jax.eval_shape(core.step, other.params, state, jnp.zeros(4))


def test_a_step_after_the_end_is_told(core, banks):
    """Not where automatic resets have begun the next episode."""
    env = core.bind(banks[0])
    step, reset = jax.jit(env.step), jax.jit(env.reset)
    states = [reset(jax.random.key(0))]
    for _ in range(3):
        states.append(step(states[-1], jnp.zeros(4)))
    assert [bool(s.done) for s in states] == [False, False, True, True]
    assert [Status.names(s.status) for s in states] == [[], [], [], ["OVER"]]
    batch = AutoReset(core).bind(env.params)
    again, going = jax.jit(batch.reset)(jax.random.split(jax.random.key(0), 2)), jax.jit(batch.step)
    for _ in range(5):
        again = going(again, jnp.zeros((2, 4)))
        assert not again.status.any()


def test_flags_have_names():
    assert Status.names(Status.CONTACT_PAIRS | Status.RESPONSE_CUT) == ["CONTACT_PAIRS", "RESPONSE_CUT"]
    assert len({int(flag) for flag in Status}) == len(Status)
