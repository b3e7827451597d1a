"""Auto-resetting batches as functions of one environment."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap

from home_mjx.tasks.base.state import EnvParams, State


def as_single_env(run: Callable[..., State]) -> Callable[..., State]:
    """Convert a function of a batch to a function of one environment.

    Under `vmap` the whole batch is passed to `run`. Thus `AutoReset` still branches on the batch: new episodes are
    drawn and images of last observations rendered only in steps in which an episode ends.

    Args:
        run: `(params, *args)`; every array of `args` and of the result has a leading axis of environments.

    Returns:
        `(params, *args)` without that axis, jitted. If `params` differ between environments, as under
        `vmap(..., in_axes=0)`, every environment is its own batch.

    Example:
        >>> step = as_single_env(AutoReset(env.core).step)  # doctest: +SKIP
        >>> states = jax.vmap(step, in_axes=(None, 0, 0))(env.params, states, actions)  # doctest: +SKIP
    """

    def alone(params: EnvParams, *args: Any) -> State:
        """Run a batch of one environment."""
        return jax.tree.map(lambda x: x[0], run(params, *jax.tree.map(lambda x: jnp.asarray(x)[None], args)))

    one = custom_vmap(alone)

    @one.def_vmap
    def fold(size: int, is_batched: Any, params: EnvParams, *args: Any) -> Any:
        """Run `size` environments as one batch, or as batches of one if `params` are batched: the rule of `vmap`."""
        shared, *own = is_batched
        if any(jax.tree.leaves(shared)):
            axes = jax.tree.map(lambda b: 0 if b else None, (shared, *own))
            result = jax.vmap(alone, axes)(params, *args)
        else:
            whole = jax.tree.map(lambda x, b: x if b else jnp.broadcast_to(x, (size, *jnp.shape(x))), args, tuple(own))
            result = run(params, *whole)
        return result, jax.tree.map(lambda _: True, result)

    return jax.jit(one)


def strip_observations(state: State) -> State:
    """Return a copy of the state with empty `obs` and `info`, which no step reads, so that loops do not store them."""
    return state.replace(obs={}, info={})
