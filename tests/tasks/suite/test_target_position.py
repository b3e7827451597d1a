"""`target_position` of tasks with hands: against positions of the house, by hand; and who has it."""

import dataclasses
import math

import jax
import numpy as np
import pytest

import home_mjx
from home_mjx.tasks import HouseholdEnv
from home_mjx.tasks.rules.enums import Attribute, TargetKind
from home_mjx.tasks.rules.features import current_boxes
from home_mjx.tasks.suite import Fetch

NAME = "target_position"


@pytest.fixture(scope="module")
def env():
    options = {"sensors": (NAME,), "impl": "kinematic", "gives_positions": True, "num_tasks": 12}
    return home_mjx.make("Fetch-v0", "procedural:1?preset=flat", **options)


def by_hand(env, state, point: np.ndarray) -> list[float]:
    """Distance, bearing, height above the feet, and angle above the view centre of a point."""
    snapshot = env.core.snapshot(env.params, state)
    feet, yaw, pitch = (np.asarray(x)[0] for x in (snapshot.feet, snapshot.pose.yaw, snapshot.pose.pitch))
    eye = feet[2] + env.config.body.eye_height
    x, y = point[0] - feet[0], point[1] - feet[1]
    bearing = math.atan2(y, x) - yaw
    tilt = math.atan2(point[2] - eye, math.hypot(x, y)) - pitch
    return [math.hypot(x, y), math.cos(bearing), math.sin(bearing), point[2] - feet[2], tilt]


def test_it_leads_to_the_object_and_then_to_its_destination(env):
    reset, observe = jax.jit(env.reset), jax.jit(lambda state: env.core.observe(env.params, state).obs[NAME])
    kinds = set()
    columns = env.params.tasks.rows.columns
    for row in range(len(env.params.tasks)):
        state = reset(jax.random.key(row), episode=row)
        targets, boxes = state.task.targets, np.asarray(current_boxes(env.core.snapshot(env.params, state)))
        (thing,) = np.flatnonzero(np.asarray(targets.instance[0]))
        assert state.obs[NAME] == pytest.approx(by_hand(env, state, boxes[thing].mean(axis=0)), abs=1e-3)
        later = state.replace(task=state.task.replace(goal=state.task.goal + 1))
        kind = int(columns["descriptor"][row, 1, Attribute.KIND])
        kinds.add(kind)
        if kind == TargetKind.ROOM:
            assert not np.any(observe(later))
            continue
        goal = np.asarray(state.task.program.place[1])
        if kind == TargetKind.OBJECT:
            (place,) = np.flatnonzero(np.asarray(targets.instance[1]))
            goal = boxes[place].mean(axis=0)
        assert observe(later) == pytest.approx(by_hand(env, state, goal), abs=1e-3)
    assert kinds == {TargetKind.ROOM, TargetKind.PLACE, TargetKind.OBJECT}


def test_it_is_an_option(env):
    assert NAME in env.observation_spec
    plain = dataclasses.replace(Fetch(), gives_positions=False)
    assert NAME not in HouseholdEnv(env.config.replace(sensors=("state",)), plain).task.observation_spec
