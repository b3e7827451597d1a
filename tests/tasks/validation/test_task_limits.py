"""What the attack of session 23 got through as tasks: each is refused where it is given, and named."""

import copy
import json
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from home_mjx.errors import ConfigError, DatasetError, OutOfRangeError
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import (
    AutoReset,
    EnvConfig,
    EnvParams,
    HouseholdEnv,
    Status,
    load_tasks,
    sample_episodes,
    save_episodes,
    save_tasks,
)
from home_mjx.tasks.base.state import check_rows
from home_mjx.tasks.language import mask_new_combinations, mask_words
from home_mjx.tasks.rules import Feature
from home_mjx.tasks.rules.cell_graph import CellGraph
from home_mjx.tasks.suite import HouseTasks, InstructionFollowing, PiedPiper, PointNav, RoomNav
from home_mjx.tasks.suite.navigation import check_mix
from home_mjx.tasks.validation.row_violations import is_standable, min_steps

KINEMATIC = PhysicsConfig(impl="kinematic")
CONFIG = EnvConfig(sensors=("state",), actions="discrete", physics=KINEMATIC)
GONE = object()


def changed(line, path, value):
    line = copy.deepcopy(line)
    owner = line
    for key in path[:-1]:
        owner = owner[key]
    if value is GONE:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    return line


NEED = ("stages", 0, "transitions", 0, "require", 0)


def test_a_wrong_length_is_computed_anew(env, lines, tmp_path, caplog):
    """Otherwise SPL would be computed with it. The row leads on to a room, so there are two legs."""
    file, right = tmp_path / "tasks.jsonl", lines[0]["length"]
    for wrong in (90.0, right + 0.5):
        file.write_text(json.dumps(changed(lines[0], ("length",), wrong)) + "\n")
        found = load_tasks(file, env.bank)
        np.testing.assert_allclose(found.rows.columns["length"], right, atol=0.01)
        assert f"line 1: `length` is {wrong:.2f} m, the shortest path is {right:.2f} m" in caplog.text
    caplog.clear()
    file.write_text(json.dumps(lines[0]) + "\n")
    load_tasks(file, env.bank)
    assert not caplog.text


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (
            ("stages", 0, "transitions", 0, "reward"),
            math.nan,
            "from -1e+06 to 1e+06, got nan",
        ),
        (("stages", 0, "transitions", 0, "reward"), math.inf, "stages[0].transitions[0].reward"),
        (("start",), [1e6, 0.0, 0.0], "start[0]"),
        (("start",), [900.0, 0.0, 0.0], "no agent can stand"),
        (("start",), None, "expected a list, got None"),
        (("yaw",), 1e300, "yaw"),
        (("yaw",), True, "yaw"),
        (("length",), -1.0, "length"),
        (("length",), GONE, "`length` is missing"),
        (("task",), 5, "task"),
        (("house",), [], "house"),
        (("colour",), "red", "unknown field 'colour'"),
        (("selectors", 0, "kind"), "thing", "selectors[0].kind"),
        (("selectors", 0, "coarse"), "sofaa", "Did you mean `sofa`"),
        (("selectors", 0, "object_id"), 70_000, "selectors[0].object_id"),
        (("selectors", 0, "object_id"), 10**400, "a number of more than 60 digits"),
        (("selectors", 0, "object_id"), 9999, "the house has no such object or room"),
        (("selectors", 0, "on"), 99, "selectors[0].on"),
        (("selectors", 2, "place"), GONE, "selectors"),
        (("selectors", 3, "agent"), GONE, "has no `agent`"),
        (("selectors", 0), {"kind": "nothing"}, "no path leads"),
        (("stages", 0, "transitions"), [], "expected 1 to 4 items, got 0"),
        (("stages", 0, "transitions", 0, "next"), 1.5, "expected the number of a stage, success or failure"),
        (("stages", 0, "transitions", 0, "next"), 4, "stage 4"),
        (("stages", 0, "guide"), math.inf, "stages[0].guide"),
        ((*NEED, "feature"), "near", "Did you mean"),
        ((*NEED, "maximum"), math.nan, "maximum"),
        ((*NEED, "maximum"), 1e-3, "none close enough to it"),
        ((*NEED, "minimum"), 2000.0, "never from 2000"),
        ((*NEED, "agent"), 300, "agent"),
        (("instructed_agents",), [10**12], "instructed_agents[0]"),
        (("instructed_agents",), [-1], "instructed_agents[0]"),
        (("num_identifying_questions",), -5, "num_identifying_questions"),
        (("num_identifying_questions",), 2, "num_identifying_questions"),
        (("oracle",), [["", ""]], "expected one word, got 0"),
        (("oracle",), [["yes"]], "oracle[0]"),
        (("answer",), "yes no", "expected one word, got 2"),
        (("instruction",), "go to the blorb", "instruction"),
        (("sounds", 0, "period"), 0.0, "sounds[0].period"),
        (("sounds", 0, "emitter"), 1, "which is not an object"),
        (("sounds", 0, "clip"), "bel", "Did you mean `bell`"),
        (("sounds", 0, "x"), 1, "unknown field 'x'"),
    ],
)
def test_a_wrong_field_of_a_line_is_named(env, lines, tmp_path, path, value, said):
    file = tmp_path / "tasks.jsonl"
    file.write_text("".join(f"{json.dumps(line)}\n" for line in (lines[0], changed(lines[0], path, value))))
    with pytest.raises(DatasetError) as raised:
        load_tasks(file, env.bank)
    assert "line 2" in str(raised.value)
    assert said in str(raised.value)


@pytest.mark.parametrize("line", ["5", "[]", "[" * 100_000, '{"house": ' + "9" * 5000 + "}", "null", '"x"', ""])
def test_a_line_that_is_no_task_is_named(env, lines, tmp_path, line):
    file = tmp_path / "tasks.jsonl"
    file.write_text(f"{json.dumps(lines[0])}\n{line}\n")
    with pytest.raises(DatasetError, match="line 2"):
        load_tasks(file, env.bank)


def test_a_task_of_nothing_but_time_needs_no_distances(env, lines, tmp_path):
    """A bank without a single field of distances failed at reset."""
    late = {"feature": "time", "minimum": 2.0}
    line = lines[0] | {
        "selectors": [],
        "sounds": [],
        "stages": [{"transitions": [{"next": "failure", "require": [late]}]}],
    }
    file = tmp_path / "tasks.jsonl"
    file.write_text(json.dumps(line) + "\n")
    loaded = env.with_tasks(load_tasks(file, env.bank))
    assert bool(jnp.isfinite(jax.jit(loaded.reset)(jax.random.key(0)).metrics["distance"]))


def test_tasks_of_other_houses_or_without_names_are_not_saved(env, generated_bank, tmp_path):
    tasks, point = env.params.tasks, sample_episodes(generated_bank, 2)
    far = tasks.rows.house + 2
    for wrong, said in (
        (tasks.replace(names=()), "no names of tasks"),
        (tasks.replace(rows=tasks.rows.replace(house=far)), "houses 0 to 1, asked for 2"),
    ):
        with pytest.raises(OutOfRangeError, match=said):
            save_tasks(tmp_path / "tasks.jsonl", generated_bank, wrong)
    with pytest.raises(OutOfRangeError, match="houses 0 to 1, asked for -1"):
        save_episodes(tmp_path / "episodes.jsonl", generated_bank, point.replace(house=point.house - 1))
    assert list(tmp_path.iterdir()) == []


def in_a_wall(bank, house):
    """A place in the plan of a house that is far from where agents fit, and in one of its rooms."""
    navigation, cell = bank.navigation, bank.spec.cell
    region, room = (np.asarray(x[house, 0]) for x in (navigation.region, navigation.room))
    away = distance_transform_edt(region != 0)
    row, column = np.unravel_index(np.argmax(np.where(room >= 0, away, 0)), region.shape)
    assert away[row, column] > 2
    plan = np.asarray(navigation.origin[house]) + (np.array([column, row]) + 0.5) * cell
    return jnp.array([*plan, navigation.floor[house, 0]], jnp.float32)


def test_where_agents_can_stand_is_where_cells_of_ways_are(generated_bank, rng):
    """Against the cells of `CellGraph`, one place after the other."""
    places = []
    for house in range(generated_bank.num_houses):
        graph = CellGraph(generated_bank, house).place
        low, high = graph.min(axis=0) - 0.8, graph.max(axis=0) + 0.8
        places += [(house, rng.uniform(low, high)) for _ in range(300)]
        shifts = rng.normal(0, [0.1, 0.1, 0.2], (300, 3))
        places += [(house, graph[rng.integers(len(graph))] + shift) for shift in shifts]
    houses, starts = np.array([house for house, _ in places]), np.stack([place for _, place in places])
    found = is_standable(generated_bank, houses, starts)
    reach = np.array([1.5 * generated_bank.spec.cell, 1.5 * generated_bank.spec.cell, 0.3])
    for house in range(generated_bank.num_houses):
        graph = CellGraph(generated_bank, house).place
        for place, stands in zip(starts[houses == house], found[houses == house], strict=True):
            assert stands == np.any(np.all(np.abs(graph - place) < reach, axis=1)), place
    assert 0.2 < found.mean() < 0.8
    assert not is_standable(generated_bank, np.zeros(2, int), np.array([[1e6, 0, 0], [0, -1e6, 0]])).any()


def brief(columns, stage=0, waited=0.0, seen=()):
    """Fewest steps to success, by trying all ways."""
    if stage in seen:
        return math.inf
    found = [math.inf]
    for needs, after in zip(columns["require"][stage], columns["next"][stage], strict=True):
        if needs < 0 or after == -2:
            continue
        asked = [c for c in range(8) if needs >> c & 1 and columns["feature"][c] == Feature.TIME]
        total = waited + max([0.0, *(columns["minimum"][c] for c in asked)])
        found.append(total if after == -1 else brief(columns, after, total, (*seen, stage)))
    return min(found)


def test_waiting_is_counted_along_the_shortest_way(rng):
    rows = {
        "require": np.where(rng.random((200, 6, 3)) < 0.4, -1, rng.integers(0, 256, (200, 6, 3))),
        "next": rng.choice([-2, -1, 0, 1, 2, 3, 4, 5], (200, 6, 3), p=[0.1, 0.1] + [0.8 / 6] * 6),
        "feature": rng.choice([Feature.TIME, Feature.SEEN], (200, 8)),
        "minimum": rng.choice([-np.inf, 3.0, 10.0, 50.0, np.inf], (200, 8)),
    }
    steps = min_steps(rows)
    assert steps.tolist() == [brief({name: x[t].tolist() for name, x in rows.items()}) for t in range(200)]
    assert len(np.unique(steps)) > 5


@pytest.mark.parametrize(
    ("waits", "fits"), [((500,), True), ((501,), False), ((250, 251), False), ((math.inf,), False)]
)
def test_success_after_the_end_of_an_episode_is_refused(env, lines, tmp_path, waits, fits):
    """`TIME` counts from the begin of a stage, so waits add up."""
    numbers = [*range(1, len(waits)), "success"]
    stages = [
        {"transitions": [{"next": after, "require": [{"feature": "time", "minimum": wait}]}]}
        for after, wait in zip(numbers, waits, strict=True)
    ]
    file = tmp_path / "tasks.jsonl"
    file.write_text(json.dumps(lines[0] | {"stages": stages}) + "\n")
    tasks = load_tasks(file, env.bank)
    if fits:
        env.with_tasks(tasks)
        return
    with pytest.raises(ConfigError, match=r"steps of `time`, an episode has 500 \(at task 0, require.* episode_length"):
        env.with_tasks(tasks)


@pytest.mark.parametrize("index", [4, -1, jnp.array([0, 100]), [0, 4]])
def test_rows_out_of_range_are_refused(env, index):
    for tasks in (env.params.tasks, env.params.tasks.with_weights([1, 2, 3, 4]), env.params.tasks.rows):
        with pytest.raises(OutOfRangeError, match="there are episodes 0 to 3") as raised:
            tasks.pick(jnp.asarray(index))
        assert raised.value.hint
        assert isinstance(raised.value, IndexError)


@pytest.mark.parametrize("index", [jnp.array([0.5]), jnp.ones(2, complex), True, jnp.ones(4, bool)])
def test_what_is_no_number_of_a_row_is_refused(env, index):
    with pytest.raises(ConfigError, match="expected numbers of rows"):
        check_rows(index, 4)


def test_empty_and_foreign_tasks_are_refused(env, generated_bank):
    tasks = env.params.tasks
    rows, columns = tasks.rows, tasks.rows.columns
    point = sample_episodes(generated_bank, 2)
    short = columns | {"reward": columns["reward"][:2]}
    double = columns | {"reward": np.asarray(columns["reward"], np.float64)}
    for wrong, said in (
        (5, "expected tasks, got int"),
        ([1], "expected tasks, got list"),
        (point, "must be a TaskBank, got Episodes"),
        (tasks.pick(jnp.zeros(0, jnp.int32)), "there are no tasks"),
        (tasks.replace(field=tasks.field[:5]), "distances of 5 cells"),
        (tasks.replace(field=tasks.field[:, :0]), "cells"),
        (
            tasks.replace(rows=rows.replace(columns={"length": columns["length"]})),
            "lack columns that Rich needs: .*descriptor",
        ),
        (tasks.replace(rows=rows.replace(columns=short)), "`reward` must have the shape"),
        (tasks.replace(rows=rows.replace(columns=double)), "`reward` must have the dtype float32, got float64"),
        (tasks.replace(rows=rows.replace(house=rows.house + 100)), "`house` must be a whole number from 0 to 1"),
        (tasks.replace(rows=rows.replace(start=rows.start.at[1].add(500.0))), "not in its house .at task 1, start"),
        (
            tasks.replace(rows=rows.replace(start=rows.start.at[1, 2].add(1.0))),
            "no agent can stand .* .at task 1, start",
        ),
        (tasks.replace(rows=rows.replace(yaw=rows.yaw.at[2].set(jnp.nan))), "`yaw` .* got nan .at task 2"),
        (tasks.replace(names=()).replace(weights=jnp.zeros(4)), "weights of all 4 tasks are 0"),
    ):
        with pytest.raises(ConfigError, match=said) as raised:
            env.with_tasks(wrong)
        assert raised.value.hint
    for name, value in (("reward", jnp.inf), ("field", 99), ("feature", 77), ("descriptor", 30_000), ("tokens", -1)):
        spoiled = columns | {name: columns[name].at[3].set(value)}
        with pytest.raises(ConfigError, match="at task 3"):
            env.with_tasks(tasks.replace(rows=rows.replace(columns=spoiled)))
    with pytest.raises(ConfigError, match="Rich needs a task bank"):
        env.with_tasks(None)
    points = HouseholdEnv(CONFIG, PointNav()).bind(generated_bank)
    points.with_tasks(point)
    with pytest.raises(ConfigError, match=r"no agent can stand .* \(at task 1, start"):
        points.with_tasks(point.replace(start=point.start.at[1].set(in_a_wall(generated_bank, int(point.house[1])))))
    with pytest.raises(ConfigError, match="`goal` must be"):
        points.with_tasks(point.replace(columns=point.columns | {"goal": jnp.array([0, 999])}))
    with pytest.raises(ConfigError, match="lack columns that PointNav needs: goal"):
        points.with_tasks(tasks)


@pytest.mark.parametrize(
    ("options", "change", "said"),
    [
        ({}, {"selectors": [{"kind": "agent", "agent": 7}]}, "`selectors.agent` must be a whole number from -1 to 0"),
        ({}, {"instructed_agents": [3]}, "`instructed_agents`"),
        ({}, {"require": {"feature": "said", "minimum": 0.0}}, "`said` is never from 0"),
        ({}, {"require": {"feature": "held", "minimum": 1.0}}, "`held` .* always 0 here .* Give hands=True"),
        ({"actions": "continuous"}, {"require": {"feature": "stopped", "minimum": 1.0}}, "`stopped` .* always 0"),
    ],
)
def test_what_an_environment_lacks_is_refused_when_tasks_are_given(
    generated_bank, lines, tmp_path, options, change, said
):
    stage = {"transitions": [{"next": "success", "require": [change.pop("require", {"feature": "touched"})]}]}
    line = lines[0] | {"selectors": [lines[0]["selectors"][2]], "stages": [stage], "sounds": []} | change
    file = tmp_path / "tasks.jsonl"
    file.write_text(json.dumps(line) + "\n")
    core = HouseholdEnv(CONFIG.replace(**options), RoomNav())
    with pytest.raises(ConfigError, match=f"{said}.*"):
        core.bind(EnvParams(generated_bank, tasks=load_tasks(file, generated_bank)))


def test_weights_inside_a_program_are_flagged(env):
    """Where none can be refused, what cannot be drawn by counts as 0; none left: all alike, with a flag."""
    batch, keys = AutoReset(env.core), jax.random.split(jax.random.key(0), 64)

    @jax.jit
    def begun(weights):
        states = batch.reset(env.params.replace(tasks=env.params.tasks.with_weights(weights)), keys)
        return states.world.episode, states.status

    for weights, drawn, flag in (
        ((0, 0, 0, 0), {0, 1, 2, 3}, Status.WEIGHTS),
        ((np.nan, 0, -1, np.inf), {0, 1, 2, 3}, Status.WEIGHTS),
        ((np.nan, 1, 0, 1), {1, 3}, 0),
        ((np.inf, -1, 3e38, 3e38), {2, 3}, 0),
    ):
        episode, status = begun(jnp.array(weights, jnp.float32))
        assert set(np.asarray(episode).tolist()) == drawn
        assert set(np.asarray(status).tolist()) == {int(flag)}
    with pytest.raises(ConfigError, match="expected 4 weights"):
        begun(jnp.ones(3))


@pytest.mark.parametrize(
    "weights", ["abc", None, ["a"] * 4, [None] * 4, np.ones(4, complex), np.ones((4, 1)), [10**400] * 4]
)
def test_what_is_no_weights_is_refused(env, weights):
    with pytest.raises(ConfigError, match="weights") as raised:
        env.params.tasks.with_weights(weights)
    assert raised.value.hint


@pytest.mark.parametrize(
    "mask", [np.ones(9, bool), np.ones(1, bool), np.ones((4, 2), bool), "abc", None, np.ones(4), [0, 1]]
)
def test_what_is_no_mask_is_refused(env, mask):
    with pytest.raises(ConfigError, match="expected a mask of 4 truth values"):
        env.params.tasks.where(mask)


def test_words_and_seeds_that_cannot_be_used_are_refused(env):
    for wrong in ("bed", 5):
        with pytest.raises(ConfigError, match="several words"):
            mask_words(env.params.tasks, wrong)
    with pytest.raises(ConfigError, match="seed"):
        mask_new_combinations(env.params.tasks, 0.2, 10**30)
    with pytest.raises(ConfigError, match="task_seed"):
        RoomNav(task_seed=-1)


@pytest.mark.parametrize(
    "tasks", [(), 5, None, "RoomNav", RoomNav(), (PointNav(),), (HouseTasks(),), (PiedPiper(),), ("x",)]
)
def test_a_mix_of_what_is_no_task_of_rows_is_refused(tasks):
    with pytest.raises(ConfigError, match="mix") as raised:
        check_mix(tasks)
    assert raised.value.hint


def test_a_mix_keeps_the_combinations_that_its_tasks_keep(generated_bank):
    """As `InstructionFollowing` alone does; sentences of the others stay."""
    options = {"num_tasks": 24, "task_seed": 1}
    seen = InstructionFollowing(combinations="seen", unseen_fraction=0.4, **options)
    mixed = HouseTasks(tasks=[RoomNav(), seen], **options).task_bank(generated_bank)
    of_sentences = np.asarray(mixed.rows.columns["task"]) == 1
    assert mixed.names == ("RoomNav", "InstructionFollowing")
    assert 0 < of_sentences.sum() < 48
    assert (~of_sentences).sum() == 48
    assert not mask_new_combinations(mixed.where(of_sentences), 0.4).any()
    hash(HouseTasks(tasks=[RoomNav(), seen]))


def test_pied_piper_is_for_as_many_agents_as_it_has(generated_bank):
    """Too many were refused when a reset was traced."""
    for num_agents, others, said in ((4, 1, "for 3 agents, got 4"), (3, 0, "for 2 agents, got 3"), (2, 1, "for 3")):
        physics = PhysicsConfig(num_agents=num_agents, impl="kinematic")
        with pytest.raises(ConfigError, match=said):
            HouseholdEnv(CONFIG.replace(physics=physics), PiedPiper(num_others=others))
