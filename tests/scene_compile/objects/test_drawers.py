"""Drawers of a chest: from their joints to trays that carry things, in all implementations of the physics."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from chest import CUP, SHORT_TRAVEL, TRAVEL, home
from numpy.testing import assert_allclose

from home_mjx import HouseBank, physics
from home_mjx.errors import ConfigError
from home_mjx.navigation import compartment_at, door_angles
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.hand_control import HandCommands, apply_hand_commands, update_hands
from home_mjx.raycast_render import cast, make_scene
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.agent import AgentBody
from home_mjx.tasks import EnvConfig, HouseholdEnv
from home_mjx.tasks.env.reset import physics_template

HOUSE = jnp.int32(0)


@pytest.fixture(scope="module")
def house():
    return compile_house(*home(), CompileOptions(articulation=ArticulationOptions(8)))


@pytest.fixture(scope="module")
def bank(house):
    return HouseBank.from_compiled([house])


def drawers(house):
    """Rows of the drawers of the chest that nothing blocks, the highest first, and of the other chest."""
    rows = np.flatnonzero(house.doors.is_front)
    near = house.doors.pos[rows]
    rows = rows[np.lexsort((-near[:, 2], np.round(near[:, 1], 3)))]
    cup = house.bodies.pos[0, 1]
    own = np.abs(house.doors.pos[rows, 1] - cup) < 0.5
    return rows[own], rows[~own]


def test_drawers_have_trays_and_their_joints_travel(house):
    report, doors = house.report, house.doors
    assert (report["fronts"], report["drawers"], report["shut_joints"], report["compartments"]) == (4, 4, 2, 4)
    free, blocked = drawers(house)
    assert_allclose(doors.high[free], TRAVEL, atol=0.011)
    assert_allclose(doors.high[blocked], SHORT_TRAVEL, atol=0.011)
    assert_allclose(doors.low, 0, atol=1e-9)
    assert_allclose(np.abs(doors.slide[free] @ [1.0, 0.0]), 1, atol=1e-6)
    assert (house.doors.tray_size > 0).all()


def world_boxes(house, row):
    """Minimum and maximum of the boxes of a shut drawer; the chest is turned by a quarter."""
    doors = house.doors
    yaw = 2 * np.arctan2(doors.quat[row, 3], doors.quat[row, 0])
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    center = doors.pos[row] + np.vstack([np.zeros(3), doors.tray_pos[row] @ turn.T])
    half = np.vstack([doors.size[row], doors.tray_size[row]]) @ np.abs(turn).T
    return center - half, center + half


def test_a_tray_is_closed_below_and_around_and_open_above(house):
    """A grid of points in it: each way but up ends in a board, and no board is among them."""
    for row in drawers(house)[0]:
        low, high = world_boxes(house, row)
        inner_low, inner_high = low[1:].min(axis=0), high[1:].max(axis=0)
        points = np.stack(np.meshgrid(*np.linspace(inner_low + 0.02, inner_high - 0.02, 6).T), axis=-1).reshape(-1, 3)
        assert not ((points[:, None] > low) & (points[:, None] < high)).all(axis=-1).any()
        for axis in range(3):
            across = np.delete(np.arange(3), axis)
            covers = ((points[:, None, across] > low[:, across]) & (points[:, None, across] < high[:, across])).all(
                axis=-1
            )
            assert (covers & (high[:, axis] <= points[:, None, axis])).any(axis=1).all()
            if axis < 2:
                assert (covers & (low[:, axis] >= points[:, None, axis])).any(axis=1).all()


def test_no_part_of_a_drawer_meets_what_is_fixed_on_its_way(house):
    """Boxes of the drawer, at each centimetre, against all static boxes: the same overlap as when it is shut."""
    boxes = house.colliders
    assert_allclose(np.abs(boxes.quat[:, 1:3]), 0, atol=1e-9)
    yaw = 2 * np.arctan2(boxes.quat[:, 3], boxes.quat[:, 0])
    square = np.abs(np.sin(2 * yaw)) < 1e-6
    half = np.where((np.abs(np.sin(yaw)) > 0.5)[:, None], boxes.size[:, [1, 0, 2]], boxes.size)
    fixed = (boxes.pos - half)[square], (boxes.pos + half)[square]
    for row in np.concatenate(drawers(house)):
        low, high = world_boxes(house, row)
        for way in np.arange(0, house.doors.high[row] + 1e-9, 0.01):
            shift = way * np.array([*house.doors.slide[row], 0.0])
            depth = np.minimum(high[:, None] + shift, fixed[1]) - np.maximum(low[:, None] + shift, fixed[0])
            assert depth.min(axis=-1).max() < 1e-3


def test_rays_enter_an_open_drawer_and_meet_its_bottom(house, bank):
    for name in ("closed", "open"):
        angle = door_angles(bank, HOUSE, "open", jax.random.key(0), name)
        bodies = bank.physics.body_pos[0], bank.physics.body_quat[0]
        scene = make_scene(bank, HOUSE, *bodies, jnp.zeros((0, 3)), jnp.zeros((0, 4)), door_angle=angle)
        row = drawers(house)[0][0]
        low, high = world_boxes(house, row)
        way = np.array([*house.doors.slide[row], 0.0])
        target = (low[1] + high[1]) / 2 + 0.3 * way  # before the shut front, and over the open tray
        origin = np.array([target[0], target[1], 1.5])
        hit = cast(scene, jnp.array(origin, jnp.float32)[None], jnp.array([[0.0, 0.0, -1.0]]))
        is_drawer = int(hit.instance[0]) == house.doors.instance[row]
        assert is_drawer == (name == "open")
        if name == "open":
            assert float(hit.t[0]) == pytest.approx(1.5 - high[1, 2], abs=1e-4)


def carried(house, bank, impl, steps):
    """Poses of the cup, first in the shut drawer, and coordinates while a hand opens it, by control step."""
    template = Template(PhysicsConfig(impl=impl), bank.spec)
    row = drawers(house)[0][0]
    at = int(np.flatnonzero(np.asarray(bank.physics.door_instance[0]) == house.doors.instance[row])[0])
    low, high = world_boxes(house, row)
    way = np.array([*house.doors.slide[row], 0.0])
    feet = house.doors.pos[row, :2] + 0.9 * way[:2]
    state = physics.reset(
        template,
        bank,
        HOUSE,
        jnp.array([[*feet, 0.0]], jnp.float32),
        jnp.array([np.pi + np.arctan2(way[1], way[0])], jnp.float32),
    )
    inside = (low[1] + high[1]) / 2
    inside[2] = high[1, 2] + CUP / 2 + 1e-3
    start = template.layout.body_qpos.start
    state = state.replace(qpos=state.qpos.at[start : start + 3].set(jnp.array(inside, jnp.float32)))

    @jax.jit
    def step(state, commands):
        state = apply_hand_commands(template, bank, HOUSE, state, commands)
        state = physics.step(template, bank, HOUSE, state, jnp.zeros((1, 3)))
        return update_hands(template, bank, HOUSE, state)

    pull = HandCommands.idle(1).replace(door=jnp.array([at], jnp.int32), open=jnp.array([True]))
    track = []
    for t in range(steps):
        state = step(state, pull if t == 5 else HandCommands.idle(1))
        track.append(
            np.r_[np.asarray(state.qpos)[start : start + 3], np.asarray(physics.door_angle(template, state))[at]]
        )
    return np.array(track), way, high[1, 2]


def test_a_drawer_carries_what_is_in_it_as_in_c(house, bank):
    (mine, way, bottom), (truth, _, _) = (carried(house, bank, impl, 30) for impl in ("fused", "c"))
    assert mine[4, 3] == pytest.approx(0, abs=5e-3)
    assert mine[-1, 3] == pytest.approx(TRAVEL, abs=0.04)
    assert_allclose(mine[:, 3], truth[:, 3], atol=3e-3)
    assert_allclose(mine[:, :3], truth[:, :3], atol=0.02)
    moved = (mine[-1, :3] - mine[4, :3]) @ way
    assert 0.5 * TRAVEL < moved < 1.2 * TRAVEL + 0.2
    assert_allclose(mine[:, 2], bottom + CUP / 2, atol=2e-3)


@pytest.mark.slow
def test_a_drawer_carries_what_is_in_it_in_mjx_as_in_c(house, bank):
    (mine, _, _), (truth, _, _) = (carried(house, bank, impl, 30) for impl in ("jax", "c"))
    assert_allclose(mine, truth, atol=2e-3)
    assert_allclose(mine[:8], truth[:8], atol=1e-4)


@pytest.mark.parametrize("state", ["closed", "open"])
def test_a_tray_stops_a_kinematic_agent_from_the_side(house, bank, state):
    template, row = Template(PhysicsConfig(impl="kinematic"), bank.spec), drawers(house)[0][0]
    shift = house.doors.high[row] * np.array([*house.doors.slide[row], 0.0])
    low, high = world_boxes(house, row)
    assert abs(house.doors.slide[row] @ [0.0, 1.0]) < 1e-6
    feet = np.array([(high[1, 0] + shift[0] + high[1, 0]) / 2, high[0, 1] + 0.5])  # beside the middle of what is out
    angle = door_angles(bank, HOUSE, "open", jax.random.key(0), state)
    start = jnp.array([[*feet, 0.0]], jnp.float32), jnp.array([-np.pi / 2], jnp.float32)
    walked = physics.reset(template, bank, HOUSE, *start, angle)
    step = jax.jit(lambda s: physics.step(template, bank, HOUSE, s, jnp.array([[1.0, 0.0, 0.0]])))
    for _ in range(20):
        walked = step(walked)
    y, radius = float(physics.agent_pose(template, walked)[0][0, 1]), AgentBody().radius
    if state == "closed":
        assert y < low[0, 1]
    else:
        assert y == pytest.approx(high[1:, 1].max() + radius, abs=0.03)


def test_compartments_are_the_free_boxes_of_trays(house):
    own = house.compartments
    assert sorted(own.leaf.tolist()) == np.flatnonzero(house.doors.is_front).tolist()
    for row in drawers(house)[0]:
        low, high = world_boxes(house, row)
        (at,) = np.flatnonzero(own.leaf == row)
        yaw = 2 * np.arctan2(own.quat[at, 3], own.quat[at, 0])
        half = own.size[at] if abs(np.sin(yaw)) < 0.5 else own.size[at, [1, 0, 2]]
        free = own.pos[at] - half, own.pos[at] + half
        assert not ((low < free[1] - 1e-6) & (high > free[0] + 1e-6)).all(axis=1).any()
        assert free[0][2] == pytest.approx(high[1, 2], abs=1e-6)
        volume = np.prod(free[1] - free[0])
        assert volume > 0.8 * np.prod(high[1:].max(axis=0) - low[1:].min(axis=0))


@pytest.mark.parametrize("fronts", ["closed", "open"])
def test_stored_bodies_are_in_compartments_and_move_with_drawers(house, bank, fronts):
    config = EnvConfig(sensors=("state",), stored_bodies=2, fronts=fronts, hands=True)
    env = HouseholdEnv(config).bind(bank)
    template, reset = physics_template(config, bank.spec), jax.jit(env.reset)
    seen = set()
    for seed in range(12):
        state = reset(jax.random.key(seed))
        angle, pos = physics.door_angle(template, state.physics), physics.body_pose(template, state.physics)[0]
        inside = np.asarray(compartment_at(bank, HOUSE, angle, pos))
        assert inside[0] >= 0
        assert (inside[1:] == -1).all()
        seen.add(int(inside[0]))
        row = house.compartments.leaf[inside[0]]
        low, high = world_boxes(house, row)
        shift = (house.doors.high[row] if fronts == "open" else 0.0) * np.array([*house.doors.slide[row], 0.0])
        body = np.asarray(pos[0])
        half = np.array([CUP / 2] * 3)
        assert not ((low + shift < body + half) & (high + shift > body - half)).all(axis=1).any()
        assert 0 < body[2] - CUP / 2 - high[1, 2] < 2e-3
    assert len(seen) == 4


def test_nothing_is_stored_where_there_is_no_compartment():
    bank = HouseBank.from_compiled([compile_house(*home())])
    assert bank.compartments.is_empty
    with pytest.raises(ConfigError, match="compartments"):
        HouseholdEnv(EnvConfig(sensors=("state",), stored_bodies=1)).bind(bank).reset(jax.random.key(0))
    with pytest.raises(ConfigError, match="stored_bodies"):
        EnvConfig(stored_bodies=-1)


def test_exported_drawers_slide_and_have_the_boxes_of_their_trays(house):
    model = mujoco.MjModel.from_xml_string(*to_mjcf(house, agent=AgentBody()))
    for row in drawers(house)[0]:
        instance = house.doors.instance[row]
        name = f"object{house.instances.object_id[instance]}_leaf{instance}"
        assert model.joint(name).type[0] == mujoco.mjtJoint.mjJNT_SLIDE
        low, high = world_boxes(house, row)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        for t in range(4):
            assert_allclose(data.geom(f"{name}_tray{t}").xpos, (low[1 + t] + high[1 + t]) / 2, atol=1e-5)
