"""SPL and soft SPL at their limits: nothing to walk, nowhere to go, no step, the last step."""

import json
from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import homes_bank

import home_mjx
from home_mjx.tasks import load_episodes
from home_mjx.tasks.base.task import NO_LENGTH, path_scores
from home_mjx.tasks.env.observers import EpisodeStart, EpisodeStep
from home_mjx.tasks.suite import RoomNav
from home_mjx.training.evaluation import _path_metrics
from home_mjx.viewer.episodes.episode import _result

STOP, FORWARD, LEFT = 0, 1, 2
INF = np.inf


@pytest.mark.parametrize(
    ("success", "shortest", "walked", "left", "spl", "soft_spl"),
    [
        (1, 0.0, 0.0, 0.0, 1, 1),  # begins at the goal and stops
        (1, 1e-7, 3e-7, 2e-7, 1, 1),  # the same, with the rounding of a step
        (1, 0.0, 4e-4, 4e-4, 1, 1),  # a body that settles
        (0, 0.0, 0.0, 0.0, 0, 1),  # at the goal, without `stop`
        (1, 0.0, 0.0, 0.07, 1, 1),  # beside the middle of a cell of the room that was to be reached
        (0, 0.0, 0.0, 0.07, 0, 0),
        (1, 0.0, 3.0, 0.0, 0, 0),  # there and back: the shortest path is none of what was walked
        (0, 0.0, 3.0, 3.0, 0, 0),  # away from it
        (1, 0.1, 0.0, 0.1, 1, 0),  # within the radius, not nearer
        (1, 4.0, 4.0, 0.0, 1, 1),
        (1, 4.0, 3.9, 0.1, 1, 0.975),  # ends at the radius
        (1, 4.0, 8.0, 0.0, 0.5, 0.5),
        (0, 4.0, 0.0, 4.0, 0, 0),  # no step
        (0, 4.0, 5.0, 9.0, 0, 0),  # farther than before: no negative progress
        (0, 4.0, 5.0, INF, 0, 0),  # where no path leads from
        (0, INF, 5.0, INF, 0, 0),  # no path at all
        (0, INF, 0.0, 0.0, 0, 0),
        (1, 4.0, INF, 0.0, 0, 0),
    ],
)
def test_limits_of_path_scores(success, shortest, walked, left, spl, soft_spl):
    found = path_scores(*(jnp.float32(x) for x in (success, shortest, walked, left)))
    assert [float(found[name]) for name in ("spl", "soft_spl")] == pytest.approx([spl, soft_spl], abs=2e-7)


def test_scores_of_a_batch_are_the_published_formulas(rng):
    """S l / max(l, p), and max(0, 1 - d / l) instead of S, in float64, for any length that is one."""
    short, walked, left = rng.uniform(NO_LENGTH * 1.01, 30, (3, 5000))
    success = rng.integers(0, 2, 5000)
    found = path_scores(*(jnp.asarray(x, jnp.float32) for x in (success, short, walked, left)))
    ratio = short / np.maximum(short, walked)
    np.testing.assert_allclose(found["spl"], success * ratio, atol=1e-5)
    np.testing.assert_allclose(found["soft_spl"], np.maximum(0, 1 - left / short) * ratio, atol=2e-5)


@pytest.fixture(scope="module")
def bank():
    return homes_bank(("one storey", "straight"))


@pytest.fixture(scope="module")
def at_goals(bank, tmp_path_factory):
    """A file of episodes whose starts are their goals, on each storey."""
    path = tmp_path_factory.mktemp("at_goals") / "zero.jsonl"
    lines = []
    for house in (0, 1, 1):
        goals = np.asarray(bank.navigation.goal[house])
        place = goals[np.argmax(goals[:, 2]) if len(lines) == 1 else np.argmin(goals[:, 2])].tolist()
        line = {"house": bank.house_ids[house], "task": "PointNav", "start": place, "yaw": 0.3, "goal": place}
        lines.append(line | {"length": 0.0})
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def point_nav(bank, path, **options):
    own = {"impl": "kinematic", "sensors": ("goal",), "episode_length": 5} | options
    return home_mjx.make("PointNav-v0", bank, **own).with_tasks(load_episodes(path, bank))


@cache
def programs(env):
    """Compiled reset and step of a batch."""
    reset, step = env.core.reset, env.core.step
    return jax.jit(jax.vmap(reset, (None, 0, None, 0))), jax.jit(jax.vmap(step, (None, 0, 0)))


def rolled(env, actions, num=3):
    """The states of the first rows at the start and after each action, which all take."""
    reset, step = programs(env)
    states = [reset(env.params, jax.random.split(jax.random.key(0), num), None, jnp.arange(num))]
    for action in actions:
        states.append(step(env.params, states[-1], jnp.broadcast_to(jnp.asarray(action), (num, *np.shape(action)))))
    return states


@pytest.fixture(scope="module")
def habitat(bank, at_goals):
    """PointNav as Habitat has it, from starts that are goals."""
    return point_nav(bank, at_goals, actions="discrete", stop=True, success_distance=0.2)


def test_who_begins_at_the_goal_and_stops_has_spl_1(habitat):
    """At once, and after turns; in the last step that there is as well. Before any step nothing has succeeded."""
    for turns in (0, 1, 4):
        states = rolled(habitat, [LEFT] * turns + [STOP])
        begun, last = states[0].metrics, states[-1]
        assert not np.any([begun["success"], begun["spl"]])
        assert last.terminated.all()
        assert not last.truncated.any()  # also where `stop` is the last step of the limit
        for name in ("success", "spl", "soft_spl"):
            np.testing.assert_array_equal(last.metrics[name], 1.0, err_msg=f"{name} after {turns} turns")
        assert all(np.isfinite(x).all() for state in states for x in state.metrics.values())


def test_who_walks_away_from_the_goal_and_stops_has_spl_0(habitat):
    last = rolled(habitat, [FORWARD, FORWARD, STOP])[-1].metrics
    assert not np.any([last["success"], last["spl"], last["soft_spl"]])


def test_without_stop_nothing_is_to_be_walked_within_the_radius(bank, at_goals):
    """The first step succeeds wherever it leads, so it is no part of the way."""
    env = point_nav(bank, at_goals)
    last = rolled(env, [np.array([1.0, 0.0, 0.0, 0.0], np.float32)])[-1]
    np.testing.assert_array_equal(last.metrics["success"], 1.0)
    np.testing.assert_array_equal(last.metrics["spl"], 1.0)


def test_rows_that_begin_at_their_goal_have_spl_1(bank):
    """Rooms in which the episode begins, exactly 0 m away; without `stop` the first step succeeds as it moves."""
    options = {"impl": "kinematic", "sensors": ("state",), "actions": "discrete", "episode_length": 5}
    options |= {"min_length": 0.0, "max_length": 0.0, "num_tasks": 4}
    env = home_mjx.make("RoomNav-v0", bank, stop=True, **options)
    rows = RoomNav(min_length=0.0, max_length=0.0, num_tasks=4).task_bank(bank)  # data of the same program
    assert not np.any([env.params.tasks.rows.columns["length"], rows.rows.columns["length"]])
    reset, step = programs(env)
    for params, actions in ((env.params, [LEFT, STOP]), (env.params.replace(tasks=rows), [FORWARD])):
        state = reset(params, jax.random.split(jax.random.key(0), 3), None, jnp.arange(3))
        for action in actions:
            state = step(params, state, jnp.full(3, action))
        for name in ("success", "spl", "soft_spl"):
            np.testing.assert_array_equal(state.metrics[name], 1.0, err_msg=name)


def test_averages_count_episodes_that_begin_at_the_goal():
    """Of tasks that report success and distance only: half of the episodes begin at the goal, half fail."""
    success, zero = jnp.array([1.0, 1.0, 0.0, 0.0]), jnp.zeros(4)
    found = _path_metrics({"success": success, "walked": zero, "distance": 5.0 * (1 - success)}, zero)
    assert [float(found[name].mean()) for name in ("spl", "soft_spl")] == [0.5, 0.5]


@pytest.mark.parametrize(("shortest", "walked", "spl"), [(0.0, 0.0, 1.0), (2.0, 4.0, 0.5), (np.nan, 4.0, np.nan)])
def test_spl_of_played_episodes_is_the_same(habitat, shortest, walked, spl):
    """Tasks that report no SPL have it computed from what was walked; unknown stays unknown."""
    state = jax.eval_shape(habitat.core.reset, habitat.params, jax.random.key(0))
    state = state.replace(metrics={"success": np.float32(1)})
    found = _result(EpisodeStart(1, None, "h", "Mine", "go", shortest), EpisodeStep(1, state, 0, 0.0), walked)
    np.testing.assert_allclose(found.spl, spl)
