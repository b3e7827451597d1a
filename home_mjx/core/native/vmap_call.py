"""Batching and partitioning rules for compiled step functions whose leading axis `e` is environments."""

import functools
from collections.abc import Callable, Hashable, Sequence
from typing import Any, NoReturn

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array

from home_mjx.core.native.partition import ENV, partition_kernel
from home_mjx.errors import ConfigError

Step = Callable[..., tuple[Array, ...]]


def batch_kernel(run: Step, num_shared: int, num_results: int) -> Step:
    """Wrap `run` for any nesting of `vmap`, and for inputs that are sharded over devices by environments.

    Args:
        run: Step function. All environments share its first operands; the other operands and the results have a
            leading environment axis, into which mapped axes are folded. If a shared operand is mapped, `run` is looped.
        num_shared: Number of shared operands.
        num_results: Number of results.
    """
    axes = lambda operands, results: (  # noqa: E731
        [()] * num_shared + [(ENV,)] * (len(operands) - num_shared),
        [(ENV,)] * len(results),
    )
    spread = partition_kernel(run, axes)

    @custom_vmap
    def step(*operands: Array) -> tuple[Array, ...]:
        """Run the partitioned step function."""
        return spread(*operands)

    @step.def_vmap
    def fold(size: int, is_batched: Any, *operands: Array) -> Any:
        """Apply the `vmap` rule: fold the mapped axis into the environments, or loop over mapped shared operands."""
        many = (True,) * num_results
        whole = tuple(
            x if b else jnp.broadcast_to(x[None], (size, *x.shape)) for x, b in zip(operands, is_batched, strict=True)
        )
        if any(is_batched[:num_shared]):
            return jax.lax.map(lambda x: step(*x), whole), many
        own = (x.reshape(size * x.shape[1], *x.shape[2:]) for x in whole[num_shared:])
        stepped = step(*operands[:num_shared], *own)
        return tuple(x.reshape(size, x.shape[0] // size, *x.shape[1:]) for x in stepped), many

    return step


def call_kernel(
    launch: Step, options: tuple[Hashable, ...], shared: Sequence[Array], operands: Sequence[Array]
) -> Array:
    """Call `launch(*options, *shared, *operands)` through `batch_kernel` for one environment; return its only result.

    `operands` have no environment axis here. The batched function is cached for `launch` and `options`.
    """
    return _batched(launch, options, len(shared))(*shared, *(x[None] for x in operands))[0][0]


@functools.cache
def _batched(launch: Step, options: tuple[Hashable, ...], num_shared: int) -> Step:
    """Return the batched `launch` with its first arguments `options`."""
    return batch_kernel(functools.partial(launch, *options), num_shared, 1)


def forbid_gradient(step: Step, name: str) -> Step:
    """Wrap a step so that differentiation raises `ConfigError`, whose message begins with `name`."""
    guarded = jax.custom_jvp(step)

    @guarded.defjvp
    def refuse(primals: Any, tangents: Any) -> NoReturn:
        """Raise `ConfigError` instead of differentiating."""
        raise ConfigError(
            f"{name} has no gradient",
            element="PhysicsConfig.impl",
            hint="Use PhysicsConfig(impl='jax') for `jax.jvp`, with iterations=1 also for `jax.grad`; or "
            "`jax.lax.stop_gradient` on the actions",
        )

    return guarded


def traced_constant(values: Sequence[float], dtype: Any = jnp.int32) -> Array:
    """Build a 1-D array, not empty, by traced operations, for partitioned functions, which must not capture arrays."""
    return jnp.concatenate([jnp.full(1, value, dtype) for value in values])
