"""Whatever is changed in a line of a task file, it is refused by its number, or resets and steps to finite values."""

import copy
import json
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.schema.compiled import FIELD_UNREACHABLE
from home_mjx.tasks import EnvParams, Status, load_tasks
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.suite import task_io

FIELDS = 16  # columns of distances, so that all banks run one program
UNKNOWN = "bogus"
EPISODE = ("house", "start", "yaw")


@pytest.fixture
def quick(env, monkeypatch):
    """One view of each house for all files: what a house is like does not change."""
    views = house_views(env.bank)
    monkeypatch.setattr(task_io, "house_views", lambda _: views)


@pytest.fixture(scope="module")
def played(env):
    """Row 1 reset and stepped: whether all numbers are finite, and the flags."""

    def finite(state):
        floats = [x for x in jax.tree.leaves((state.obs, state.reward, state.metrics)) if x.dtype == jnp.float32]
        return jnp.all(jnp.stack([jnp.all(jnp.isfinite(x)) for x in floats])), state.status

    @jax.jit
    def play(params, key):
        def step(state, action):
            state = env.core.step(params, state, action)
            return state, finite(state)

        first = env.core.reset(params, key, None, jnp.int32(1))
        _, after = jax.lax.scan(step, first, jnp.array([1, 2, env.action_size - 1, 0], jnp.int32))
        return jax.tree.map(lambda a, b: jnp.append(b, a), finite(first), after)

    def run(tasks):
        wide = jnp.pad(tasks.field, ((0, 0), (0, FIELDS - tasks.field.shape[1])), constant_values=FIELD_UNREACHABLE)
        params = EnvParams(env.bank, tasks=tasks.replace(field=wide, names=("Any",)))
        return play(params, jax.random.key(0))

    return run


def places(value, path=()):
    """Of all that is in a line, however deep."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from places(item, (*path, key))


NUMBERS = st.one_of(
    st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e6, 1e39, 10**400, 2**31, 70_000, 300, -5, True, 1.0]),
    st.integers(-3, 9),
    st.floats(-30, 30),
)
TEXTS = st.sampled_from(["", "x", "success", "yes", "find the bed", "room", "voice", "chair", "Kitchen", "held"])
VALUES = st.one_of(NUMBERS, TEXTS, st.none(), st.lists(NUMBERS, max_size=4), st.just({}), st.just([[]]))


@st.composite
def mutations(draw, lines):
    """A line in which one or two things are another value, another part of it, gone, or twice there."""
    line = copy.deepcopy(lines[draw(st.integers(0, len(lines) - 1))])
    for _ in range(draw(st.sampled_from([1, 1, 1, 2]))):
        path = draw(st.sampled_from([p for p in places(line) if p]))
        owner = line
        for key in path[:-1]:
            owner = owner[key]
        how = draw(st.sampled_from(["near"] * 4 + ["value"] * 2 + ["part", "gone", "twice", "unknown"]))
        own = owner[path[-1]]
        if how == "near" and isinstance(own, int | float) and not isinstance(own, bool):
            owner[path[-1]] = draw(st.integers(-1, 4) if isinstance(own, int) else st.floats(-2, 2).map(own.__add__))
        elif how == "gone":
            del owner[path[-1]]
        elif how == "unknown" and isinstance(owner, dict):
            owner[draw(st.sampled_from([UNKNOWN, "place", "on", "in", "agent", "forbid", "room"]))] = copy.deepcopy(
                draw(VALUES)
            )
        elif how == "twice" and isinstance(owner, list):
            owner.append(copy.deepcopy(own))
        elif how == "part":
            part = line
            for key in draw(st.sampled_from(list(places(line)))):
                part = part[key]
            owner[path[-1]] = copy.deepcopy(part)
        else:
            owner[path[-1]] = copy.deepcopy(draw(VALUES))
    return line


def check(env, played, path, good, line):
    """Which of both it was."""
    path.write_text("".join(f"{json.dumps(x)}\n" for x in (good, line, good)))
    where = "line 2"
    try:
        tasks = load_tasks(path, env.bank)
        where = "task 1"
        tasks = env.with_tasks(tasks).params.tasks
    except HomeMjxError as error:
        return "refused" if where in str(error) else f"not located: {error}"
    finite, status = played(tasks)
    assert np.asarray(finite).all()
    assert not np.any(np.asarray(status) & (Status.NOT_A_NUMBER | Status.OUTSIDE))
    return "played"


def test_the_lines_themselves_are_played(env, lines, played, tmp_path):
    assert len(lines) == 4
    for line in lines:
        assert check(env, played, tmp_path / "tasks.jsonl", lines[0], line) == "played"


@pytest.mark.parametrize("examples", [150, pytest.param(3000, marks=pytest.mark.slow)])
def test_changed_lines_are_refused_or_played(env, lines, played, quick, tmp_path, examples):
    outcomes = []

    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    @given(mutations(lines))
    def one(line):
        outcomes.append(check(env, played, tmp_path / "tasks.jsonl", lines[0], line))

    one()
    assert set(outcomes) == {"refused", "played"}
    assert min(outcomes.count("refused"), outcomes.count("played")) > examples / 20


@st.composite
def spoiled(draw, columns):
    """A number of row 1 of a column, and another one that the column's type has."""
    name = draw(st.sampled_from(sorted(columns)))
    array = columns[name]
    at = (1, *(draw(st.integers(0, n - 1)) for n in array.shape[1:]))
    if array.dtype.kind == "f":
        return name, at, draw(st.one_of(st.floats(width=32), st.floats(-3, 3).map(array[at].item().__add__)))
    limits = np.iinfo(array.dtype)
    return name, at, draw(st.one_of(st.integers(-3, 9), st.integers(int(limits.min), int(limits.max))))


@pytest.mark.parametrize("examples", [60, pytest.param(2000, marks=pytest.mark.slow)])
def test_changed_columns_are_refused_or_played(env, played, examples):
    """As lines, but of rows that are given as arrays."""
    outcomes, whole = [], env.params.tasks
    rows = {name: getattr(whole.rows, name) for name in EPISODE} | whole.rows.columns
    columns = {name: np.asarray(values) for name, values in rows.items()}

    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    @given(spoiled(columns))
    def one(change):
        name, at, value = change
        array = columns[name].copy()
        array[at] = value
        own = {name: jnp.asarray(array)}
        if name in EPISODE:
            tasks = whole.replace(rows=whole.rows.replace(**own))
        else:
            tasks = whole.replace(rows=whole.rows.replace(columns=whole.rows.columns | own))
        try:
            env.with_tasks(tasks)
        except ConfigError as error:
            outcomes.append("refused" if "task 1" in str(error) else str(error))
            return
        finite, status = played(tasks)
        assert np.asarray(finite).all(), name
        assert not np.any(np.asarray(status) & (Status.NOT_A_NUMBER | Status.OUTSIDE)), name
        outcomes.append("played")

    one()
    assert set(outcomes) == {"refused", "played"}
