"""JAX's 64-bit mode, in which users look for rounding: an environment is traced, and stays in 32 bits."""

import jax
import jax.numpy as jnp
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.env.household import HouseholdEnv


def test_a_step_keeps_the_types_of_a_reset_in_64_bit_mode():
    bank = HouseBank.from_compiled([shoebox(furniture=[Furniture((1.0, 1.0), mass=5.0)])])
    env = HouseholdEnv(make_config(sensors=("state", "goal"))).bind(bank)
    with jax.enable_x64(True):
        state = jax.eval_shape(env.core.reset, env.params, jax.random.key(0))
        after = jax.eval_shape(env.core.step, env.params, state, jax.ShapeDtypeStruct((4,), jnp.float32))
    types = [jax.tree.map(lambda x: (x.shape, x.dtype), tree) for tree in (state, after)]
    assert types[0] == types[1]
    assert {str(x.dtype) for x in jax.tree.leaves(state)} <= {"float32", "int32", "uint32", "bool", "int8", "uint8"}
