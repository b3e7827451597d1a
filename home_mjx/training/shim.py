"""What brax 0.14.2 calls and JAX 0.10 removed."""

from typing import Any

import jax
import numpy as np


def install() -> None:
    """Gives JAX back `device_put_replicated`, if it lacks it; safe to call often.

    brax 0.14.2, the latest release, calls it when training starts; fixed upstream after it (google/brax#671).
    """
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated  # ty: ignore


def device_put_replicated(tree: Any, devices: list[Any]) -> Any:
    """Every leaf stacked once per device, sharded along the new first axis, as the removed function did."""
    mesh = jax.sharding.Mesh(np.array(devices), ("i",))
    sharding = jax.sharding.NamedSharding(mesh, jax.sharding.PartitionSpec("i"))
    return jax.tree.map(lambda leaf: jax.device_put(np.stack([np.asarray(leaf)] * len(devices)), sharding), tree)
