"""PyTorch: arrays of JAX as tensors and back, in the same memory.

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
    """JAX arrays as tensors by DLPack, on their device and without a copy.

    JAX takes its arrays to be constant: do not write into the tensors (`tensor.clone()` may be written to), and do not
    give the arrays to a function that was jitted with `donate_argnums` while the tensors are in use.

    Args:
        tree: Arrays, or nested containers of them such as `State.obs`; each on one device.

    Returns:
        The same containers with a `torch.Tensor` for each array, of the same shape and type.

    Raises:
        ConfigError: One of the arrays holds typed keys of random numbers, which are no numbers.
    """
    return jax.tree.map(_to_torch, tree)


def _to_torch(array: Any) -> Any:
    if isinstance(array, jax.Array) and jnp.issubdtype(array.dtype, jax.dtypes.prng_key):
        hint = "Take their numbers, `jax.random.key_data(keys)`; `jax.random.wrap_key_data` makes keys of them again."
        raise ConfigError(f"expected an array of numbers, got typed keys of random numbers: {array.aval}", hint=hint)
    return torch.from_dlpack(array)


def to_jax(tree: Any) -> Any:
    """Tensors as JAX arrays by DLPack, on their device and without a copy; gradients are not carried over.

    Writing into a tensor afterwards changes the array as well.

    Args:
        tree: Tensors, contiguous ones, or nested containers of them.

    Returns:
        The same containers with a `jax.Array` for each tensor, of the same shape and type; but without
        `jax_enable_x64`, numbers of 64 bits are copied to 32.
    """
    return jax.tree.map(lambda x: jax.dlpack.from_dlpack(x.detach()), tree)
