"""Text observations: an object in view is named with its number, distance and side; what is behind is not."""

import re

import jax
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import make_config
from home_mjx.tasks.language import describe
from home_mjx.tasks.suite import PointNav

PLACE = np.array([1.5, 1.0])  # [m] of the only object


@pytest.fixture(scope="module")
def snapshots():
    """Views from random poses of a hall with one object."""
    bank = HouseBank.from_compiled([shoebox(furniture=[Furniture(tuple(PLACE), (0.5, 0.5, 1.4))])])
    env = HouseholdEnv(make_config(sensors=("state",), impl="kinematic"), PointNav()).bind(bank)
    reset, look = jax.jit(jax.vmap(env.core.reset, (None, 0))), jax.jit(env.core.snapshot)
    states = reset(env.params, jax.random.split(jax.random.key(0), 24))
    return [look(env.params, jax.tree.map(lambda x, i=i: x[i], states)) for i in range(24)]


def test_what_is_in_view_is_named_where_it_is(snapshots):
    named = 0
    for snapshot in snapshots:
        away = PLACE - np.asarray(snapshot.pose.pos)[0, :2]
        angle = np.degrees(np.angle(np.exp(1j * (np.arctan2(away[1], away[0]) - float(snapshot.pose.yaw[0])))))
        distance, text = np.linalg.norm(away), describe(snapshot)
        assert text.startswith("You are ")
        found = re.findall(r"(\d+) \((\d+\.\d) m, (left|ahead|right)\)", text)
        if abs(angle) > 90:
            assert not found
            assert text.endswith("You see nothing but walls.")
        elif abs(angle) < 35 and distance > 0.8:
            ((_, length, side),) = found
            assert distance - 0.4 <= float(length) <= distance + 0.3
            assert side == (
                "ahead" if abs(angle) < 8 else side if abs(angle) < 22 else "left" if angle > 0 else "right"
            )
            named += 1
    assert named >= 3


def test_unknown_agents_are_refused(snapshots):
    with pytest.raises(ConfigError, match="agent"):
        describe(snapshots[0], 1)
