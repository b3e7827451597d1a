"""C MuJoCo inside `jit`: against the fused step, on exported houses, and what it refuses."""

import time
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from heaps import heap
from numpy.testing import assert_allclose, assert_array_equal

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.physics import ExportedTemplate, PhysicsConfig, PhysicsSetup, Template
from home_mjx.physics.mujoco import house_models as c_houses
from home_mjx.physics.mujoco.house_mjcf import HouseRows
from home_mjx.physics.mujoco.house_models import build_house_model
from home_mjx.physics.mujoco.mujoco_model import check_platform

pytestmark = pytest.mark.cpu

STEPS = 20
HOUSES = [
    shoebox(
        furniture=[
            Furniture((1.0, 0.0), (0.4, 0.5, 0.4), mass=8.0),
            Furniture((0.0, 1.0), (0.5, 0.5, 0.6), category="chair"),
        ]
    ),
    replace(shoebox(furniture=[Furniture((0.9, 0.05), (0.5, 0.6, 0.5), mass=30.0)]), id="other"),
]
STARTS = jnp.array([[[0.0, 0.0, 0.0]], [[-0.5, 0.0, 0.0]]])


def rollout(template, bank, starts=STARTS, actions=(1.0, 0.0, 0.0), steps=STEPS):
    """States after each control step (t, house)."""
    house = jnp.arange(bank.num_houses, dtype=jnp.int32)

    @jax.jit
    def run(bank):
        def step(state, _):
            state = jax.vmap(lambda h, s: physics.step(template, bank, h, s, jnp.array([actions])))(house, state)
            return state, state

        begun = jax.vmap(lambda h, pos: physics.reset(template, bank, h, pos, jnp.zeros(1)))(house, starts)
        return jax.lax.scan(step, begun, None, length=steps)[1]

    return jax.tree.map(np.asarray, run(bank))


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled(HOUSES)


@pytest.fixture(scope="module")
def fused(bank):
    return rollout(Template(PhysicsConfig(sleep=False), bank.spec), bank)


def test_houses_made_from_the_bank_move_as_in_the_fused_step(bank, fused):
    states = rollout(Template(PhysicsConfig(impl="c"), bank.spec), bank)
    assert (np.abs(fused.qpos[-1] - fused.qpos[0])[:, 4:7].max(axis=-1) > 0.3).all()  # what is pushed goes far
    assert_allclose(states.qpos, fused.qpos, atol=2e-4)
    assert_allclose(states.contact_impulse, fused.contact_impulse, atol=2e-3 * fused.contact_impulse.max())
    assert_array_equal(states.contact_partner, fused.contact_partner)
    assert_array_equal(states.contact_impulse > 0, fused.contact_impulse > 0)


@pytest.mark.parametrize("collision", ["box", "exact"])
def test_exported_houses_move_much_as_those_of_the_bank(bank, fused, collision):
    """Their objects are boxes, also as convex pieces; contact with the floor is MuJoCo's own, and the slab's."""
    if collision == "exact":
        pytest.importorskip("coacd", reason="the extra `exact` is not installed")
    template = ExportedTemplate(PhysicsConfig(impl="c"), bank, HOUSES, collision)
    states = rollout(template, template.bank)
    assert_allclose(states.qpos[:, 0], fused.qpos[:, 0], atol=3e-3)
    assert_allclose(states.qpos[:, 1], fused.qpos[:, 1], atol=0.02)  # pushed beside its middle
    assert_allclose(states.contact_impulse[-1], fused.contact_impulse[-1], atol=0.05 * fused.contact_impulse.max())


def test_friction_creeps_as_in_c_and_only_under_a_load():
    """MuJoCo regularises friction: 200 kg creep at 0.46 mm/s under 300 N of an agent, 8 kg under no load do not."""
    leant = Furniture((0.55, 0.0), (0.5, 0.5, 0.6), mass=200.0)
    bank = HouseBank.from_compiled([shoebox(furniture=[leant, Furniture((0.0, 1.5), mass=8.0)])])
    paths = [
        rollout(Template(config, bank.spec), bank, STARTS[:1], steps=30).qpos[:, 0, 4:18].reshape(30, 2, 7)
        for config in (PhysicsConfig(sleep=False), PhysicsConfig(impl="c"))
    ]
    fused, truth = ((path[-1] - path[9])[:, :2] for path in paths)
    assert truth[0, 0] == pytest.approx(2 * 4.59e-4, rel=0.05)
    assert_allclose(fused, truth, atol=1e-5)
    assert_allclose(fused[1], 0, atol=1e-6)


def heap_in_c(oracle):
    """A heap's house, made as from a bank's rows."""
    doors, count = oracle.doors, len(oracle.doors.mass)
    flat = np.zeros(count)
    rows = HouseRows(
        floor=np.float32(0),
        **{f"collider_{name}": x for name, x in zip(("pos", "quat", "size"), oracle.static, strict=True)},
        body_valid=np.ones(len(oracle.mass), bool),
        body_size=oracle.bodies.half,
        body_mass=oracle.mass,
        body_friction=oracle.surfaces[:, 0],
        body_damping_ratio=oracle.surfaces[:, 2] / (2 * np.sqrt(oracle.surfaces[:, 1])),
        door_valid=np.ones(count, bool),
        door_pivot=doors.pivot,
        door_slide=doors.slide,
        door_pos=np.c_[doors.pivot + doors.arm, doors.height],
        door_quat=np.c_[np.cos(doors.yaw / 2), flat, flat, np.sin(doors.yaw / 2)],
        door_size=doors.half,
        door_mass=doors.mass,
        door_low=doors.range[:, 0],
        door_high=doors.range[:, 1],
        tray_pos=doors.tray[..., :3],
        tray_size=doors.tray[..., 3:],
    )
    return build_house_model(oracle.config, oracle.layout, rows)


def test_a_heap_accelerates_as_in_the_templates_model(rng):
    """The model made from a bank's rows, with masks, is the template's, with explicit pairs: contacts and all."""
    total = 0
    for number in range(10):
        oracle, qpos, qvel, action = heap(rng, trays=number % 2 == 1)
        truth, count = oracle.accelerations(qpos, qvel, action)
        moved = heap_in_c(oracle).step(qpos, qvel, np.zeros_like(qvel), oracle.data.qfrc_actuator)
        assert_allclose(moved.qacc, truth, atol=1e-6 * np.abs(truth).max())
        pairs = oracle.data.contact.geom
        floor = (pairs == 0).any(axis=1)
        mobiles = oracle.model.geom_bodyid[pairs[~floor]] - 1
        rise = oracle.data.contact.frame[~floor, 2] * np.where(mobiles[:, 0] < 0, 1, -1)  # away from what is static
        carried = (mobiles < 0).any(axis=1) & (rise >= 0.5)
        touched = [((mobiles == agent).any(axis=1) & ~carried).sum() for agent in range(oracle.agents)]
        assert moved.contacts.num_contacts.tolist() == touched
        total += count
    assert total > 300


@pytest.mark.parametrize("seed", [33, 149])
def test_large_heaps_converge_as_the_sparse_jacobian_does_not(seed):
    """MuJoCo would choose that from 60 numbers on; Newton's method then ends far from the minimum after 100 steps."""
    oracle, qpos, qvel, action = heap(np.random.default_rng(seed), 12)
    truth, _ = oracle.accelerations(qpos, qvel, action)
    moved = heap_in_c(oracle).step(qpos, qvel, np.zeros_like(qvel), oracle.data.qfrc_actuator)
    _, _, fused, _, _ = oracle.fused(qpos, qvel, action)
    for found in (moved.qacc, fused):
        assert_allclose(found, truth, atol=1e-6 * np.abs(truth).max())


def test_state_of_environments_is_their_own(bank):
    """A batch of both houses, each twice, is each alone, to the last bit."""
    template = Template(PhysicsConfig(impl="c"), bank.spec)
    house = jnp.array([0, 1, 1, 0])
    state = jax.jit(jax.vmap(lambda h: physics.reset(template, bank, h, STARTS[h], jnp.zeros(1))))(house)
    actions = jax.random.uniform(jax.random.key(0), (4, 1, 3), minval=-1.0)
    step = jax.jit(lambda h, s, a: physics.step(template, bank, h, s, a))
    together = jax.vmap(step)(house, state, actions)
    for e in range(4):
        alone = step(house[e], jax.tree.map(lambda x, e=e: x[e], state), actions[e])
        jax.tree.map(lambda x, y, e=e: assert_array_equal(x[e], y), together, alone)


def test_an_exchanged_bank_is_noticed_and_few_houses_are_kept(bank, monkeypatch):
    """One program, other houses: their models are made; those that are not used are dropped."""
    monkeypatch.setattr(c_houses, "MAX_CACHED_HOUSES", 1)
    template = Template(PhysicsConfig(impl="c"), bank.spec)
    wide = bank.replace(physics=bank.physics.replace(collider_size=bank.physics.collider_size + 0.2))
    state = physics.reset(template, bank, jnp.int32(0), jnp.array([[2.6, 0.0, 0.0]]), jnp.zeros(1))
    step = jax.jit(lambda bank: physics.step(template, bank, jnp.int32(0), state, jnp.zeros((1, 3))))
    for _ in range(2):
        assert np.abs(step(bank).qvel[:3]).max() < 0.5
        assert np.abs(step(wide).qvel[:3]).max() > 0.5  # it is in a box, and pushed out
    assert len(c_houses.shared_house_models(template.config, template.layout)._houses) == 1


def test_a_state_that_is_not_a_number_stays_so_and_harms_nobody(bank):
    """MuJoCo would begin anew in silence."""
    template = Template(PhysicsConfig(impl="c"), bank.spec)
    house = jnp.arange(2, dtype=jnp.int32)
    state = jax.jit(jax.vmap(lambda h: physics.reset(template, bank, h, STARTS[h], jnp.zeros(1))))(house)
    bad = state.replace(qpos=state.qpos.at[0, 0].set(jnp.nan))
    step = jax.jit(jax.vmap(lambda h, s: physics.step(template, bank, h, s, jnp.ones((1, 3)))))
    good, after = step(house, state), step(house, bad)
    assert bool(physics.is_unstable(jax.tree.map(lambda x: x[0], after)))
    assert_array_equal(after.qpos[1], good.qpos[1])


def test_other_houses_than_the_banks_are_refused(bank):
    with pytest.raises(ConfigError, match="not the bank's houses"):
        ExportedTemplate(PhysicsConfig(impl="c"), bank, HOUSES[::-1])
    with pytest.raises(ConfigError, match="only C MuJoCo"):
        ExportedTemplate(PhysicsConfig(), bank, HOUSES)
    template = ExportedTemplate(PhysicsConfig(impl="c"), bank, HOUSES)
    one = HouseBank.from_compiled(HOUSES[:1])
    with pytest.raises(ConfigError, match="2 exported houses, the bank has 1"):
        rollout(template, one, STARTS[:1], steps=1)


def test_other_devices_are_refused(monkeypatch):
    check_platform()
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    with pytest.raises(ConfigError, match="for `gpu` here"):
        check_platform()
    with jax.default_device(jax.devices("cpu")[0]):
        check_platform()


def test_an_error_is_raised_when_all_threads_have_ended(monkeypatch, bank):
    """XLA frees the results then: a thread that still wrote to them corrupted memory."""
    written = []

    class Slow:
        def step(self, *state):
            time.sleep(0.3)
            written.append(1)
            raise KeyError

    class Broken:
        def step(self, *state):
            raise ValueError("broken")

    houses = c_houses.MujocoHouses(PhysicsSetup(impl="c"), Template(PhysicsConfig(impl="c"), bank.spec).layout)
    monkeypatch.setattr(c_houses, "usable_cores", lambda: 2)
    houses._houses = {0: Broken(), 1: Slow()}
    with pytest.raises(ValueError, match="broken"):
        houses._step([np.arange(2)], [])
    assert written
