"""Options that cannot be used are refused before anything is compiled."""

import dataclasses

import jax
import jax.numpy as jnp
import pytest
from tiny_houses import Door, TinyHouse, make_bank

from home_mjx.errors import ConfigError
from home_mjx.physics import Template, reset, step
from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.schema import AgentBody


@pytest.mark.parametrize(
    ("changes", "element"),
    [
        ({"num_agents": 0}, "num_agents"),
        ({"response_time": float("inf")}, "response_time"),
        ({"control": "torque"}, "control"),
        ({"bodies": (AgentBody(),)}, "bodies"),
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


@pytest.mark.parametrize("impl", ["fused", "jax", "c", "kinematic"])
@pytest.mark.parametrize("shape", [(1, 3), (3, 3)])
def test_actions_of_another_shape_are_refused(impl, shape):
    """Kinematic agents once shared one action."""
    bank = make_bank([TinyHouse(doors=[Door((1.0, 0.0), yaw=0.0, high=1.5)])])
    template, house = Template(PhysicsConfig(impl=impl, num_agents=2), bank.spec), jnp.int32(0)
    state = reset(template, bank, house, jnp.zeros((2, 3)), jnp.zeros(2))
    with pytest.raises(ConfigError, match=r"`action` must have the shape \(2, 3\)"):
        jax.eval_shape(lambda action: step(template, bank, house, state, action), jnp.zeros(shape))


@pytest.mark.parametrize(
    ("name", "pos", "yaw", "doors"),
    [
        ("agent_pos", (3, 3), (3,), (3,)),
        ("door_angle", (2, 3), (2,), (2,)),
    ],
)
def test_starts_that_do_not_fit_are_refused(name, pos, yaw, doors):
    bank = make_bank([TinyHouse(doors=[Door((1.0, 0.0), yaw=0.0, high=1.5)])])
    template = Template(PhysicsConfig(num_agents=2), bank.spec)
    with pytest.raises(ConfigError, match=f"`{name}` must have the shape"):
        reset(template, bank, jnp.int32(0), jnp.zeros(pos), jnp.zeros(yaw), jnp.zeros(doors))
