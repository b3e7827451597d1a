"""PyTorch: conversion between JAX arrays and tensors that share memory.

Example:
    >>> obs = to_torch(states.obs)  # doctest: +SKIP
    >>> states = step(states, to_jax(policy(obs)))  # doctest: +SKIP
"""

# No extra installs PyTorch.
# pyright: reportMissingImports=false

from typing import Any

import jax
import jax.numpy as jnp

from home_mjx.errors import ConfigError

try:
    import torch
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `torch`", hint="pip install torch") from error


def to_torch(tree: Any) -> Any:
    """Convert JAX arrays to tensors by DLPack, on their device and without a copy.

    JAX assumes that its arrays are constant. Do not write into the tensors (`tensor.clone()` may be written to). Do not
    pass the arrays to a function with `donate_argnums` while the tensors are in use.

    Args:
        tree: Arrays, or nested containers of them such as `State.obs`; each on one device.

    Returns:
        The same containers with a `torch.Tensor` for each array, of the same shape and type.

    Raises:
        ConfigError: An array contains typed random keys, which are not numbers.
    """
    return jax.tree.map(_to_torch, tree)


def _to_torch(array: Any) -> Any:
    """Convert one array, see `to_torch`."""
    if isinstance(array, jax.Array) and jnp.issubdtype(array.dtype, jax.dtypes.prng_key):
        hint = "Convert with `jax.random.key_data(keys)`; `jax.random.wrap_key_data` converts back."
        raise ConfigError(f"expected an array of numbers, got typed random keys: {array.aval}", hint=hint)
    return torch.from_dlpack(array)


def to_jax(tree: Any) -> Any:
    """Convert tensors to JAX arrays by DLPack, on their device and without a copy; gradients are not carried over.

    Writing into a tensor afterwards changes the array as well.

    Args:
        tree: Contiguous tensors, or nested containers of them.

    Returns:
        The same containers with a `jax.Array` for each tensor, of the same shape and type. Without `jax_enable_x64`,
        64-bit numbers are copied to 32 bits.
    """
    return jax.tree.map(lambda x: jax.dlpack.from_dlpack(x.detach()), tree)
