"""Arrangements: everything rests, nothing is in anything, agents can start and walk."""

import functools
from dataclasses import replace
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from boxes_by_hand import Solids
from generated import generate_flats
from scipy import ndimage
from scipy.spatial.transform import Rotation

import home_mjx
from home_mjx import HouseBank, HouseSet, physics
from home_mjx.errors import ConfigError
from home_mjx.navigation.doors import door_angles
from home_mjx.navigation.spawn import random_arrangement
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.arrangements import build, with_arrangements
from home_mjx.tasks.arrangements.house_layout import HouseLayout

NUM = 3
KEY = jax.random.key(7)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Two generated houses, their bank, and the same bank with arrangements; nothing is found in a cache."""
    patch, folder = pytest.MonkeyPatch(), tmp_path_factory.mktemp("arrangements")
    patch.setattr(build, "cache_folder", lambda: folder)
    root = tmp_path_factory.mktemp("generated")
    houses = HouseSet(root, ids=generate_flats(root, range(2))).load(False)
    bank = HouseBank.from_compiled(houses)
    arranged, settled = with_arrangements(bank, NUM, KEY)
    yield SimpleNamespace(root=root, houses=houses, bank=bank, arranged=arranged, settled=settled, folder=folder)
    patch.undo()


def poses_of(made, house, arrangement):
    """Of the bodies that a house has."""
    used = np.asarray(made.bank.physics.body_valid[house])
    return np.asarray(made.arranged.physics.arrangement_pose[house, arrangement])[used].astype(float)


def each(made):
    return [(house, p) for house in range(len(made.houses)) for p in range(NUM)]


def moved_of(made, house, arrangement):
    """Bodies that are elsewhere than in the file."""
    away = poses_of(made, house, arrangement)[:, :3] - made.houses[house].bodies.pos
    return np.linalg.norm(away, axis=1) > 1e-3


def test_a_bank_has_none_at_first_and_nothing_else_changes(made):
    assert made.bank.physics.arrangement_pose.shape == (2, 0, made.bank.spec.num_bodies, 7)
    assert made.arranged.physics.arrangement_pose.shape == (2, NUM, made.bank.spec.num_bodies, 7)
    without = made.arranged.replace(
        physics=made.arranged.physics.replace(arrangement_pose=made.bank.physics.arrangement_pose)
    )
    jax.tree.map(np.testing.assert_array_equal, without, made.bank)


def test_most_things_are_elsewhere_and_every_one_is_counted(made):
    for house, p in each(made):
        drawn = HouseLayout.from_bank(made.bank, house).is_selected
        moved = moved_of(made, house, p)
        assert not (moved & ~drawn).any()
        assert moved.sum() == made.settled.moved[house, p]
        assert made.settled.moved[house, p] + made.settled.unmoved[house, p] == drawn.sum()
        assert moved.sum() >= 0.6 * drawn.sum() > 3
    assert not made.settled.shifted.any()
    assert not made.settled.unsettled.any()


def test_equal_keys_give_equal_bits_and_others_others(made, monkeypatch, tmp_path):
    monkeypatch.setattr(build, "cache_folder", lambda: tmp_path)
    again, settled = with_arrangements(made.bank, NUM, jax.random.PRNGKey(7))
    np.testing.assert_array_equal(again.physics.arrangement_pose, made.arranged.physics.arrangement_pose)
    np.testing.assert_array_equal(settled.moved, made.settled.moved)
    drawn = np.concatenate([poses_of(made, h, p)[moved_of(made, h, p), :3].ravel() for h, p in each(made)])
    other, *_ = build._place(made.bank, NUM, np.array([0, 8]), False)
    shift = np.linalg.norm(np.asarray(other - made.arranged.physics.arrangement_pose)[..., :3], axis=-1)
    assert (shift > 0.02).sum() > 0.8 * len(drawn) / 3
    for house in range(2):
        assert all((poses_of(made, house, 0) != poses_of(made, house, p)).any() for p in range(1, NUM))


def test_everything_rests_for_ten_seconds(made):
    template = Template(PhysicsConfig(), made.bank.spec)

    @functools.partial(jax.jit, static_argnums=1)
    def farthest(bank, state, house, number):
        start = bank.navigation.start[house, :1]
        angle = door_angles(bank, house, state, KEY)
        data = physics.reset(template, bank, house, start, jnp.zeros(1), angle, number)
        first, _ = physics.body_pose(template, data)

        def step(data, _):
            data = physics.step(template, bank, house, data, jnp.zeros((1, 3)))
            return data, jnp.linalg.norm(physics.body_pose(template, data)[0] - first, axis=-1)

        return jax.lax.scan(step, data, None, length=100)[1].max(axis=0)

    house, number = np.array(each(made), np.int32).T
    # Where a start is in a moved thing, an agent would push it: resets draw another arrangement there.
    free = [p == _first_free(made.arranged, h, p) for h, p in each(made)]
    run = jax.vmap(farthest, (None, None, 0, 0))
    moved = run(made.arranged, "open", jnp.asarray(house[free]), jnp.asarray(number[free]))
    assert sum(free) >= 4
    assert float(moved.max()) < 1e-3


def _first_free(bank, house, p):
    """`p`, if an agent can stand at the first start in that arrangement alone; else -1."""
    alone = bank.replace(physics=bank.physics.replace(arrangement_pose=bank.physics.arrangement_pose[:, p : p + 1]))
    found = random_arrangement(alone, jnp.int32(house), bank.navigation.start[house, :1], KEY)
    return p if int(found) == 0 else -1


@pytest.mark.parametrize("house", [0, 1])
def test_everything_rests_in_c_mujoco(made, house):
    """On the exported house; everything there is solved by other code."""
    compiled, poses = made.houses[house], poses_of(made, house, 1)
    bodies = replace(compiled.bodies, pos=poses[:, :3], quat=poses[:, 3:])
    drift = measure_rest_drift(*to_mjcf(replace(compiled, bodies=bodies)), seconds=10.0)
    assert len(drift) == len(poses)
    assert max(drift.values()) < 1e-3


def depths(pos, turn, half, others_pos, others_turn, others_half):
    """How deep a box is in each of others, by all 15 separating axes [m]; negative: apart."""
    crosses = np.cross(turn.T[None, :, None], others_turn.transpose(0, 2, 1)[:, None]).reshape(-1, 9, 3)
    length = np.linalg.norm(crosses, axis=-1, keepdims=True)
    own = np.broadcast_to(turn.T, (len(others_pos), 3, 3))
    axes = np.concatenate([own, others_turn.transpose(0, 2, 1), crosses / np.maximum(length, 1e-9)], axis=1)
    reach = (abs(axes @ turn) * half).sum(axis=-1)
    reach += (abs(np.einsum("naj,njk->nak", axes, others_turn)) * others_half[:, None]).sum(axis=-1)
    over = reach - abs(np.einsum("naj,nj->na", axes, others_pos - pos))
    over[:, 6:][length[..., 0] < 1e-3] = np.inf
    return over.min(axis=1)


def test_depths_are_those_of_boxes_beside_one_another():
    turn, half = np.eye(3), np.ones(3)
    corner = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    found = depths(
        np.zeros(3), turn, half, np.array([[1.9, 0, 0], [0, 3.0, 0]]), np.stack([turn, corner]), np.ones((2, 3))
    )
    np.testing.assert_allclose(found, [0.1, 2**0.5 + 1 - 3], atol=1e-9)


def test_nothing_is_in_anything(made):
    for house, p in each(made):
        compiled, poses = made.houses[house], poses_of(made, house, p)
        solids, turns = Solids(compiled), Rotation.from_quat(poses[:, 3:], scalar_first=True).as_matrix()
        size = compiled.bodies.size
        for k in range(len(poses)):
            rest = np.arange(len(poses)) != k
            pos = np.concatenate([solids.pos, poses[rest, :3]])
            turn, half = np.concatenate([solids.turn, turns[rest]]), np.concatenate([solids.size, size[rest]])
            assert depths(poses[k, :3], turns[k], size[k], pos, turn, half).max() < 0.005


def test_things_lie_wholly_on_something_in_their_own_rooms(made):
    """Below each lower corner is the floor, a box that stays or another body, within 2 mm."""
    for house, p in each(made):
        compiled, poses = made.houses[house], poses_of(made, house, p)
        size, room = compiled.bodies.size, rooms_of_bodies(compiled)
        with_bodies = replace_boxes(compiled, poses)
        for k in np.flatnonzero(moved_of(made, house, p)):
            turn = Rotation.from_quat(poses[k, 3:], scalar_first=True).as_matrix()
            corners = poses[k, :3] + (np.array([(x, y, -1) for x in (-1, 1) for y in (-1, 1)]) * size[k]) @ turn.T
            below = with_bodies(k).below(corners + np.array([0, 0, 0.003]))
            np.testing.assert_allclose(corners[:, 2], below, atol=2e-3)
            assert set(room_of(compiled, np.vstack([corners, poses[k, :3]]))) == {room[k]}


def replace_boxes(compiled, poses):
    def without(k):
        solids, rest = Solids(compiled), np.arange(len(poses)) != k
        turn = Rotation.from_quat(poses[rest, 3:], scalar_first=True).as_matrix()
        solids.pos = np.concatenate([solids.pos, poses[rest, :3]])
        solids.turn = np.concatenate([solids.turn, turn])
        solids.size = np.concatenate([solids.size, compiled.bodies.size[rest]])
        solids.reach = np.linalg.norm(solids.size, axis=1)
        return solids

    return without


def rooms_of_bodies(compiled):
    return compiled.semantics[compiled.instances.semantic[compiled.bodies.instance], Semantic.ROOM]


def room_of(compiled, points):
    """By the outlines of the rooms."""
    from home_mjx.geometry.polygons import find_smallest_room

    return find_smallest_room(compiled.rooms, np.arange(len(compiled.rooms.type)), points[:, :2])


def test_agents_can_walk_between_all_goals_and_free_starts(made):
    """Flood fill of the home region without what is near a body, by the boxes' own distances."""
    for house, p in each(made):
        compiled, poses = made.houses[house], poses_of(made, house, p)
        n = compiled.navigation
        grid = np.stack(np.meshgrid(*[np.arange(s) for s in n.home_mask.shape[:0:-1]]), axis=-1)
        points = np.concatenate([(grid + 0.5) * n.cell + n.origin, np.full((*grid.shape[:2], 1), n.floor[0])], axis=-1)
        near = np.zeros(grid.shape[:2], bool)
        for k in np.flatnonzero(moved_of(made, house, p)):
            near |= distance(points, poses[k], compiled.bodies.size[k]) < 0.15
        label, _ = ndimage.label(n.home_mask[0] & ~near)
        cell = np.floor((n.goal[:, :2] - n.origin) / n.cell).astype(int)
        goals = label[cell[:, 1], cell[:, 0]]
        assert goals[0] > 0
        assert set(goals) == {goals[0]}
        assert (label == goals[0]).sum() == (label > 0).sum()


def distance(points, pose, half):
    """In the plan, from agents of 1.6 m on a floor to a body."""
    turn = Rotation.from_quat(pose[3:], scalar_first=True).as_matrix()
    at = points.copy()
    at[..., 2] = np.clip(pose[2], points[..., 2], points[..., 2] + 1.6)
    return np.linalg.norm(np.maximum(abs((at - pose[:3]) @ turn) - half, 0), axis=-1)


@pytest.fixture(scope="module")
def env(made):
    return home_mjx.make("PointNav-v0", made.arranged, arrangement="random", sensors=("state",))


def test_resets_draw_arrangements_in_which_agents_have_room(made, env):
    keys = jax.random.split(KEY, 256)
    states = jax.jit(jax.vmap(env.reset))(keys)
    template = env.core.template(env.bank)
    pos, quat = jax.vmap(lambda data: physics.body_pose(template, data))(states.physics)
    agent, _ = jax.vmap(lambda data: physics.agent_pose(template, data))(states.physics)
    houses, drawn = np.asarray(states.world.house), []
    poses = np.concatenate([pos, quat], axis=-1)
    for e in range(len(keys)):
        used = np.asarray(made.bank.physics.body_valid[houses[e]])
        mine = [p for p in range(NUM) if (poses[e, used] == np.float32(poses_of(made, houses[e], p))).all()]
        if not mine:  # there is room in none
            np.testing.assert_array_equal(pos[e, used], made.bank.physics.body_pos[houses[e]][used])
        drawn.append((int(houses[e]), *(mine or [-1])))
        feet = np.asarray(agent[e, 0], float) - [0, 0, 0.8]
        source = np.asarray(states.world.source[e], float) - [0, 0, 1.0]
        for pose, half in zip(poses[e, used].astype(float), made.houses[houses[e]].bodies.size, strict=True):
            assert distance(feet, pose, half) > 0.1
            assert distance(source, pose, half) > 0.1
    counts = {case: drawn.count(case) for case in set(drawn)}
    assert sum(counts.pop((house, -1), 0) for house in range(2)) < 0.03 * len(keys)
    assert set(counts) == set(each(made))
    assert min(counts.values()) > 20  # of 43


def test_equal_keys_reset_alike_and_placed_is_as_ever(made, env):
    keys = jax.random.split(KEY, 8)
    reset = jax.jit(jax.vmap(env.reset))
    jax.tree.map(np.testing.assert_array_equal, reset(keys), reset(keys))
    placed = home_mjx.make("PointNav-v0", made.arranged, sensors=("state",))
    before = home_mjx.make("PointNav-v0", made.bank, sensors=("state",))
    ours, theirs = (jax.jit(jax.vmap(e.reset))(keys) for e in (placed, before))
    jax.tree.map(np.testing.assert_array_equal, ours, theirs)
    jax.tree.map(np.testing.assert_array_equal, ours.world, reset(keys).world)  # starts do not depend on it


def test_where_there_is_room_in_none_things_are_as_placed(made):
    pose = poses_of(made, 0, 0)[0]
    full = made.arranged.physics.arrangement_pose[:, :1]
    bank = made.arranged.replace(physics=made.arranged.physics.replace(arrangement_pose=full))
    point = jnp.asarray([[pose[0], pose[1], made.houses[0].navigation.floor[0]]], jnp.float32)
    assert int(random_arrangement(bank, jnp.int32(0), point, KEY)) == -1
    template = Template(PhysicsConfig(), bank.spec)
    data = physics.reset(template, bank, jnp.int32(0), point, jnp.zeros(1), None, -1)
    used = np.asarray(bank.physics.body_valid[0])
    np.testing.assert_array_equal(physics.body_pose(template, data)[0][used], bank.physics.body_pos[0][used])


def test_what_falls_is_put_back_and_counted(made, monkeypatch, tmp_path):
    monkeypatch.setattr(build, "cache_folder", lambda: tmp_path)
    chosen, dropped = build.choose_candidates, []

    def in_the_air(house, places, order):
        boxes, moved = chosen(house, places, order)
        first = np.flatnonzero(moved)[0]
        dropped.append(first)
        boxes.center[first, 2] += 0.1
        return boxes, moved

    monkeypatch.setattr(build, "choose_candidates", in_the_air)
    bank, settled = with_arrangements(made.bank, NUM, KEY)
    np.testing.assert_array_equal(settled.moved, made.settled.moved - 1)
    np.testing.assert_array_equal(settled.unmoved, made.settled.unmoved + 1)
    assert not settled.unsettled.any()
    for (house, p), k in zip(each(made), dropped, strict=True):
        found = np.asarray(bank.physics.arrangement_pose[house, p, k, :3])
        np.testing.assert_allclose(found, made.houses[house].bodies.pos[k], atol=2e-3)


def test_arrangements_are_kept_on_disk_and_broken_ones_made_again(made, monkeypatch, caplog):
    (entry,) = (made.folder / "arrangements").iterdir()
    whole, make = entry.read_bytes(), build._generate
    monkeypatch.setattr(build, "_generate", lambda *_: pytest.fail("made again"))
    again, settled = with_arrangements(made.bank, NUM, KEY)
    np.testing.assert_array_equal(again.physics.arrangement_pose, made.arranged.physics.arrangement_pose)
    np.testing.assert_array_equal(settled.unmoved, made.settled.unmoved)
    with pytest.raises(pytest.fail.Exception):
        with_arrangements(made.bank, NUM + 1, KEY)
    monkeypatch.setattr(build, "_generate", make)
    entry.write_bytes(whole[: len(whole) // 2])
    again, _ = with_arrangements(made.bank, NUM, KEY)
    np.testing.assert_array_equal(again.physics.arrangement_pose, made.arranged.physics.arrangement_pose)
    assert entry.read_bytes() == whole
    assert "broken" in caplog.text


def test_what_cannot_be_is_refused(made):
    with pytest.raises(ConfigError, match="the bank has none"):
        home_mjx.make("PointNav-v0", made.bank, arrangement="random")
    with pytest.raises(ConfigError, match="arrangement"):
        home_mjx.make("PointNav-v0", made.bank, arrangement="shuffled")
    with pytest.raises(ConfigError, match="num_arrangements"):
        with_arrangements(made.bank, 0, KEY)


def test_make_arranges_the_houses_that_it_loads(made, monkeypatch):
    asked = []

    def few(bank, num, key, progress):
        asked.append(num)
        return made.arranged, made.settled

    monkeypatch.setattr(home_mjx.tasks.arrangements, "with_arrangements", few)
    env = home_mjx.make("PointNav-v0", made.root, num_houses=2, arrangement="random", sensors=("state",))
    assert env.bank is made.arranged
    home_mjx.make("PointNav-v0", made.root, num_houses=2, sensors=("state",))
    assert asked == [8]
