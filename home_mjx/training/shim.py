"""What brax 0.14.2 lacks: a function that it calls and JAX 0.10 removed, and a way to read its own checkpoints."""

import importlib
import importlib.util
from typing import Any

import jax
import numpy as np


def install() -> None:
    """Gives JAX back `device_put_replicated`, if it lacks it, and lets Brax load its checkpoints; safe to call often.

    brax 0.14.2, the latest release, calls the function when training starts; fixed upstream after it (google/brax#671).
    It writes what starts a layer's weights by name, and None, which is the default, as None; when it reads it, it looks
    for a name None: `checkpoint.load_policy(path)` is a KeyError for every network of default arguments.
    """
    if importlib.util.find_spec("brax") is not None:
        importlib.import_module("brax.training.networks").KERNEL_INITIALIZER.setdefault(None, None)
    if not hasattr(jax, "device_put_replicated"):
        jax.device_put_replicated = device_put_replicated  # ty: ignore


def device_put_replicated(tree: Any, devices: list[Any]) -> Any:
    """Every leaf stacked once per device, sharded along the new first axis, as the removed function did."""
    mesh = jax.sharding.Mesh(np.array(devices), ("i",))
    sharding = jax.sharding.NamedSharding(mesh, jax.sharding.PartitionSpec("i"))
    return jax.tree.map(lambda leaf: jax.device_put(np.stack([np.asarray(leaf)] * len(devices)), sharding), tree)
