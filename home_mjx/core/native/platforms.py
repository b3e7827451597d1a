"""Platforms (CPU, CUDA) on which custom kernels work in this process, and launches of GPU kernels."""

import functools
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend.backend import backends
from jaxtyping import Array

from home_mjx.core.native.nvrtc import NO_DEFINES, compile_ptx
from home_mjx.core.native.sharding import varying_as

PTX_TARGET = "__gpu$xla.gpu.ptx"  # XLA's custom-call target that launches PTX
TITLES = {"cpu": "CPU backend", "cuda": "NVIDIA GPU"}
PLATFORM_OF_BACKEND = {"gpu": "cuda"}  # JAX's backend name -> name of the lowering platform
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


def find_problem(platform: str, start: Callable[[], str | None]) -> str | None:
    """Run `start` and return the reason why kernels cannot be used on a platform; None if they work.

    Args:
        platform: "cpu" or "cuda".
        start: Compiles, registers and tests the kernels; returns the fault or None. An exception is also a fault, so
            that it does not end a program that works without the kernels.
    """
    if not local_devices(platform):
        return f"JAX has no {TITLES[platform]} in this process"
    answer: list[str | None] = []

    def run() -> None:
        try:
            answer.append(start())
        except Exception as error:
            answer.append(f"{type(error).__name__}: {error}")

    # In its own thread, since the caller may be inside a trace or a mesh context.
    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return answer[0]


def is_usable(platform: str, problem: str | None, instead: str) -> bool:
    """Return whether `problem` is None; else warn with the substitute `instead` if the platform exists."""
    if problem and local_devices(platform):
        warnings.warn(f"{instead}: {problem}", RuntimeWarning, stacklevel=3)
    return problem is None


def select_at_lowering(fallback: Callable[..., Any], kernels: Mapping[str, Callable[..., Any]], *given: Any) -> Any:
    """Select at lowering the function of `kernels` for the target platform; `fallback` if there is none."""
    # JAX traces every branch, so a branch that cannot be selected in this process is left out.
    covered = {PLATFORM_OF_BACKEND.get(name, name) for name in backends()} <= set(kernels)
    return jax.lax.platform_dependent(*given, default=None if covered else fallback, **kernels)


def compile_ptx_for_all(source: Path | Sequence[Path], defines: Mapping[str, int] = NO_DEFINES) -> str:
    """Compile CUDA C to PTX that all GPUs of this process can run; see `nvrtc.compile_ptx`."""
    capabilities = [int(device.compute_capability.replace(".", "")) for device in local_devices("cuda")]
    return compile_ptx(source, min(capabilities), defines)


def with_fallback_gradient(
    fallback: Callable[..., Array], kernels: Mapping[str, Callable[..., Array]]
) -> Callable[..., Array]:
    """Wrap `select_at_lowering` as a function with the derivatives of `fallback`."""

    @jax.custom_jvp
    def run(*given: Any) -> Array:
        return select_at_lowering(fallback, kernels, *given) if kernels else fallback(*given)

    @run.defjvp
    def derivative(primals: Any, tangents: Any) -> tuple[Array, Array]:
        return jax.jvp(fallback, primals, tangents)

    return run


@functools.cache
def max_shared_bytes() -> int:
    """Return the shared memory that a block may use on all GPUs of this process [bytes]."""
    found = (int(device.compute_capability.replace(".", "")) for device in local_devices("cuda"))
    return min((SHARED_BYTES_BY_CAPABILITY.get(x, MIN_SHARED_BYTES) for x in found), default=MIN_SHARED_BYTES)


def call_kernel(
    name: str,
    ptx: str,
    grid: tuple[int, int],
    threads: int,
    shared: int,
    operands: Sequence[Array],
    result: jax.ShapeDtypeStruct,
) -> tuple[Array, ...]:
    """Launch a PTX kernel through XLA and return its result.

    Args:
        name: Name of the kernel.
        ptx: PTX that defines the kernel.
        grid: Number of blocks along two axes.
        threads: Threads per block.
        shared: Shared memory per block [bytes].
        operands: Arguments in the kernel's order; converted to int32 or float32.
        result: Shape and dtype of the result.
    """
    names = "grid_x", "grid_y", "grid_z", "block_x", "block_y", "block_z", "shared_mem_bytes"
    sizes = (*grid, 1, threads, 1, 1, shared)
    launch: dict[str, Any] = {name: np.int32(size) for name, size in zip(names, sizes, strict=True)}
    launch |= {"name": name, "kernel_type": "ptx", "kernel_data": ptx}
    call = jax.ffi.ffi_call(PTX_TARGET, (result,))
    return varying_as(operands, call(*(_plain(x) for x in operands), **launch))


def _plain(values: Array) -> Array:
    return values.astype(jnp.int32 if jnp.issubdtype(values.dtype, jnp.integer) else jnp.float32)
