"""Options that cannot be used are refused before anything is compiled."""

import dataclasses

import pytest

from home_mjx.errors import ConfigError
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.schema import Body


@pytest.mark.parametrize(
    ("changes", "element"),
    [
        ({"num_agents": 0}, "num_agents"),
        ({"response_time": float("inf")}, "response_time"),
        ({"control": "torque"}, "control"),
        ({"bodies": (Body(),)}, "bodies"),
        ({"impl": "cuda"}, "impl"),
        ({"jacobian": "banded"}, "jacobian"),
    ],
)
def test_useless_values_are_refused(changes, element):
    with pytest.raises(ConfigError) as error:
        PhysicsConfig(**{"num_agents": 2} | changes)
    assert error.value.element == f"PhysicsConfig.{element}"
    assert error.value.hint


def test_config_is_hashable_and_compared_by_value():
    assert len({PhysicsConfig(), PhysicsConfig(), dataclasses.replace(PhysicsConfig(), friction=0.5)}) == 2
