"""How a compiler that spreads a program over devices may cut a cast: by environments and rays, never the geometry."""

from collections.abc import Callable, Sequence
from typing import Any

import jax
from jax.experimental.custom_partitioning import custom_partitioning
from jax.interpreters.mlir import ir
from jax.sharding import NamedSharding, PartitionSpec

from home_mjx.raycast_render.types import RawHit

NUM_PLACES = 9  # arrays with a leading axis of environments: the house and the fields of Moving
NUM_RAYS = 6  # fields of Rays


def partitioned(run: Callable[..., RawHit]) -> Callable[..., RawHit]:
    """`run(geometry, house (e), moving (e ...), rays (e r ...))` with a partitioning rule.

    Without one, a program on sharded inputs gathers them all on every device before each cast.
    """

    def partition(mesh: Any, arguments: Any, results: Any) -> Any:
        by_env, by_ray = (*arguments[3].t_min.sharding.spec, None, None)[:2]
        specs = PartitionSpec(), PartitionSpec(by_env), PartitionSpec(by_env), PartitionSpec(by_env, by_ray)
        shardings = [NamedSharding(mesh, spec) for spec in specs]
        spread = tuple(jax.tree.map(lambda _, s=s: s, x) for s, x in zip(shardings, arguments, strict=True))
        return mesh, run, jax.tree.map(lambda _: shardings[3], results), spread

    cast = custom_partitioning(run)
    cast.def_partition(partition=partition, sharding_rule=_sharding_rule)
    return cast


def _sharding_rule(mesh: Any, operands: Sequence[ir.Type], results: Sequence[ir.Type]) -> str:
    """An einsum-like rule: `e` environments, `r` rays; all other axes stand for themselves."""
    alone = len(operands) - NUM_PLACES - NUM_RAYS
    shared = [()] * alone + [("e",)] * NUM_PLACES + [("e", "r")] * NUM_RAYS
    rule = [
        " ".join((*names, *(f"x{i}y{axis}" for axis in range(len(names), ir.RankedTensorType(operand).rank))))
        for i, (names, operand) in enumerate(zip(shared, operands, strict=True))
    ]
    return ", ".join(rule) + " -> " + ", ".join("e r" for _ in results)
