"""Tasks as rows: experts do them, files keep them, whatever cannot be done is refused."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.ndimage import minimum_filter
from whole_episodes import begun, played

import home_mjx
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownIdError
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig
from home_mjx.schema.categories import COARSE
from home_mjx.schema.compiled import FIELD_UNIT
from home_mjx.tasks import EnvConfig, EnvParams, HouseholdEnv, expert_action, load_tasks, save_tasks
from home_mjx.tasks.language import detokenize, mask_new_combinations, tokenize
from home_mjx.tasks.rules import Feature
from home_mjx.tasks.suite import HouseTasks, InstructionFollowing, ObjectNav, PiedPiper, PointGoals, RoomNav

STOPS = {"stop": True}
TASKS = HouseTasks(
    tasks=(RoomNav(**STOPS), ObjectNav(**STOPS), InstructionFollowing(**STOPS), PointGoals(**STOPS)), num_tasks=6
)
CONFIG = EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(impl="kinematic"))
MOST_STEPS = 400


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(CONFIG, TASKS).bind(bank)


@pytest.fixture(scope="module")
def reset(env):
    return begun(env)


def test_ways_end_where_conditions_hold(env):
    """Wherever no cell around is nearer, it is as near as the row asks: nobody is led to what stays too far away."""
    tasks, navigation, seen = env.params.tasks, env.bank.navigation, 0
    columns, houses = {name: np.asarray(x) for name, x in tasks.rows.columns.items()}, np.asarray(tasks.rows.house)
    for row, house in enumerate(houses.tolist()):
        number, first = np.asarray(navigation.cell[house]), int(navigation.first_cell[house])
        home = (number >= first) & (number < first + int(navigation.num_cells[house]))
        for c in np.flatnonzero(columns["feature"][row] == Feature.DISTANCE).tolist():
            far = np.full(number.shape, np.inf)
            column = columns["field"][row, columns["first"][row, c]]
            far[home] = np.asarray(tasks.field[:, column])[number[home]] * FIELD_UNIT
            ends = home & (far <= minimum_filter(far, size=(1, 3, 3), mode="constant", cval=np.inf))
            assert far[ends].max() <= columns["maximum"][row, c] + 1e-6
            seen += 1
    assert seen > 20


@pytest.mark.slow
def test_experts_do_what_rows_say_by_the_shortest_way(env, reset):
    done = played(env, reset, lambda s, _: expert_action(env.core.snapshot(env.params, s), s.task)[0], MOST_STEPS)
    success, spl = (np.asarray(done.metrics[name]) for name in ("success", "spl"))
    for number, name in enumerate(env.params.tasks.names):
        own = np.asarray(done.task.task) == number
        assert own.sum() >= 12
        assert success[own].mean() >= 0.95, name
        assert spl[own].mean() >= 0.9, name


@pytest.mark.slow
def test_random_actions_hardly_ever_succeed(env, reset):
    num = int(env.core.action_spec.high) + 1
    done = played(env, reset, lambda _, key: jax.random.randint(key, (), 0, num), MOST_STEPS)
    assert np.asarray(done.metrics["success"]).mean() < 0.1
    assert np.asarray(done.done).all()  # a wrong stop ends an episode


def test_rows_are_of_all_houses_and_tasks_and_begin_on_their_floors(env, bank, reset):
    rows = env.params.tasks.rows
    counts = np.zeros((bank.num_houses, len(env.params.tasks.names)), int)
    np.add.at(counts, (np.asarray(rows.house), np.asarray(rows.columns["task"])), 1)
    assert counts.min() >= 1
    assert counts.max() <= TASKS.num_tasks
    assert len(set(np.asarray(rows.house[: bank.num_houses]).tolist())) == bank.num_houses
    assert np.asarray(rows.columns["length"]).min() >= TASKS.min_length
    guide = np.asarray(rows.columns["guide"][:, 0])
    told = np.asarray(reset.task.distance)[np.arange(len(rows)), 0, guide]
    length, parts = np.asarray(rows.columns["length"]), (np.asarray(rows.columns["guide"]) >= 0).sum(axis=1)
    np.testing.assert_allclose(told[parts == 1], length[parts == 1], atol=0.15)
    assert (length - told)[parts > 1].min() > -0.15  # and the ways from one thing to the next
    assert (length - told)[parts > 1].mean() > 1.0


def test_mistakes_cost_and_end_episodes_only_if_told_to(bank):
    anywhere = PointGoals(stop=True, success_distance=1000.0)
    task = HouseTasks(tasks=(anywhere, ObjectNav(**STOPS)), num_tasks=2, failure_cost=0.25)
    states = begun(HouseholdEnv(CONFIG, task).bind(bank))
    for ends in (True, False):
        env = HouseholdEnv(CONFIG, dataclasses.replace(task, terminate_on_failure=ends)).bind(bank)
        names, step = env.core.action_names, jax.jit(jax.vmap(env.core.step, in_axes=(None, 0, 0)))
        num = len(states.reward)
        stays, stops, goes = (np.full(num, names.index(name)) for name in ("look_up", "stop", "move_forward"))
        quiet, stopped = step(env.params, states, stays), step(env.params, states, stops)
        right = np.asarray(states.task.task) == env.params.tasks.names.index("PointGoals")
        assert right.any()
        assert not right.all()
        np.testing.assert_array_equal(stopped.terminated, right | ends)
        np.testing.assert_array_equal(np.asarray(stopped.metrics["success"]) == 1, right)
        lost = np.asarray(quiet.reward - stopped.reward)[~right]
        np.testing.assert_allclose(lost, task.failure_cost, atol=1e-5)
        moved = step(env.params, stopped, goes)
        gone = np.linalg.norm(np.asarray(moved.task.position - stopped.task.position)[:, 0], axis=-1) > 0.1
        assert gone[~right].any() != ends


def test_a_file_of_tasks_holds_all_of_them(env, bank, tmp_path):
    path, tasks = tmp_path / "tasks.jsonl", env.params.tasks
    save_tasks(path, bank, tasks)
    again = load_tasks(path, bank)
    (names, fields, rows), (read_names, read_fields, read_rows) = (parts(x, bank) for x in (tasks, again))
    assert (names == read_names).all()
    jax.tree.map(np.testing.assert_array_equal, rows, read_rows)
    np.testing.assert_array_equal(fields, read_fields)


def parts(tasks, bank):
    """Of all rows: the task's name, distances of its house's first cell to its descriptors, and everything else."""
    columns = dict(tasks.rows.columns)
    names, field = np.array(tasks.names)[np.asarray(columns.pop("task"))], np.asarray(columns.pop("field"))
    first = np.asarray(bank.navigation.first_cell)[np.asarray(tasks.rows.house)]
    distances = np.where(field >= 0, np.asarray(tasks.field)[first[:, None], np.maximum(field, 0)], 0)
    return names, distances, tasks.rows.replace(columns=columns)


def test_a_line_can_be_read_and_written_by_people(env, bank, tmp_path):
    path = tmp_path / "tasks.jsonl"
    save_tasks(path, bank, env.params.tasks)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    nav = next(line for line in lines if line["task"] == "ObjectNav")
    assert nav["selectors"][0]["kind"] == "object"
    assert nav["selectors"][0]["coarse"] in COARSE
    ways = nav["stages"][0]["transitions"]
    assert [way["next"] for way in ways] == ["success", "failure"]
    assert [need["feature"] for need in ways[0]["require"]] == ["distance", "seen", "stopped"]
    assert next(line for line in lines if line["task"] == "InstructionFollowing")["instruction"].split()


@pytest.mark.parametrize(
    ("change", "error", "what"),
    [
        ({"house": "nowhere"}, UnknownIdError, "nowhere"),
        ({"start": [0, 0]}, DatasetError, "start"),
        ({"instruction": "go to the blorb"}, DatasetError, "blorb"),
        ({"selectors": [{"kind": "object", "coarse": "blorb"}]}, DatasetError, "blorb"),
        ({"stages": []}, DatasetError, "stages"),
        ({"stages": [{"transitions": [{"next": 4}]}]}, DatasetError, "stage 4"),
    ],
)
def test_a_broken_line_is_named(env, bank, tmp_path, change, error, what):
    path = tmp_path / "tasks.jsonl"
    save_tasks(path, bank, env.params.tasks.pick(jnp.arange(2)))
    first, second = (json.loads(line) for line in path.read_text().splitlines())
    path.write_text(json.dumps(first) + "\n" + json.dumps(second | change) + "\n")
    with pytest.raises(error, match=what) as raised:
        load_tasks(path, bank)
    assert "line 2" in str(raised.value)


def test_no_file_and_no_task(bank, tmp_path):
    with pytest.raises(MissingFileError):
        load_tasks(tmp_path / "nothing.jsonl", bank)
    (tmp_path / "empty.jsonl").write_text("")
    with pytest.raises(DatasetError, match="no task"):
        load_tasks(tmp_path / "empty.jsonl", bank)
    with pytest.raises(ConfigError, match=r"none of .* rows of RoomNav"):
        RoomNav(min_length=900.0).task_bank(bank)


def test_a_task_of_rows_needs_its_rows(bank):
    core = HouseholdEnv(CONFIG, RoomNav(stop=True))
    with pytest.raises(ConfigError, match="task bank"):
        core.reset(EnvParams(bank), jax.random.key(0))


def test_rows_can_be_chosen(env):
    tasks = env.params.tasks
    long = tasks.where(np.asarray(tasks.rows.columns["length"]) > 4)
    assert 0 < len(long) < len(tasks)
    assert np.asarray(long.rows.columns["length"]).min() > 4
    with pytest.raises(ConfigError, match="no task"):
        tasks.where(np.zeros(len(tasks), bool))


def test_instructions_are_words_of_the_vocabulary(env):
    tokens = np.asarray(env.params.tasks.rows.columns["tokens"])
    texts = [detokenize(row) for row in tokens]
    told = [text for text in texts if text]
    assert told
    assert all(tokenize(text) == tuple(t for t in row if t) for text, row in zip(texts, tokens.tolist(), strict=True))


@pytest.mark.parametrize(
    "env_id",
    ["InstructionFollowing-v0", *(pytest.param(f"{n}-v0", marks=pytest.mark.slow) for n in ("RoomNav", "ObjectNav"))],
)
def test_ids(env_id, bank):
    sensors = ("state", "goal_words", "instruction")
    env = home_mjx.make(env_id, bank, sensors=sensors, num_tasks=2, impl="kinematic")
    state = jax.jit(env.reset)(jax.random.key(0))
    assert set(state.obs) == set(sensors)
    assert env.core.config.discrete is not None
    state = jax.jit(env.step)(state, jnp.int32(1))
    assert bool(jnp.isfinite(state.reward))
    assert dataclasses.asdict(env.core.task)["stop"]


def test_sentences_are_split_by_combinations(generated_bank):
    """Each sentence is for training or has something new, and a training one has none of the new combinations."""
    banks = {
        name: InstructionFollowing(stop=True, num_tasks=24, combinations=name, unseen_fraction=0.4).task_bank(
            generated_bank
        )
        for name in ("all", "seen", "new")
    }
    assert len(banks["seen"]) + len(banks["new"]) == len(banks["all"])
    assert mask_new_combinations(banks["new"], 0.4).all()
    assert not mask_new_combinations(banks["seen"], 0.4).any()
    with pytest.raises(ConfigError, match="unknown kind of combinations"):
        InstructionFollowing(combinations="old")


def test_what_cannot_be_mixed_is_refused():
    for task, words in (
        (PiedPiper(), "controls agents itself"),
        (RoomNav, "tasks that write rows"),
    ):
        with pytest.raises(ConfigError, match=words):
            HouseTasks(tasks=(task,))
