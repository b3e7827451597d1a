"""Patches of brax 0.14.2: a function that JAX 0.10 removed, and a fix for loading its checkpoints."""

import importlib
import importlib.util
from typing import Any

import jax
import numpy as np


def install() -> None:
    """Restore `jax.device_put_replicated` if it is missing, and fix loading of Brax checkpoints; idempotent.

    brax 0.14.2, the latest release, calls the function when training starts; fixed upstream later (google/brax#671). It
    saves the default kernel initialiser as None, but looks it up by name when loading. Therefore
    `checkpoint.load_policy(path)` raises KeyError for every network with default arguments.
    """
    if importlib.util.find_spec("brax") is not None:
        importlib.import_module("brax.training.networks").KERNEL_INITIALIZER.setdefault(None, None)
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated  # ty: ignore


def device_put_replicated(tree: Any, devices: list[Any]) -> Any:
    """Copy every leaf to each device: stacked along a new first axis, which is sharded, as by the removed function."""
    mesh = jax.sharding.Mesh(np.array(devices), ("i",))
    sharding = jax.sharding.NamedSharding(mesh, jax.sharding.PartitionSpec("i"))
    return jax.tree.map(lambda leaf: jax.device_put(np.stack([np.asarray(leaf)] * len(devices)), sharding), tree)
