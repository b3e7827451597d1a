"""A clip that nobody hears is told by a flag, whatever senses an environment has."""

import functools

import jax
import jax.numpy as jnp
import pytest
from handmade import shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.tasks import Status, make_config

INSIDE, IN_WALL, OUTSIDE, NOWHERE = (-1.0, 0.0, 1.0), (3.05, 0.0, 1.0), (9.0, 0.0, 1.0), (jnp.nan, 0.0, 1.0)
FEW = {"late": "traced", "num_rays": 8, "num_bounces": 3, "impl": "kinematic", "num_agents": 2}


@pytest.mark.parametrize(
    "options",
    [
        {"sensors": ("audio",)},
        {"sensors": ("log_mel",), "motion": True},
        pytest.param({"sensors": ("ear_levels",)}, marks=pytest.mark.slow),
    ],
)
def test_a_source_that_no_agent_hears_is_told(options):
    """Walls let nothing through; a source outside is heard by an agent beside it; silence is no source."""
    core = HouseholdEnv(make_config(**FEW, **options))
    env = core.bind(HouseBank.from_compiled([shoebox((6.0, 5.0, 3.0))]))
    begun = jax.jit(functools.partial(core.reset, observe=False))(env.params, jax.random.key(0))
    perceive = jax.jit(functools.partial(core.observe, update=True))

    def told(source, second=(1.0, 1.0), clip=0):
        sounds = begun.world.sounds.replace(pos=jnp.float32([source]), clip=jnp.array([clip], jnp.int32))
        qpos = begun.physics.qpos.at[jnp.array([0, 1, 4, 5])].set(jnp.float32([1.0, -1.0, *second]))
        state = begun.replace(physics=begun.physics.replace(qpos=qpos), world=begun.world.replace(sounds=sounds))
        return bool(int(perceive(env.params, state).status) & Status.UNHEARD)

    assert not told(INSIDE)
    assert told(IN_WALL)
    assert told(OUTSIDE)
    assert told(NOWHERE)
    assert not told(OUTSIDE, second=(8.0, 0.0))
    assert not told(OUTSIDE, clip=-1)
