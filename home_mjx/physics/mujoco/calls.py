"""Calls of C MuJoCo on the host from JAX programs."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.core.native.fork_guard import check_not_forked
from home_mjx.errors import ConfigError
from home_mjx.sharding import varying_as


def call_host(target: str, operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> tuple[Array, ...]:
    """Call a target of `register_host_call` on environments (e ...); an empty batch gives zeros without a call."""
    if operands[-1].shape[0] == 0:
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    return varying_as(operands, jax.ffi.ffi_call(target, results)(*operands))


def check_platform() -> None:
    """Refuse, while tracing, programs that C MuJoCo cannot run.

    Raises:
        ConfigError: The program is compiled for a GPU or TPU; C MuJoCo runs on the host.
        BackendError: This is a forked child of a process that has already stepped.
    """
    check_not_forked("step physics")
    device = jax.config.jax_default_device  # pyright: ignore[reportAttributeAccessIssue]
    platform = jax.default_backend() if device is None else getattr(device, "platform", device)
    if platform != "cpu":
        raise ConfigError(
            f"C MuJoCo runs on CPUs only, but this program is compiled for `{platform}` here",
            element="PhysicsConfig.impl",
            hint="Set JAX_PLATFORMS=cpu, or write `with jax.default_device(jax.devices('cpu')[0]):`",
        )
