"""On which platforms of this process own kernels work, and the GPU's kernels themselves."""

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

PTX_TARGET = "__gpu$xla.gpu.ptx"  # XLA's own call of a kernel given as PTX
TITLES = {"cpu": "CPU backend", "cuda": "NVIDIA GPU"}
PLATFORMS = {"gpu": "cuda"}  # JAX's name of a backend -> that of the platform programs are lowered for
# Bytes of memory that a block may share, by compute capability; of others it is a safe guess.
SHARED_BYTES = {70: 98_304, 75: 65_536, 80: 166_912, 86: 101_376, 87: 166_912, 89: 101_376, 90: 232_448, 100: 232_448}
LEAST_SHARED_BYTES = 49_152


def devices_of(platform: str) -> list[Any]:
    """The devices of a platform ("cpu" or "cuda") that JAX has in this process."""
    try:
        return jax.local_devices(backend=platform)
    except RuntimeError:
        return []


def problem_of(platform: str, start: Callable[[], str | None]) -> str | None:
    """Why kernels cannot be used on a platform; None if they work.

    Args:
        platform: "cpu" or "cuda".
        start: Compiles, registers and tests them; gives the fault or None. What it raises is a fault, too: it must not
            end a program that can do without.
    """
    if not devices_of(platform):
        return f"JAX has no {TITLES[platform]} here"
    answer: list[str | None] = []

    def run() -> None:
        try:
            answer.append(start())
        except Exception as error:
            answer.append(f"{type(error).__name__}: {error}")

    # In its own thread: the caller may be in the middle of a trace, or under a mesh.
    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return answer[0]


def works(platform: str, problem: str | None, instead: str) -> bool:
    """Whether there is no problem; warns if there is one although the platform is here: `instead` says what is used."""
    if problem and devices_of(platform):
        warnings.warn(f"{instead}: {problem}", RuntimeWarning, stacklevel=3)
    return problem is None


def choose(slow: Callable[..., Any], fast: Mapping[str, Callable[..., Any]], *given: Any) -> Any:
    """What `fast` gives on the platform for which a program is lowered, or `slow` where it has none."""
    # JAX traces every branch, whichever is lowered: one that cannot be chosen in this process is left out.
    covered = {PLATFORMS.get(name, name) for name in backends()} <= set(fast)
    return jax.lax.platform_dependent(*given, default=None if covered else slow, **fast)


def ptx_for_all(source: Path | Sequence[Path], defines: Mapping[str, int] = NO_DEFINES) -> str:
    """PTX of CUDA C that all GPUs of this process can run; see `nvrtc.compile_ptx`."""
    capabilities = [int(device.compute_capability.replace(".", "")) for device in devices_of("cuda")]
    return compile_ptx(source, min(capabilities), defines)


def by_platform(slow: Callable[..., Array], fast: Mapping[str, Callable[..., Array]]) -> Callable[..., Array]:
    """A function as `choose` has it, with the derivatives of `slow`."""

    @jax.custom_jvp
    def run(*given: Any) -> Array:
        return choose(slow, fast, *given) if fast else slow(*given)

    @run.defjvp
    def derivative(primals: Any, tangents: Any) -> tuple[Array, Array]:
        return jax.jvp(slow, primals, tangents)

    return run


@functools.cache
def shared_bytes() -> int:
    """What a block may share on all GPUs of this process."""
    found = (int(device.compute_capability.replace(".", "")) for device in devices_of("cuda"))
    return min((SHARED_BYTES.get(x, LEAST_SHARED_BYTES) for x in found), default=LEAST_SHARED_BYTES)


def call_kernel(
    name: str,
    ptx: str,
    grid: tuple[int, int],
    threads: int,
    shared: int,
    operands: Sequence[Array],
    result: jax.ShapeDtypeStruct,
) -> tuple[Array, ...]:
    """The result of a kernel, which XLA launches.

    Args:
        name: Of the kernel.
        ptx: That holds it.
        grid: Blocks along two axes.
        threads: Of a block.
        shared: Bytes that its threads share.
        operands: As the kernel takes them, but for their types.
        result: What it writes.
    """
    names = "grid_x", "grid_y", "grid_z", "block_x", "block_y", "block_z", "shared_mem_bytes"
    sizes = (*grid, 1, threads, 1, 1, shared)
    launch: dict[str, Any] = {name: np.int32(size) for name, size in zip(names, sizes, strict=True)}
    launch |= {"name": name, "kernel_type": "ptx", "kernel_data": ptx}
    call = jax.ffi.ffi_call(PTX_TARGET, (result,))
    return varying_as(operands, call(*(_plain(x) for x in operands), **launch))


def _plain(values: Array) -> Array:
    return values.astype(jnp.int32 if jnp.issubdtype(values.dtype, jnp.integer) else jnp.float32)
