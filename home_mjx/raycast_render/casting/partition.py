"""Partitioning of a cast over devices: by environments and by rays, never by geometry."""

from collections.abc import Callable, Sequence
from typing import Any

import jax
from jax.experimental.custom_partitioning import custom_partitioning
from jax.interpreters.mlir import ir
from jax.sharding import NamedSharding, PartitionSpec

from home_mjx.raycast_render.scene.types import RawHit

NUM_ENV_ARRAYS = 9  # arrays with a leading axis of environments: the house and the fields of Moving
NUM_RAY_FIELDS = 6  # fields of Rays


def add_partitioning(run: Callable[..., RawHit]) -> Callable[..., RawHit]:
    """Return `run(geometry, house (e), moving (e ...), rays (e r ...))` with a partitioning rule.

    Without a rule, a program on sharded inputs would gather them all on every device before each cast.
    """

    def partition(mesh: Any, arguments: Any, results: Any) -> Any:
        count = arguments[3].shape[1]
        full = next(x for x in jax.tree.leaves(arguments[3]) if x.shape[1] == count)
        by_env, by_ray = (*full.sharding.spec, None, None)[:2]
        whole, env, ray = (NamedSharding(mesh, PartitionSpec(*axes)) for axes in ((), (by_env,), (by_env, by_ray)))
        geometry, house, moving = (
            jax.tree.map(lambda _, s=s: s, x) for s, x in zip((whole, env, env), arguments[:3], strict=True)
        )
        rays = jax.tree.map(lambda x: ray if x.shape[1] == count else env, arguments[3])
        return mesh, run, jax.tree.map(lambda _: ray, results), (geometry, house, moving, rays)

    cast = custom_partitioning(run)
    cast.def_partition(partition=partition, sharding_rule=_sharding_rule)
    return cast


def _sharding_rule(mesh: Any, operands: Sequence[ir.Type], results: Sequence[ir.Type]) -> str:
    """Return an einsum-like rule: `e` environments, `r` rays; all other axes are independent."""
    alone = len(operands) - NUM_ENV_ARRAYS - NUM_RAY_FIELDS
    shared = [()] * alone + [("e",)] * NUM_ENV_ARRAYS
    shared += [
        ("e", "r") if _shape(rays)[1] == _shape(results[0])[1] else ("e",) for rays in operands[-NUM_RAY_FIELDS:]
    ]
    rule = [
        " ".join((*names, *(f"x{i}y{axis}" for axis in range(len(names), len(_shape(operand))))))
        for i, (names, operand) in enumerate(zip(shared, operands, strict=True))
    ]
    steps = "".join(f" step{axis}" for axis in range(2, len(_shape(results[0]))))
    return ", ".join(rule) + " -> " + ", ".join(f"e r{steps}" for _ in results)


def _shape(operand: ir.Type) -> list[int]:
    return ir.RankedTensorType(operand).shape
