"""Options that cannot be used are refused before anything is compiled."""

import dataclasses

import pytest

from home_mjx.errors import ConfigError
from home_mjx.physics.config import PhysicsConfig


@pytest.mark.parametrize(
    ("changes", "element"),
    [
        ({"ctrl_dt": 0.09}, "ctrl_dt"),
        ({"ctrl_dt": 0.01}, "ctrl_dt"),
        ({"sim_dt": 0.0}, "sim_dt"),
        ({"num_agents": 0}, "num_agents"),
        ({"agent_mass": float("nan")}, "agent_mass"),
        ({"push_force": float("inf")}, "push_force"),
        ({"agent_height": 0.2}, "agent_height"),
        ({"impl": "cuda"}, "impl"),
        ({"jacobian": "banded"}, "jacobian"),
    ],
)
def test_useless_values_are_refused(changes, element):
    with pytest.raises(ConfigError) as error:
        PhysicsConfig(**changes)
    assert error.value.element == f"PhysicsConfig.{element}"
    assert error.value.hint


def test_control_step_is_a_whole_number_of_physics_steps():
    assert PhysicsConfig().substeps == 5
    assert PhysicsConfig(sim_dt=0.1 / 3, ctrl_dt=0.1).substeps == 3  # not exact in binary


def test_config_is_hashable_and_compared_by_value():
    assert len({PhysicsConfig(), PhysicsConfig(), dataclasses.replace(PhysicsConfig(), friction=0.5)}) == 2
