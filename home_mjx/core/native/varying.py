"""Values made inside a program that must vary over a mesh as its inputs do (`shard_map` checks it)."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool


def varying_false(*inputs: object) -> Bool[Array, ""]:
    """False, with a type that varies over all mesh axes over which any input varies. It costs nothing."""
    zeros = (jnp.zeros_like(x, jnp.int32, shape=()) for x in jax.tree.leaves(inputs))
    return sum(zeros, jnp.int32(0)) > 0
