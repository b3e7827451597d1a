"""Fronts of furniture in a generated flat: from its table of joints to hands that open a cabinet and what is in it."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from generated import generate_flats
from numpy.testing import assert_allclose, assert_array_equal

from home_mjx import HouseBank, physics
from home_mjx.core.array_store import flatten
from home_mjx.datasets.furniture import attach_joints
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError
from home_mjx.navigation import door_angles
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.physics.hand_control import HandCommands, apply_hand_commands, update_hands
from home_mjx.raycast_render import cast, make_scene
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.objects.fixed_parts import describe_fixed, fixed_joints, fixed_records
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.agent import AgentBody
from home_mjx.tasks import EnvConfig, HouseholdEnv
from home_mjx.tasks.env.reset import physics_template

MAX_FRONTS = 8
HOUSE = jnp.int32(0)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A flat as it is read, only with doors and with furniture that has joints, and its dataset."""
    root = tmp_path_factory.mktemp("generated")
    (name,) = generate_flats(root, [1])
    dataset = open_dataset(root)
    home = attach_joints(dataset.load_house(name), dataset.joints)
    (level,) = home.levels
    return replace(home, levels=(replace(level, objects=tuple(o for o in level.objects if o.joints)),)), dataset


@pytest.fixture(scope="module")
def house(source):
    options = CompileOptions(articulation=ArticulationOptions(MAX_FRONTS))
    return compile_house(source[0], source[1].metadata, options)


@pytest.fixture(scope="module")
def bank(house):
    return HouseBank.from_compiled([house])


def fronts(house):
    return np.flatnonzero(house.doors.is_front)


def outward(house, row):
    """Unit direction from a shut front to the room: to which its middle moves as it begins to open."""
    doors = house.doors
    arm = doors.pos[row, :2] - doors.pivot[row]
    way = np.array([-arm[1], arm[0]]) * np.sign(doors.fully_open[row] - doors.closed[row])
    quat = doors.quat[row]
    yaw = 2 * np.arctan2(quat[3], quat[0]) + np.pi / 2 * doors.size[row, :2].argmin()
    normal = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    return normal * np.sign(normal[:2] @ way)


def scene_of(bank, state):
    angle = door_angles(bank, HOUSE, "open", jax.random.key(0), state)
    bodies = bank.physics.body_pos[0], bank.physics.body_quat[0]
    return make_scene(bank, HOUSE, *bodies, jnp.zeros((0, 3)), jnp.zeros((0, 4)), door_angle=angle)


def test_the_largest_vertical_hinges_open_and_the_rest_is_counted(source, house):
    home, dataset = source
    joints = [
        (joint, node)
        for level in home.levels
        for node in level.objects
        if dataset.metadata.info(node.model_id).coarse != "door"
        for joint in dataset.joints.get(node.model_id, ())
    ]
    upright = [(j, n) for j, n in joints if j.kind == "hinge" and abs(j.axis[1]) > 0.99]
    assert len(upright) > MAX_FRONTS
    assert house.report["fronts"] == len(fronts(house)) == MAX_FRONTS
    assert house.report["shut_joints"] == len(joints) - MAX_FRONTS
    assert house.report["compartments"] > 0
    areas = []
    for joint, node in upright:  # generated furniture is not scaled
        points = home.models[node.model_key].vertices[home.models[node.model_key].faces[joint.faces]].reshape(-1, 3)
        areas.append(np.ptp(points[:, 1]) * np.hypot(*np.ptp(points[:, [0, 2]], axis=0)))
    sizes = np.sort(house.doors.size[fronts(house)], axis=1)
    smallest = 4 * (sizes[:, 1] * sizes[:, 2]).min()
    assert smallest >= np.sort(areas)[-MAX_FRONTS] * 0.8  # boxes are without handles and what stands out


def test_ranges_end_at_a_quarter_turn_or_before(house):
    doors, rows = house.doors, fronts(house)
    reach = (doors.high - doors.low)[rows]
    assert (reach <= np.pi / 2 + 1e-9).all()
    assert np.median(reach) > np.deg2rad(85)
    assert house.report["blocked_fronts"] == (reach < np.deg2rad(60)).sum()
    assert_allclose(doors.closed[rows], 0, atol=1e-12)  # as the file has them
    assert (doors.mass[rows] < 6).all()


def test_surplus_and_blocked_fronts_are_listed_as_fixed(source, house):
    """Of one cabinet, one door may open and another stay shut; a leaf's pivot in the plan tells which one moves."""
    home, dataset = source
    fixed = fixed_joints(home, dataset.joints, dataset.metadata, house, MAX_FRONTS)
    parts = fixed_records(house, fixed)
    shut = house.report["shut_joints"] + house.report["shut_leaves"]  # the leaves of the outer door
    assert sum(not one["is_blocked"] for one in parts) == shut
    assert sum(one["is_blocked"] for one in parts) == house.report["blocked_fronts"]
    assert len(describe_fixed(house, fixed)) >= 2
    objects = house.instances.object_id[house.doors.instance]
    places = {node.index: node.transform for level in home.levels for node in level.objects}
    free = 0
    for object_id, place in places.items():  # one storey: ids are indices
        held = {one.joint for one in fixed.get(object_id, ())}
        for joint in {j for node in home.levels[0].objects if node.index == object_id for j in node.joints} - held:
            x, _, z = place[:3, :3] @ joint.point + place[:3, 3]
            pivots = house.doors.pivot[objects == object_id]
            is_slide = joint.kind == "slide"
            assert is_slide or abs(pivots - [x, -z] - house.offset[:2]).max(axis=1).min() < 1e-5
            free += 1
    assert free == len(house.doors.instance) - house.report["blocked_fronts"]


def test_without_the_option_joints_of_furniture_change_nothing(source):
    home, dataset = source
    bare = replace(
        home,
        levels=tuple(
            replace(
                level,
                objects=tuple(
                    o if dataset.metadata.info(o.model_id).coarse == "door" else replace(o, joints=())
                    for o in level.objects
                ),
            )
            for level in home.levels
        ),
    )
    plain, jointed = (flatten(compile_house(h, dataset.metadata), frozenset(("models",))) for h in (bare, home))
    assert plain[0].keys() == jointed[0].keys()
    for name, values in plain[0].items():
        assert_array_equal(values, jointed[0][name], err_msg=name)
    counts = plain[1].pop("report"), jointed[1].pop("report")
    assert plain[1] == jointed[1]
    assert counts[0].items() - {("shut_joints", 0)} <= counts[1].items()
    assert HouseBank.from_compiled([compile_house(home, dataset.metadata)]).fronts.is_empty


@pytest.mark.parametrize("state", ["closed", "open"])
def test_rays_meet_a_shut_front_and_enter_the_compartment_behind_an_open_one(house, bank, state):
    doors, scene, seen = house.doors, scene_of(bank, state), 0
    ids = house.instances.object_id
    for row in fronts(house):
        if doors.high[row] - doors.low[row] < np.deg2rad(80):
            continue
        normal = outward(house, row)
        # A quarter of the way up, where no shelf is, and beside the middle.
        target = doors.pos[row] + [0, 0, 0.31 * doors.size[row, 2]]
        origin = target + 0.2 * normal
        hit = cast(scene, jnp.array(origin, jnp.float32)[None], jnp.array(-normal, jnp.float32)[None])
        instance, depth = int(hit.instance[0]), float(hit.t[0]) - 0.2
        if state == "closed":
            assert instance == doors.instance[row]
            assert abs(depth) < 0.07
        elif depth > 0.1 and ids[instance] == ids[doors.instance[row]]:
            assert instance != doors.instance[row]
            seen += 1
    assert state == "closed" or seen >= 3
    assert_array_equal(make_open_scene(bank, HOUSE).moving.pose, scene_of(bank, "closed").moving.pose)


def test_static_boxes_leave_compartments_free_and_agents_out_of_them(house):
    """A ball of 3 cm in the middle of each compartment touches no box; free cells are not in furniture."""
    boxes = house.colliders
    turn = 2 * np.arctan2(boxes.quat[:, 3], boxes.quat[:, 0])
    upright = np.abs(boxes.quat[:, 1:3]).max(axis=1) < 1e-6

    def is_free(point, radius):
        away = (point - boxes.pos)[upright]
        c, s = np.cos(turn[upright]), np.sin(turn[upright])
        local = np.stack([c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0], away[:, 2]], axis=1)
        gap = np.linalg.norm(np.maximum(np.abs(local) - boxes.size[upright], 0), axis=1)
        return bool(gap.min() > radius)

    free, navigation = 0, house.navigation
    for row in fronts(house):
        above = house.doors.pos[row] + [0, 0, 0.31 * house.doors.size[row, 2]]
        depths = [above - x * outward(house, row) for x in (0.12, 0.15)]
        free += all(is_free(point, 0.03) for point in depths)
        cell = ((depths[1][:2] - navigation.origin) / navigation.cell).astype(int)
        assert (navigation.region[:, cell[1], cell[0]] != 0).all()
    assert free >= MAX_FRONTS // 2


def test_exported_fronts_have_their_hinges(house):
    model = mujoco.MjModel.from_xml_string(*to_mjcf(house, agent=AgentBody()))
    for row in fronts(house):
        instance = house.doors.instance[row]
        joint = model.joint(f"object{house.instances.object_id[instance]}_leaf{instance}")
        assert joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE
        assert_allclose(joint.range, [house.doors.low[row], house.doors.high[row]], atol=1e-7)


def widest(house):
    """The row of the front with a wide range whose middle is nearest to a hand's height."""
    rows = [r for r in fronts(house) if house.doors.high[r] - house.doors.low[r] > np.deg2rad(80)]
    return min(rows, key=lambda r: abs(house.doors.pos[r, 2] - 1.0))


def place_before(house, row, distance):
    """Feet and yaw of an agent beyond the free edge of a front, which it faces."""
    doors, normal = house.doors, outward(house, row)
    return doors.pos[row, :2] + distance * normal[:2], float(np.arctan2(-normal[1], -normal[0]))


@pytest.fixture(scope="module")
def opened(house, bank):
    """Angles of the front that a hand opens with the fused step and in C MuJoCo, in each of 12 control steps."""
    found = {}
    for impl in ("fused", "c"):
        template = Template(PhysicsConfig(impl=impl), bank.spec)
        row = bank_row(house, bank, widest(house))
        feet, yaw = place_before(house, widest(house), 0.85)
        shut = door_angles(bank, HOUSE, "open", jax.random.key(0))
        state = physics.reset(template, bank, HOUSE, jnp.array([[*feet, 0.0]], jnp.float32), jnp.array([yaw]), shut)

        @jax.jit
        def step(state, commands, template=template):
            state = apply_hand_commands(template, bank, HOUSE, state, commands)
            state = physics.step(template, bank, HOUSE, state, jnp.zeros((1, 3)))
            return update_hands(template, bank, HOUSE, state)

        command = HandCommands.idle(1).replace(door=jnp.array([row], jnp.int32), open=jnp.array([True]))
        track = []
        for t in range(12):
            state = step(state, command if t == 0 else HandCommands.idle(1))
            track.append(np.asarray(physics.door_angle(template, state)))
        found[impl] = track
    return found


def bank_row(house, bank, row):
    return int(np.flatnonzero(np.asarray(bank.physics.door_instance[0]) == house.doors.instance[row])[0])


def test_a_hand_opens_a_front_as_in_c(house, bank, opened):
    row = bank_row(house, bank, widest(house))
    mine, truth = (np.stack(opened[impl]) for impl in ("fused", "c"))
    assert_allclose(mine, truth, atol=3e-3)
    assert abs(mine[-1, row] - house.doors.fully_open[widest(house)]) < 0.1
    others = np.delete(np.asarray(bank.fronts.mask(bank.physics, HOUSE)).nonzero()[0], 0)
    assert_allclose(np.delete(mine[-1][others], np.flatnonzero(others == row)), 0.0, atol=5e-3)


def test_pointing_at_a_front_opens_and_closes_it(house, bank):
    config = EnvConfig(
        sensors=("state",), actions="discrete", hands=True, max_aim_angle=10.0, physics=PhysicsConfig(impl="kinematic")
    )
    env = HouseholdEnv(config).bind(bank)
    row, doors, state = widest(house), house.doors, env.reset(jax.random.key(0))
    feet = place_before(house, row, 0.8)[0]

    def look_at(state, target):
        """The state with the agent before the front, its view centre on a point."""
        away = target - [*feet, AgentBody().eye_height]
        yaw, pitch = np.arctan2(away[1], away[0]), np.arctan2(away[2], np.hypot(*away[:2]))
        qpos = state.physics.qpos.at[:2].set(jnp.array(feet)).at[3].set(yaw)
        view = state.world.replace(pitch=jnp.array([max(pitch, -1.0)], jnp.float32))
        return state.replace(physics=state.physics.replace(qpos=qpos), world=view)

    step, at = jax.jit(env.step), bank_row(house, bank, row)
    angles = physics_template(config, bank.spec).layout.door_qpos
    turn = doors.fully_open[row]
    arm = (doors.pos[row, :2] - doors.pivot[row]) @ np.array(
        [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    )
    swung = np.append(doors.pivot[row] + arm, doors.pos[row, 2])
    for name, target, end in (("open", doors.pos[row], turn), ("close", swung, doors.closed[row])):
        for _ in range(5):
            state = step(look_at(state, target), env.core.action_names.index(name))
        assert abs(float(state.physics.qpos[angles][at]) - end) < 0.1, name


def test_wrong_numbers_and_states_are_refused():
    for wrong in (-1, 1000):
        with pytest.raises(ConfigError, match="max_fronts"):
            ArticulationOptions(wrong)
    with pytest.raises(ConfigError, match="state of fronts"):
        EnvConfig(fronts="ajar")
