"""Platforms (CPU, CUDA) of this process: devices, shared memory, and selection of functions at lowering."""

import functools
from collections.abc import Callable, Mapping
from typing import Any

import jax
from jaxtyping import Array

PLATFORM_OF_BACKEND = {"gpu": "cuda"}  # JAX's backend name -> name of the lowering platform
PLATFORMS = ("cpu", "cuda", "rocm", "tpu")  # besides the default backend's, which may be another
# [bytes], maximum shared memory of a block by compute capability; others use the safe minimum below.
SHARED_BYTES_BY_CAPABILITY = {
    70: 98_304,
    75: 65_536,
    80: 166_912,
    86: 101_376,
    87: 166_912,
    89: 101_376,
    90: 232_448,
    100: 232_448,
}
MIN_SHARED_BYTES = 49_152  # [bytes], available on every device


def local_devices(platform: str) -> list[Any]:
    """Return JAX's local devices of a platform ("cpu" or "cuda"); empty if JAX does not have the platform."""
    try:
        return jax.local_devices(backend=platform)
    except RuntimeError:
        return []


def select_at_lowering(fallback: Callable[..., Any], kernels: Mapping[str, Callable[..., Any]], *given: Any) -> Any:
    """Return results on `given` of the function in `kernels` for the platform of lowering, or else of `fallback`."""
    # JAX traces every branch, so a branch that cannot be selected in this process is left out.
    covered = _used_platforms() <= set(kernels)
    return jax.lax.platform_dependent(*given, default=None if covered else fallback, **kernels)


@functools.cache
def _used_platforms() -> frozenset[str]:
    """Return the platforms of this process, such as "cuda". `jax.extend.backend` has them, but loads Pallas: 40 ms."""
    default = jax.default_backend()
    found = (platform for platform in PLATFORMS if local_devices(platform))
    return frozenset({PLATFORM_OF_BACKEND.get(default, default), *found})


def with_fallback_gradient(
    fallback: Callable[..., Array], kernels: Mapping[str, Callable[..., Array]]
) -> Callable[..., Array]:
    """Return a function of arrays: the lowering platform's kernel or `fallback`, with derivatives of `fallback`."""

    @jax.custom_jvp
    def run(*given: Any) -> Array:
        """Return the result of the platform's kernel, or of `fallback`."""
        return select_at_lowering(fallback, kernels, *given) if kernels else fallback(*given)

    @run.defjvp
    def derivative(primals: Any, tangents: Any) -> tuple[Array, Array]:
        """Return the primal result and its tangent, both by `fallback`."""
        return jax.jvp(fallback, primals, tangents)

    return run


@functools.cache
def max_shared_bytes() -> int:
    """Return the shared memory that a block may use on each of the GPUs [bytes]; `MIN_SHARED_BYTES` without a GPU."""
    found = (int(device.compute_capability.replace(".", "")) for device in local_devices("cuda"))
    return min((SHARED_BYTES_BY_CAPABILITY.get(x, MIN_SHARED_BYTES) for x in found), default=MIN_SHARED_BYTES)
