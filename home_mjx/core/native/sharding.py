"""Marking of constants as device-varying over mesh axes, as `shard_map`'s check requires."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool


def varying_false(*inputs: object) -> Bool[Array, ""]:
    """Return False with a type that varies over all mesh axes over which any input varies; it costs nothing."""
    zeros = (jnp.zeros_like(x, jnp.int32, shape=()) for x in jax.tree.leaves(inputs))
    return sum(zeros, jnp.int32(0)) > 0


def varying_as(inputs: object, results: Sequence[Array]) -> tuple[Array, ...]:
    """Return results of compiled code with types that vary over the mesh axes of the inputs."""
    never = varying_false(inputs)
    return tuple(jnp.where(never, jnp.zeros_like(x), x) for x in results)
