"""Compiled functions on sharded arrays: partitioning rules, and values that vary over mesh axes.

The mesh and the partition specs of environments are in `home_mjx.sharding`. Here are only leading axes of kernels.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax.experimental.custom_partitioning import custom_partitioning
from jax.interpreters.mlir import ir
from jax.sharding import NamedSharding, PartitionSpec
from jaxtyping import Array, Bool

ENV, RAY = "e", "r"  # axes of arrays in sharding rules: environments, and rays of an environment

T = TypeVar("T")
Axes = tuple[str, ...]
LeadingAxes = Callable[[list[tuple[int, ...]], list[tuple[int, ...]]], tuple[list[Axes], list[Axes]]]


def partition_kernel(run: Callable[..., T], leading_axes: LeadingAxes) -> Callable[..., T]:
    """Return a function with a partitioning rule: it runs on each device's environments and rays.

    Without a rule, a program on sharded inputs gathers them all on every device before each call.

    Args:
        run: Function of pytrees; it must not capture arrays.
        leading_axes: Function of the shapes of all operands and of all results that returns the leading axes of each,
            such as `("e", "r")`; `()` for shared operands. All other axes stay whole.
    """

    def partition(mesh: Any, arguments: Any, results: Any) -> Any:
        """Return mesh, function, result and operand shardings, taken from the operand with most leading axes."""
        operands, operand_tree = jax.tree.flatten(arguments)
        made, result_tree = jax.tree.flatten(results)
        axes, result_axes = leading_axes([x.shape for x in operands], [x.shape for x in made])
        widest = max(range(len(axes)), key=lambda i: len(axes[i]))
        places = dict(zip(axes[widest], (*operands[widest].sharding.spec, None, None), strict=False))
        place = lambda names: NamedSharding(mesh, PartitionSpec(*(places.get(name) for name in names)))  # noqa: E731
        return mesh, run, result_tree.unflatten(map(place, result_axes)), operand_tree.unflatten(map(place, axes))

    def rule(mesh: Any, operands: Sequence[ir.Type], results: Sequence[ir.Type]) -> str:
        """Return the Shardy rule: leading axes are shared by name, all others are not."""
        given, made = ([tuple(ir.RankedTensorType(x).shape) for x in tensors] for tensors in (operands, results))
        axes, result_axes = leading_axes(given, made)
        left = (_factors(*item, f"x{i}y") for i, item in enumerate(zip(given, axes, strict=True)))
        right = (_factors(*item, f"z{i}y") for i, item in enumerate(zip(made, result_axes, strict=True)))
        return f"{', '.join(left)} -> {', '.join(right)}"

    split = custom_partitioning(run)
    split.def_partition(partition=partition, sharding_rule=rule)
    return split


def _factors(shape: tuple[int, ...], axes: Axes, prefix: str) -> str:
    """Return an array's part of the einsum-like sharding rule: `axes`, then names of its own (`prefix` + number)."""
    return " ".join((*axes, *(f"{prefix}{axis}" for axis in range(len(axes), len(shape)))))


def varying_false(*inputs: object) -> Bool[Array, ""]:
    """Return False with a type that varies over all mesh axes over which any input varies; it costs nothing.

    `shard_map` checks that the carries of loops and the branches of conditionals vary over the same mesh axes. A
    constant becomes varying by a computation with this value.
    """
    zeros = (jnp.zeros_like(x, jnp.int32, shape=()) for x in jax.tree.leaves(inputs))
    return sum(zeros, jnp.int32(0)) > 0


def varying_as(inputs: object, results: Sequence[Array]) -> tuple[Array, ...]:
    """Return results with equal values, typed to vary over all mesh axes over which an input varies."""
    never = varying_false(inputs)
    return tuple(jnp.where(never, jnp.zeros_like(x), x) for x in results)


def run_untraced(make: Callable[[], T]) -> T:
    """Return `make()`, run in a thread of its own: arrays made within a trace or `shard_map` would belong to it."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(make).result()
