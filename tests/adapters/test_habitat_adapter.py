"""The adapter for Habitat against formulas of Habitat's own definitions, in its frame, with SciPy's rotations."""

import gzip
import json
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from scipy.spatial.transform import Rotation
from storey_homes import homes_bank

import home_mjx.adapters.habitat as habitat
from home_mjx import HouseBank
from home_mjx.adapters.habitat.frames import from_world, rotation_of, to_world, yaw_of
from home_mjx.adapters.habitat.image_goals import goal_yaw
from home_mjx.adapters.habitat.observations import action_index, normalize_depth
from home_mjx.adapters.habitat.rearrange import pose_from_world
from home_mjx.errors import ConfigError, DatasetError

SENSORS = ("rgb", "depth", "semantic", "pointgoal_with_gps_compass", "gps", "compass", "heading")
WIDTH, HEIGHT = 6, 4
HOME = "one_storey"
TO_HABITAT = Rotation.from_euler("x", -90, degrees=True)  # turns +z to +y: the axes of the world in Habitat's


def config(**changes):
    options = {"houses": homes_bank(("one storey",)), "sensors": SENSORS, "width": WIDTH, "height": HEIGHT}
    return habitat.get_config("pointnav", **{**options, "episodes_per_house": 4, "max_episode_steps": 30, **changes})


@cache
def floor_height():
    return env_of_all().env.params.tasks.rows.start[0, 2].item()


@cache
def env_of_all():
    """An environment that tests reset, never change."""
    return habitat.Env(config())


def episode(start, goal, rotation=(0.0, 0.0, 0.0, 1.0), number=0):
    """An episode of the file format, positions on the floor in our x and y."""
    y = floor_height()
    poses = {"start_position": [start[0], y, -start[1]], "start_rotation": list(rotation)}
    goals = [{"position": [goal[0], y, -goal[1]], "radius": None}]
    own = {"episode_id": str(number), "scene_id": f"data/scenes/{HOME}.basis.glb", **poses, "goals": goals}
    return habitat.NavigationEpisode(own | {"info": {"geodesic_distance": float(np.hypot(*np.subtract(goal, start)))}})


def env_of(*episodes):
    """The same compiled environment would do, but episodes are an argument of `Env`."""
    return habitat.Env(config(), habitat.NavigationDataset(episodes, {}))


def pose_of(env):
    """Feet and rotation of the agent in Habitat's frame, by SciPy."""
    snapshot = env.env.core.snapshot(env.env.params, env._state)
    turn = TO_HABITAT * Rotation.from_euler("z", float(snapshot.pose.yaw[0])) * TO_HABITAT.inv()
    at_zero = Rotation.from_euler("y", -90, degrees=True)  # our +x, from Habitat's -z
    return TO_HABITAT.apply(np.asarray(snapshot.feet[0], float)), turn * at_zero


def to_polar(x, y):
    """Habitat's `cartesian_to_polar`."""
    return np.hypot(x, y), np.arctan2(y, x)


def heading(rotation):
    """Habitat's `_quat_to_xy_heading`."""
    x, _, z = rotation.apply([0, 0, -1])
    return to_polar(-z, x)[1]


def test_frames_agree_with_rotations_of_scipy():
    random = np.random.default_rng(0)
    for point in random.normal(size=(20, 3)):
        np.testing.assert_allclose(from_world(point), TO_HABITAT.apply(point), atol=1e-12)
        assert to_world(from_world(point)) == tuple(point)
    for angle in random.uniform(-3.1, 3.1, 20):
        quaternion = Rotation.from_euler("y", angle).as_quat()
        ahead = TO_HABITAT.inv().apply(Rotation.from_quat(quaternion).apply([0, 0, -1]))
        yaw = yaw_of(quaternion)
        np.testing.assert_allclose(ahead, [np.cos(yaw), np.sin(yaw), 0], atol=1e-12)
        again = Rotation.from_quat(rotation_of(yaw)) * Rotation.from_quat(quaternion).inv()
        assert again.magnitude() < 1e-12
    assert to_world((1.0, 2.0, 3.0), (0.5, 0.0, 0.25)) == (1.5, -3.0, 2.25)
    assert from_world((1.5, -3.0, 2.25), (0.5, 0.0, 0.25)) == (1.0, 2.0, 3.0)
    with pytest.raises(ConfigError, match="norm 1"):
        yaw_of((0, 0, 0, 2))


def test_observations_are_habitats_in_a_loop_as_users_write_it():
    """Every step against the formulas of Habitat's sensors, from poses in its frame."""
    env = env_of_all()
    observations = env.reset()
    start, first = pose_of(env)
    goal = np.array(env.current_episode.goals[0].position)
    np.testing.assert_allclose(start, env.current_episode.start_position, atol=1e-3)
    assert (first * Rotation.from_quat(env.current_episode.start_rotation).inv()).magnitude() < 1e-3
    moves = ["turn_left"] * 3 + [{"action": "MOVE_FORWARD"}, np.int64(1), 3, habitat.HabitatSimActions.turn_right] * 2
    for number, action in enumerate(moves, 1):
        observations = env.step(action)
        place, turn = pose_of(env)
        ahead = turn.inv().apply(goal - place)
        rho, phi = to_polar(-ahead[2], ahead[0])
        np.testing.assert_allclose(observations["pointgoal_with_gps_compass"], [rho, -phi], atol=1e-4)
        away = first.inv().apply(place - start)
        np.testing.assert_allclose(observations["gps"], [-away[2], away[0]], atol=1e-4)
        np.testing.assert_allclose(observations["compass"], [heading(turn.inv() * first)], atol=1e-4)
        np.testing.assert_allclose(observations["heading"], [heading(turn.inv())], atol=1e-4)
        assert env.observation_space.contains(observations)
        assert env.get_metrics()["num_steps"] == number
    shapes = {name: observations[name].shape for name in ("rgb", "depth", "semantic")}
    assert shapes == {"rgb": (HEIGHT, WIDTH, 3), "depth": (HEIGHT, WIDTH, 1), "semantic": (HEIGHT, WIDTH, 1)}
    assert observations["rgb"].dtype == np.uint8
    assert 0 < observations["depth"].max() <= 1
    assert not env.episode_over
    env.step("stop")
    assert env.episode_over
    with pytest.raises(ConfigError, match="over"):
        env.step("stop")


def test_depth_is_metres_between_its_limits():
    np.testing.assert_allclose(normalize_depth(jnp.array([0.2, 0.5, 2.75, 9.0]), 0.5, 5.0), [0, 0, 0.5, 1])


def test_measures_of_cases_by_hand():
    """A start at its goal; a walk of 1 m and back, towards -z as in Habitat: our +y. Points are centres of cells."""
    env = env_of(episode((-3.05, -0.05), (-3.05, -0.05)), episode((-3.05, -1.05), (-3.05, -0.05), number=1))
    observations = env.reset()
    np.testing.assert_array_equal(observations["pointgoal_with_gps_compass"], [0, 0])
    env.step("stop")
    measures = env.get_metrics()
    assert (measures["distance_to_goal"], measures["success"], measures["spl"]) == pytest.approx((0, 1, 1), abs=0.03)
    observations = env.reset()
    np.testing.assert_allclose(observations["pointgoal_with_gps_compass"], [1, 0], atol=1e-3)
    length = env.get_metrics()["distance_to_goal"]
    assert length == pytest.approx(1, abs=0.05)
    for _ in range(5):  # one step too far: 0.25 m beyond the goal, and back
        env.step("move_forward")
    assert env.get_metrics()["success"] == 0
    for _ in range(18):
        observations = env.step("turn_left")
    assert abs(observations["compass"][0]) == pytest.approx(np.pi, abs=1e-3)
    env.step("move_forward")
    env.step("stop")
    measures, walked = env.get_metrics(), 6 * 0.25
    assert measures["success"] == 1
    assert measures["spl"] == pytest.approx(length / max(length, walked), abs=1e-3)
    left = measures["distance_to_goal"]
    assert measures["soft_spl"] == pytest.approx((1 - left / length) * length / walked, abs=1e-3)
    assert measures["collisions"] == {"count": 0, "is_collision": False}
    assert measures["num_steps"] == 25


def test_a_top_down_map_has_the_values_and_the_frame_of_habitat():
    """A walk of 1 m along Habitat's -z: 20 cells up in the picture, with the angle pi; then a turn to the right."""
    env = habitat.Env(config(top_down_map=True), habitat.NavigationDataset((episode((-3.05, -1.05), (-2.05, 0)),), {}))
    env.reset()
    before = env.get_metrics()["top_down_map"]
    cell = env.env.bank.spec.cell
    steps = round(1 / cell)
    for _ in range(4):
        env.step("move_forward")
    for _ in range(9):
        env.step("turn_right")
    found = env.get_metrics()["top_down_map"]
    (first,), (last,) = before["agent_map_coord"], found["agent_map_coord"]
    assert np.subtract(last, first) == pytest.approx([-steps, 0], abs=1)
    assert np.cos(before["agent_angle"][0] - np.pi) == pytest.approx(1, abs=1e-5)
    assert found["agent_angle"][0] == pytest.approx(np.pi / 2, abs=1e-3)
    plan, seen = found["map"], found["fog_of_war_mask"]
    assert (plan.dtype, seen.dtype, plan.shape) == (np.uint8, np.uint8, seen.shape)
    rows, columns = np.nonzero(plan == 4)  # the start, a square
    assert (rows.mean(), columns.mean(), len(rows)) == (*first, 9)
    rows, columns = np.nonzero(plan == 6)  # the goal, 1 m to the right and 1.05 m up
    assert [rows.mean() - first[0], columns.mean() - first[1]] == pytest.approx([-1.05 / cell, 1 / cell], abs=1)
    path = plan[last[0] : first[0] - 1, first[1]].astype(int)
    assert (np.diff(path) <= 0).all()
    values = {10 + step * 245 // 30 for step in (1, 2, 3, 4, 13)}  # 4 steps, then turns on the spot
    assert values - {18} <= set(path.tolist()) <= values  # the first step is partly below the mark of the start
    assert 0 < before["fog_of_war_mask"].sum() < seen.sum()
    assert seen[first] == seen[last] == 1
    free = np.isin(plan, (1, 2, 4, 6)) | (plan >= 10)
    valid = np.pad(free, 1)
    for row, column in np.argwhere(plan == 1):
        assert valid[row : row + 3, column + 1].all() & valid[row + 1, column : column + 3].all()
    env.reset()
    assert (env.get_metrics()["top_down_map"]["map"] >= 10).sum() == 0
    with pytest.raises(ConfigError, match="top_down_map"):
        habitat.VectorEnv(config(top_down_map=True))


def test_collisions_are_forward_moves_that_are_blocked():
    env = env_of(episode((-3, -2.5), (-3, 0), rotation=(0, 1, 0, 0)))  # looks along Habitat's +z, at a wall 0.5 m away
    env.reset()
    counts = []
    for _ in range(4):
        env.step("move_forward")
        counts.append(env.get_metrics()["collisions"])
    assert counts[0] == {"count": 0, "is_collision": False}
    assert counts[-1]["is_collision"]
    assert counts[-1]["count"] == sum(one["is_collision"] for one in counts)


def test_episodes_without_a_way_or_a_house_are_refused():
    good = episode((-3, -1), (-3, 0))
    with pytest.raises(DatasetError, match=r"episodes\[1\]"):
        env_of(good, episode((-3, -1), (300, 0), number=1))
    elsewhere = habitat.NavigationEpisode({**good.fields, "scene_id": "other.glb"})
    with pytest.raises(DatasetError, match=r"no house other .*episodes\[0\]"):
        env_of(elsewhere)


def test_files_are_written_as_they_were_read(tmp_path):
    """Bit for bit, unknown fields and odd numbers included."""
    fields = dict(episode((-3, 0.1 + 0.2), (-2, -0.0)).fields)
    fields |= {"start_room": None, "shortest_paths": [[1, 2, 0]], "own": {"z": 1e-17, "a": [1.0, 2]}}
    text = json.dumps({"name": "x", "episodes": [fields], "category_to_task_category_id": {"chair": 0}}).encode()
    for number, data in enumerate((text, gzip.compress(text))):
        (tmp_path / f"{number}.json.gz").write_bytes(data)
        dataset = habitat.read_dataset(tmp_path / f"{number}.json.gz")
        habitat.write_dataset(tmp_path / "again.json.gz", dataset)
        assert gzip.decompress((tmp_path / "again.json.gz").read_bytes()) == text
    one = dataset.episodes[0]
    assert (one.house_id, one.shortest_paths, one.goals[0].radius) == (HOME, [[1, 2, 0]], None)
    packed = (tmp_path / "again.json.gz").read_bytes()
    habitat.write_dataset(tmp_path / "again.json.gz", habitat.read_dataset(tmp_path / "again.json.gz"))
    assert (tmp_path / "again.json.gz").read_bytes() == packed


def test_sampled_episodes_replay_from_their_file(tmp_path):
    env = env_of_all()
    habitat.write_dataset(tmp_path / "val.json.gz", habitat.NavigationDataset(env.episodes, {}))
    again = habitat.Env(config(data_path=tmp_path / "val.json.gz"))
    assert [dict(one.fields) for one in again.episodes] == [dict(one.fields) for one in env.episodes]
    before, after = env.env.params.tasks.rows, again.env.params.tasks.rows
    np.testing.assert_array_equal(before.start, after.start)
    np.testing.assert_array_equal(before.columns["place"], after.columns["place"])
    np.testing.assert_allclose(np.cos(before.yaw - after.yaw), 1, atol=1e-6)
    np.testing.assert_allclose(before.columns["length"], after.columns["length"], atol=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start_rotation": [0, 0, 0, 2]}, r"norm 1.*episodes\[0\].start_rotation"),
        ({"start_position": [0, float("nan"), 0]}, r"3 finite numbers.*start_position"),
        ({"goals": [{"position": [0, True, 0]}]}, r"3 finite numbers.*goals\[0\].position"),
        ({"goals": []}, "object_category"),
        ({"scene_id": 3}, "scene_id"),
        ({"info": {"geodesic_distance": None}}, r"geodesic_distance.*episodes\[0\].info"),
    ],
)
def test_broken_episodes_are_located(tmp_path, change, message):
    file = tmp_path / "bad.json.gz"
    fields = {"episode_id": "0", "scene_id": "a.glb", "start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1]}
    file.write_bytes(gzip.compress(json.dumps({"episodes": [fields | {"goals": []} | change]}).encode()))
    with pytest.raises(DatasetError, match=message):
        habitat.read_dataset(file)


def test_broken_files_are_refused(tmp_path):
    file = tmp_path / "bad.json.gz"
    whole = gzip.compress(b'{"episodes": []}' * 9)
    for data, message in ((whole[:-9], "broken gzip"), (b"{", "not JSON"), (b"[]", "list `episodes`")):
        file.write_bytes(data)
        with pytest.raises(DatasetError, match=message):
            habitat.read_dataset(file)


def test_actions_and_keys():
    names = ("stop", "move_forward", "turn_left", "turn_right")
    assert [action_index(x, names) for x in ("STOP", {"action": 1}, np.array([2]), "turn_right")] == [0, 1, 2, 3]
    for wrong in (4, -1, 1.0, True, "jump", None, {"name": 1}):
        with pytest.raises(ConfigError):
            action_index(wrong, names)
    overrides = ["habitat.environment.max_episode_steps=9", "habitat.dataset.data_path=a/{split}.json.gz"]
    found = habitat.get_config("benchmark/nav/objectnav/objectnav_hm3d.yaml", overrides)
    assert (found.task, found.max_episode_steps, found.data_path) == ("objectnav", 9, "a/{split}.json.gz")
    with pytest.raises(ConfigError, match=r"Did you mean `habitat\.seed`"):
        habitat.get_config("pointnav", ["habitat.sed=1"])
    with pytest.raises(ConfigError, match=r"no known task.*read_rearrangement"):
        habitat.get_config("rearrange")


def test_a_batch_is_its_environments_and_resets_itself():
    """Environment i of 2 has the episodes i, i + 2; outputs of a final step are of the old episode."""
    envs, alone = habitat.VectorEnv(config(), num_envs=2), env_of_all()
    alone.seed(0)
    first, observations = alone.reset(), envs.reset()
    np.testing.assert_allclose(
        observations[0]["pointgoal_with_gps_compass"], first["pointgoal_with_gps_compass"], atol=1e-5
    )
    for action in ("move_forward", "turn_left", "move_forward"):
        outputs = envs.step([action, "turn_right"])
        seen = alone.step(action)
        for name in SENSORS[3:]:
            np.testing.assert_allclose(outputs[0][0][name], seen[name], atol=1e-4)
        now = alone.get_metrics()
        assert outputs[0][3].pop("collisions") == now.pop("collisions")
        assert outputs[0][3] == pytest.approx(now, abs=1e-4)
    outputs = envs.step(["stop", 1])
    alone.step("stop")
    assert [output[2] for output in outputs] == [True, False]
    assert outputs[0][3]["num_steps"] == 4
    assert outputs[0][3]["distance_to_goal"] == pytest.approx(alone.get_metrics()["distance_to_goal"], abs=1e-4)
    assert [one.episode_id for one in envs.current_episodes()] == ["2", "1"]
    assert envs.step([1, 1])[0][3]["num_steps"] == 1
    np.testing.assert_array_equal(outputs[0][0]["gps"], [0, 0])
    with pytest.raises(ConfigError, match="2 actions"):
        envs.step([0])


def test_rewards_of_a_subclass_and_object_goals():
    """ObjectNav by `RLEnv`: the category's number is that of the episode's name."""
    chair = Furniture((-2.0, 1.0), category="chair")
    bank = HouseBank.from_compiled([shoebox(furniture=[chair])])
    options = {"houses": bank, "sensors": ("objectgoal",), "episodes_per_house": 2, "max_episode_steps": 3}
    options["options"] = {"min_length": 0.0}

    class Steps(habitat.RLEnv):
        def get_reward(self, observations):
            return -float(self.habitat_env.get_metrics()["num_steps"])

    env = Steps(habitat.get_config("objectnav", **options))
    number = env.reset()["objectgoal"]
    assert number.shape == (1,)
    assert number.dtype == np.int64
    assert env.current_episode.object_category == "chair"
    results = [env.step("look_up")[1:] for _ in range(3)]
    assert [(reward, done) for reward, done, _ in results] == [(-1, False), (-2, False), (-3, True)]
    config = habitat.get_config("objectnav", **options)
    again = habitat.Env(config, habitat.NavigationDataset(env.episodes, {}))
    rows, old = again.env.params.tasks.rows, env.habitat_env.env.params.tasks.rows
    np.testing.assert_array_equal(rows.columns["descriptor"], old.columns["descriptor"])
    np.testing.assert_array_equal(rows.start, old.start)
    for category, message in (("tv_monitor", "no such object"), ("dragon", "dragon")):
        odd = habitat.NavigationEpisode({**env.episodes[1].fields, "object_category": category})
        with pytest.raises(DatasetError, match=rf"{message}.*episodes\[1\]"):
            habitat.Env(config, habitat.NavigationDataset((env.episodes[0], odd), {}))


def test_goals_of_categories_and_content_beside_a_file(tmp_path):
    """Files of ObjectNav: goals by scene and category, and one file per scene in the folder `content`."""
    fields = {"episode_id": "0", "scene_id": "s/a.glb", "start_position": [0, 0, 0], "start_rotation": [0, 0, 0, 1]}
    goal = {"position": [1.0, 2.0, 3.0], "radius": 0.5, "view_points": []}
    (tmp_path / "content").mkdir()
    parts = {"a": {"a.glb_bed": [goal]}, "b": {"b.glb_bed": []}}
    for name, goals in parts.items():
        own = fields | {"goals": [], "object_category": "bed", "scene_id": f"s/{name}.glb"}
        text = json.dumps({"goals_by_category": goals, "episodes": [own]}).encode()
        (tmp_path / "content" / f"{name}.json.gz").write_bytes(gzip.compress(text))
    (tmp_path / "val.json.gz").write_bytes(gzip.compress(b'{"episodes": [], "name": "val"}'))
    dataset = habitat.read_dataset(tmp_path / "val.json.gz")
    assert [one.house_id for one in dataset.episodes] == ["a", "b"]
    found = [dataset.goals_of(one) for one in dataset.episodes]
    assert [[(goal.position, goal.radius) for goal in goals] for goals in found] == [[((1.0, 2.0, 3.0), 0.5)], []]
    assert dataset.fields["name"] == "val"


def test_offsets_lead_from_the_frame_of_a_scene_to_the_world(tmp_path):
    """A house that its compiler moved by 2 m along x and -3 m along y: y is Habitat's -z."""
    env, offsets = env_of_all().env, {HOME: (2.0, -3.0, 0.5)}
    plain = env_of_all().episodes[0].start_position
    moved = habitat.to_episodes(env.params.tasks, env.bank, offsets)
    np.testing.assert_allclose(moved[0].start_position, np.add(plain, (-2.0, -0.5, -3.0)), atol=1e-6)
    rows = habitat.to_tasks(habitat.NavigationDataset(moved, {}), env.bank, 0.2, offsets, tmp_path / "x").rows
    np.testing.assert_allclose(rows.start, env.params.tasks.rows.start, atol=1e-6)
    with pytest.raises(DatasetError, match=r"episodes\[0\]"):
        habitat.to_tasks(habitat.NavigationDataset(moved, {}), env.bank, 0.2, {}, tmp_path / "x")


def test_goal_images_are_those_that_an_agent_sees_there(tmp_path):
    """An agent that starts at the goal in the direction of the image sees the image."""
    options = {"houses": homes_bank(("one storey",)), "width": 8, "height": 6, "episodes_per_house": 2}
    image = habitat.get_config("benchmark/nav/imagenav/imagenav_gibson.yaml", **options)
    there, away = (-3.05, -0.05), (-2.05, 1.05)
    env = habitat.Env(image, habitat.NavigationDataset((episode(away, there), episode(there, away, number=1)), {}))
    first = env.reset()
    assert env.observation_space.contains(first)
    turn = rotation_of(goal_yaw(env.current_episode))
    assert np.array_equal(env.step("turn_left")["imagegoal"], first["imagegoal"])
    assert not np.array_equal(env.reset()["imagegoal"], first["imagegoal"])
    seen = habitat.Env(image, habitat.NavigationDataset((episode(there, away, turn),), {})).reset()["rgb"]
    assert np.ptp(seen) > 20
    assert abs(seen.astype(int) - first["imagegoal"]).mean() < 1  # places within the file's float32
    odd = habitat.NavigationEpisode({**episode(there, away).fields, "object_category": "bed", "goal_image_id": 3})
    with pytest.raises(DatasetError, match=r"InstanceImageNav is not replayed.*episodes\[0\]"):
        habitat.Env(image, habitat.NavigationDataset((odd,), {}))
    with pytest.raises(ConfigError, match="imagegoal"):
        habitat.VectorEnv(image)


REARRANGEMENT = {
    "episode_id": 7,
    "scene_id": "configs/scenes/v3_sc0_staging_00.scene_instance.json",
    "scene_dataset_config": "replicaCAD.scene_dataset_config.json",
    "start_position": [1.0, 0.1, -2.0],
    "start_rotation": [0.0, 0.0, 0.0, 1.0],
    "info": {"object_labels": {"024_bowl_:0000": "any_targets|0"}},
    "ao_states": {"fridge_:0000": {"2": 1.5}},
    "rigid_objs": [["024_bowl.object_config.json", [[0, 0, 1, 2], [0, 1, 0, 0.9], [-1, 0, 0, -3], [0, 0, 0, 1]]]],
    "targets": {"024_bowl_:0000": [[1, 0, 0, 0], [0, 0, -1, 0.5], [0, 1, 0, 4], [0, 0, 0, 1]]},
    "target_receptacles": [["receptacle_aabb_TvStnd1_Top3", None]],
}


def test_rearrangements_are_read_in_the_world_frame_and_written_as_they_were(tmp_path):
    """A point of an object and its image, by SciPy's turn of the axes."""
    text = json.dumps({"config": None, "episodes": [REARRANGEMENT], "own": 1}).encode()
    (tmp_path / "a.json.gz").write_bytes(gzip.compress(text))
    dataset = habitat.read_rearrangement(tmp_path / "a.json.gz")
    habitat.write_dataset(tmp_path / "b.json.gz", dataset)
    assert gzip.decompress((tmp_path / "b.json.gz").read_bytes()) == text
    (one,) = dataset.episodes
    assert (one.house_id, one.ao_states) == ("v3_sc0_staging_00", {"fridge_:0000": {"2": 1.5}})
    pairs = [(one.rigid_objs[0][1], one.object_poses((1, 2, 3))[0][1])]
    pairs.append((one.targets["024_bowl_:0000"], one.target_poses((1, 2, 3))["024_bowl_:0000"]))
    for before, after in pairs:
        point = np.array([0.1, 0.2, 0.3])
        expected = np.add(TO_HABITAT.inv().apply(before[:3, :3] @ point + before[:3, 3]), (1, 2, 3))
        got = after[:3, :3] @ TO_HABITAT.inv().apply(point) + after[:3, 3]
        np.testing.assert_allclose(got, expected, atol=1e-12)
        np.testing.assert_allclose(pose_from_world(after, (1, 2, 3)), before, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"targets": {"a": [[1, 0], [0, 1]]}}, r"rigid transform.*targets\[a\]"),
        ({"targets": {"a": (2 * np.eye(4)).tolist()}}, r"rigid transform.*targets\[a\]"),
        ({"rigid_objs": [["a.json", [[float("nan")] * 4] * 4]]}, r"rigid transform.*rigid_objs\[0\]"),
        ({"rigid_objs": ["a"]}, r"name and a transform.*rigid_objs\[0\]"),
        ({"targets": None}, "`targets`"),
        ({"ao_states": [1]}, "ao_states"),
    ],
)
def test_broken_rearrangements_are_located(tmp_path, change, message):
    file = tmp_path / "bad.json"
    file.write_text(json.dumps({"episodes": [REARRANGEMENT | change]}))
    with pytest.raises(DatasetError, match=message):
        habitat.read_rearrangement(file)
