import dataclasses
import functools
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from checked import checked
from generated import generate_flats
from handmade import Furniture, shoebox
from storey_homes import homes_bank

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.env_factory import make_core
from home_mjx.errors import ConfigError, DatasetError, OutOfRangeError, UnknownIdError
from home_mjx.houses import load_bank
from home_mjx.navigation.grid import cell_at_feet, geodesic_distance
from home_mjx.registry import EnvSpec
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.episodes import (
    load_episodes,
    load_episodes_or_tasks,
    read_house_ids,
    sample_episodes,
    save_episodes,
)
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.suite.navigation import RoomNav
from home_mjx.tasks.suite.point_nav import PointNav
from home_mjx.tasks.suite.task_io import save_tasks


def houses():
    plain = shoebox(furniture=[Furniture((0.0, 0.5), size=(3.0, 0.3, 1.0))])
    other = shoebox((8.0, 5.0, 3.0), furniture=[Furniture((1.0, 1.0), mass=5.0)])
    return [dataclasses.replace(plain, id="a"), dataclasses.replace(other, id="b")]


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    return HouseBank.from_compiled(houses())


@pytest.fixture(scope="module")
def env(bank) -> Env:
    return HouseholdEnv(make_config(sensors=("state", "goal"))).bind(bank)


def test_episodes_have_the_length_that_was_asked_for(bank):
    episodes = sample_episodes(bank, 200, min_length=2.0, max_length=4.0)
    assert np.bincount(episodes.house).tolist() == [100, 100]
    measure = jax.jit(jax.vmap(lambda e: geodesic_distance(bank, e.house, e.columns["goal"], e.start)))
    length = np.asarray(measure(episodes))
    np.testing.assert_allclose(length, episodes.columns["length"], rtol=1e-6)
    assert (length >= 2.0).all()
    assert (length <= 4.0).all()
    goals = bank.navigation.goal[episodes.house, episodes.columns["goal"]]
    straight = np.linalg.norm(goals - episodes.start, axis=-1)
    assert (length >= straight - 0.01).all()
    assert len(np.unique(episodes.start[:, 0])) > 190
    assert len(np.unique(np.asarray(episodes.columns["goal"]))) > 10


def test_the_same_seed_gives_the_same_episodes(bank):
    first, again, other = (sample_episodes(bank, 20, seed) for seed in (3, 3, 4))
    jax.tree.map(np.testing.assert_array_equal, first, again)
    assert (np.asarray(first.start) != np.asarray(other.start)).any()


def test_lengths_that_do_not_occur_are_refused(bank):
    with pytest.raises(ConfigError, match="house a"):
        sample_episodes(bank, 2, min_length=90.0)


@pytest.mark.parametrize(
    "change",
    [{"yaw": np.inf}, {"yaw": None}, {"length": -5.0}, {"length": np.inf}, {"start": [900.0, 900.0, 0.0]},
     {"start": [0.0, 0.0, 50.0]}, {"start": [np.nan] * 3}, {"start": [0.0, 0.5, 0.0]}],
)  # fmt: skip
def test_impossible_episodes_are_refused(bank, tmp_path, change):
    path = tmp_path / "e.jsonl"
    save_episodes(path, bank, sample_episodes(bank, 2))
    first = path.read_text().splitlines()[0]
    house = {"house": "a"} if "start" in change else {}
    path.write_text(first + "\n" + json.dumps(json.loads(first) | change | house) + "\n")
    with pytest.raises(DatasetError, match="line 2"):
        load_episodes(path, bank)


def test_files_keep_episodes_for_any_bank_of_the_houses(bank, tmp_path):
    episodes = sample_episodes(bank, 12)
    save_episodes(tmp_path / "e.jsonl", bank, episodes)
    jax.tree.map(np.testing.assert_array_equal, load_episodes(tmp_path / "e.jsonl", bank), episodes)
    turned = HouseBank.from_compiled(houses()[::-1])
    other = load_episodes(tmp_path / "e.jsonl", turned)
    np.testing.assert_array_equal(other.house, 1 - np.asarray(episodes.house))
    np.testing.assert_array_equal(other.columns["goal"], episodes.columns["goal"])
    assert len((tmp_path / "e.jsonl").read_text().splitlines()) == 12


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"house": "c"}, "no house c"),
        ({"goal": [9.0, 9.0, 0.0]}, "no goal"),
        ({"start": [0.0, 1.0]}, "three finite"),
        ({"goal": [float("nan"), 0.0, 0.0]}, "three finite"),
        ({"yaw": "north"}, "north"),
        ({"length": None}, "`length` must be a finite number, got null"),
        ({"length": -1.0}, "at least 0"),
        ({"length": True}, "`length` must be a finite number, got true"),
        ({"yaw": [1.0]}, "`yaw` must be a finite number"),
        ({"start": [[0.0], [1.0, 2.0], 3.0]}, "`start` must be three finite numbers"),
        ({"start": "here"}, "`start` must be three finite numbers, got"),
        ({"goal": {}}, "`goal` must be three finite numbers, got {}"),
        ({"house": ["a"]}, "no house"),
    ],
)
def test_broken_lines_are_named(bank, tmp_path, change, words):
    path = tmp_path / "e.jsonl"
    save_episodes(path, bank, sample_episodes(bank, 2))
    first, second = path.read_text().splitlines()
    path.write_text(f"{first}\n{json.dumps(json.loads(second) | change)}\n")
    with pytest.raises(DatasetError, match=words) as caught:
        load_episodes(path, bank)
    assert caught.value.element == "line 2"


@pytest.mark.parametrize("wrong", [lambda x: 1.0, lambda x: 0.0, lambda x: x + 0.3, lambda x: 0.9 * x])
def test_lengths_of_other_paths_are_refused(bank, tmp_path, wrong):
    """SPL would be computed with them; the message has the right one. What rounding changes is read."""
    path = tmp_path / "e.jsonl"
    save_episodes(path, bank, sample_episodes(bank, 2, min_length=3.0))
    first, second = path.read_text().splitlines()
    line = json.loads(second)
    path.write_text(f"{first}\n{json.dumps(line | {'length': round(line['length'], 1)})}\n")
    assert len(load_episodes(path, bank)) == 2
    path.write_text(f"{first}\n{json.dumps(line | {'length': wrong(line['length'])})}\n")
    with pytest.raises(DatasetError, match=f"shortest path from start to goal is {line['length']:.2f} m") as caught:
        load_episodes(path, bank)
    assert caught.value.element == "line 2, length"


def test_no_episodes_are_refused(bank, tmp_path):
    (tmp_path / "e.jsonl").write_text("")
    with pytest.raises(DatasetError, match="no episode"):
        load_episodes(tmp_path / "e.jsonl", bank)


def test_an_environment_replays_an_episode(bank, env):
    episodes = sample_episodes(bank, 8, min_length=2.0)
    keys = jax.random.split(jax.random.key(0), 8)
    params = env.with_tasks(episodes).params
    states = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0, None, 0)))(
        params, keys, None, jnp.arange(8)
    )
    np.testing.assert_array_equal(states.world.house, episodes.house)
    np.testing.assert_array_equal(states.task.goal, episodes.columns["goal"])
    np.testing.assert_allclose(states.task.distance[:, 0], episodes.columns["length"], rtol=1e-6)
    np.testing.assert_allclose(states.physics.qpos[:, :2], episodes.start[:, :2], atol=1e-6)
    with pytest.raises(ConfigError, match="with_tasks"):
        env.reset(keys[0], episode=0)


def test_episodes_out_of_range_are_refused(bank):
    episodes = sample_episodes(bank, 8)
    assert episodes.pick(7).house.shape == ()
    for index in (8, -1, jnp.array([0, 100])):
        with pytest.raises(OutOfRangeError, match="episodes 0 to 7"):
            episodes.pick(index)


def test_automatic_resets_evaluate_every_episode_once(bank, env):
    """Seven rows in three environments: 0 1 2, 3 4 5, 6 0 1, each with its own start."""
    episodes = sample_episodes(bank, 7, min_length=2.0)
    core = HouseholdEnv(make_config(sensors=("state",), episode_length=1))
    batch = AutoReset(core).bind(env.with_tasks(episodes).params)
    states = jax.jit(batch.reset)(jax.random.split(jax.random.key(0), 3))
    step, rows = checked(jax.jit(batch.step)), [states]
    for _ in range(2):
        rows.append(step(rows[-1], jnp.zeros((3, 4))))
    numbers = np.concatenate([s.world.episode for s in rows])
    assert numbers.tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 8]
    starts = np.concatenate([s.obs["state"][:, :2] for s in rows])
    np.testing.assert_allclose(starts, np.asarray(episodes.start)[numbers % 7, :2], atol=1e-5)
    np.testing.assert_array_equal(
        np.concatenate([s.world.house for s in rows]), np.asarray(episodes.house)[numbers % 7]
    )


def test_starts_are_settled(generated_bank):
    """Who does nothing for a second stays, and so does the furniture."""
    env = HouseholdEnv(make_config(sensors=("state",))).bind(generated_bank)
    keys = jax.random.split(jax.random.key(0), 4)
    states = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0)))(env.params, keys)
    step = checked(jax.jit(jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0))))
    before = states.physics
    for _ in range(10):
        states = step(env.params, states, jnp.zeros((4, 4)))
    agent = np.abs(states.physics.qpos[:, :3] - before.qpos[:, :3])
    assert agent.max() < 0.01
    valid = np.asarray(env.bank.physics.body_valid)[np.asarray(states.world.house)]
    bodies = [
        np.asarray(d.qpos[:, 4 : 4 + 7 * valid.shape[1]]).reshape(4, -1, 7)[..., :3] for d in (states.physics, before)
    ]
    moved = np.linalg.norm(bodies[0] - bodies[1], axis=-1)[valid]
    assert np.quantile(moved, 0.95) < 0.02
    assert moved.max() < 0.05


def test_episodes_of_other_houses_are_refused(bank, env):
    """Their numbers fit, but their starts stand in something that these houses have."""
    episodes = sample_episodes(bank, 8)
    assert env.with_tasks(episodes).params.tasks is episodes
    inside = episodes.start.at[2].set(jnp.array([0.0, 0.5, 0.0]))
    assert int(episodes.house[2]) == 0
    with pytest.raises(ConfigError, match=r"no agent can stand at `start` \(0, 0.5, 0\) \(at task 2"):
        env.with_tasks(episodes.replace(start=inside))


def test_an_environment_of_a_file_is_in_the_houses_that_it_names(tmp_path):
    """By name alone: of a folder or a name, in the order of the file."""
    root = tmp_path / "houses"
    ids = generate_flats(root, range(3))
    wanted = [ids[2], ids[0]]
    bank = load_bank(root, ids=wanted)
    episodes = sample_episodes(bank, 4)
    file = tmp_path / "e.jsonl"
    save_episodes(file, bank, episodes)
    assert read_house_ids(file) == tuple(wanted)
    for houses in (str(root), "procedural:3?preset=flat"):
        made = home_mjx.make("PointNav-v0", houses, episodes=file, sensors=("goal",))
        assert list(made.bank.house_ids) == wanted
        jax.tree.map(np.testing.assert_array_equal, made.params.tasks, episodes)
    again = EnvSpec.from_json(made.spec.to_json())
    assert again.options["episodes"] == str(file)
    assert make_core(again) is not None
    with pytest.raises(ConfigError, match="`split` cannot be combined with a file of episodes"):
        home_mjx.make("PointNav-v0", root, episodes=file, split="val")


def test_rows_of_a_task_bank_are_read_for_tasks_that_are_rows(generated_bank, tmp_path):
    tasks = RoomNav(num_tasks=2).task_bank(generated_bank)
    save_tasks(tmp_path / "t.jsonl", generated_bank, tasks)
    found = load_episodes_or_tasks(tmp_path / "t.jsonl", generated_bank, RoomNav())
    assert isinstance(found, TaskBank)
    np.testing.assert_array_equal(found.rows.start, tasks.rows.start)
    save_episodes(tmp_path / "e.jsonl", generated_bank, sample_episodes(generated_bank, 2))
    for name, task in (("t", PointNav()), ("e", RoomNav())):
        with pytest.raises(DatasetError, match=r"holds what .* writes: ") as caught:
            load_episodes_or_tasks(tmp_path / f"{name}.jsonl", generated_bank, task)
        assert type(task).__name__ in caught.value.hint
        assert ("RoomNav-v0" if name == "t" else "PointNav-v0") in caught.value.hint


def storeys_of(episodes, bank):
    """Index of the storey of each start and each goal."""
    level = jax.vmap(lambda house, place: cell_at_feet(bank, house, place)[0])
    goals = bank.navigation.goal[episodes.house, episodes.columns["goal"]]
    return np.asarray(level(episodes.house, episodes.start)), np.asarray(level(episodes.house, goals))


def test_episodes_on_one_storey_start_on_that_of_their_goal():
    bank = homes_bank(("straight", "to and fro"))
    start, goal = storeys_of(sample_episodes(bank, 100), bank)
    assert (start != goal).any()
    for drawn in (
        sample_episodes(bank, 100, same_storey=True),
        sample_episodes(bank, 100, task=PointNav(same_storey=True)),
    ):
        start, goal = storeys_of(drawn, bank)
        np.testing.assert_array_equal(start, goal)
        assert set(start.tolist()) == {0, 1, 2}
    with pytest.raises(ConfigError, match="hardly any path of 30 m to inf m on one storey"):
        sample_episodes(bank, 4, min_length=30, same_storey=True)
    with pytest.raises(ConfigError, match="`same_storey` is for PointNav"):
        sample_episodes(bank, 4, task=Task(), same_storey=True)


def test_resets_of_point_nav_on_one_storey_choose_goals_of_the_starts():
    bank = homes_bank(("straight", "to and fro"))
    levels, options = {}, {"sensors": ("goal",), "impl": "kinematic"}
    for same in (False, True):
        env = home_mjx.make("PointNav-v0", bank, same_storey=same, **options)
        states = jax.jit(jax.vmap(env.core.reset, (None, 0)))(env.params, jax.random.split(jax.random.key(0), 64))
        levels[same] = abs(np.asarray(states.obs["goal"])[:, 3]) > 1.5
        assert np.isfinite(np.asarray(states.task.distance)).all()
    assert levels[False].any()
    assert not levels[True].any()


def test_files_of_another_task_are_refused(generated_bank, tmp_path):
    """A file of rows that has none of the task's own; episodes by the task that each line names."""
    file = tmp_path / "t.jsonl"
    save_tasks(file, generated_bank, RoomNav(num_tasks=2).task_bank(generated_bank))
    options = {"episodes": file, "sensors": ("state",)}
    with pytest.raises(DatasetError, match="contains tasks of RoomNav, but not of ObjectNav"):
        home_mjx.make("ObjectNav-v0", generated_bank, **options)
    assert home_mjx.make("RoomNav-v0", generated_bank, **options).params.tasks.names == ("RoomNav",)
    file.write_text(file.read_text().replace('"RoomNav"', '"mine"'))
    assert home_mjx.make("ObjectNav-v0", generated_bank, **options).params.tasks.names == ("mine",)
    save_episodes(file, generated_bank, sample_episodes(generated_bank, 2))
    with pytest.raises(DatasetError, match="one of PointNav, not of Exploration") as caught:
        home_mjx.make("Exploration-v0", generated_bank, **options)
    assert "task" in caught.value.element


def test_houses_that_nobody_generates_are_refused(tmp_path):
    (tmp_path / "e.jsonl").write_text(json.dumps({"house": "0" * 32}) + "\n")
    with pytest.raises(UnknownIdError, match="no house `000") as caught:
        home_mjx.make("PointNav-v0", episodes=tmp_path / "e.jsonl")
    assert "--dataset" in caught.value.hint
    (tmp_path / "e.jsonl").write_text("")
    with pytest.raises(DatasetError, match="no episode"):
        read_house_ids(tmp_path / "e.jsonl")
