"""The fused step on NVIDIA GPUs: one warp per environment. Compiled on first use."""

import functools
import threading
import warnings
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from home_mjx.core.native.nvrtc import compile_ptx
from home_mjx.core.native.varying import varying_false

TARGET = "__gpu$xla.gpu.ptx"  # XLA's own call of a kernel given as PTX
SOURCES = tuple(Path(__file__).with_name(name) for name in ("base.cuh", "shapes.cuh", "solver.cuh", "step.cu"))
WARP = 32
# As in the sources.
NEAR, POINTS_PER_MOBILE, CONTACT_WORDS = 24, 24, 53
SHARED_REALS, SHARED_INTS = 44, 6  # per mobile


def step_cuda(*operands: Array) -> tuple[Array, ...]:
    """Steps environments (e ...); operands and results as those of `cpu.step_cpu`."""
    given = [x.astype(jnp.int32 if jnp.issubdtype(x.dtype, jnp.integer) else jnp.float32) for x in operands]
    _, qpos, qvel, _, action = given[-5:]
    envs, agents = qpos.shape[0], action.shape[1]
    houses, statics, bodies = given[0].shape[0], given[0].shape[1], given[3].shape[1]
    mobiles, dofs = agents + bodies, 3 * agents + 6 * bodies
    words = (NEAR + 12 + 1) * mobiles + dofs * dofs + 2 * dofs + CONTACT_WORDS * POINTS_PER_MOBILE * mobiles
    results = (
        jax.ShapeDtypeStruct(qpos.shape, jnp.float32),
        jax.ShapeDtypeStruct(qvel.shape, jnp.float32),
        jax.ShapeDtypeStruct(qvel.shape, jnp.float32),
        jax.ShapeDtypeStruct((envs, agents), jnp.int32),
        jax.ShapeDtypeStruct((envs, 2), jnp.int32),
        jax.ShapeDtypeStruct((envs, words), jnp.float32),
    )
    if 0 in (envs, agents):
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results[:-1])
    sizes = (envs, houses, statics, bodies, agents, 4 * words)
    constants = jnp.concatenate([jnp.full(1, size, jnp.int32) for size in sizes])
    shared = 4 * ((SHARED_REALS + SHARED_INTS) * mobiles + 4)
    launch = {"grid_x": envs, "grid_y": 1, "grid_z": 1, "block_x": WARP, "block_y": 1, "block_z": 1}
    numbers = {name: np.int32(size) for name, size in {**launch, "shared_mem_bytes": shared}.items()}
    options: dict[str, Any] = {"name": "step_physics", "kernel_type": "ptx", "kernel_data": kernel(), **numbers}
    stepped = jax.ffi.ffi_call(TARGET, results)(*given, constants, **options)
    never = varying_false(operands)
    return tuple(jnp.where(never, jnp.zeros_like(x), x) for x in stepped[:-1])


@functools.cache
def cuda_available() -> bool:
    """Whether the step works here; warns once if there is an NVIDIA GPU and it does not."""
    problem = cuda_problem()
    if problem and cuda_devices():
        warnings.warn(f"physics is stepped by the slower MJX: {problem}", RuntimeWarning, stacklevel=2)
    return problem is None


@functools.cache
def cuda_problem() -> str | None:
    """Why the step cannot be used; None if it works. The first call compiles it."""
    if not cuda_devices():
        return "JAX has no NVIDIA GPU here"
    answer: list[str | None] = []
    # In its own thread: the caller may be in the middle of a trace, or under a mesh.
    thread = threading.Thread(target=lambda: answer.append(_start()))
    thread.start()
    thread.join()
    return answer[0]


def cuda_devices() -> list[Any]:
    """The NVIDIA GPUs that JAX has in this process."""
    try:
        return jax.local_devices(backend="cuda")
    except RuntimeError:
        return []


@functools.cache
def kernel() -> str:
    """PTX that all GPUs of this process can run."""
    capabilities = [int(device.compute_capability.replace(".", "")) for device in cuda_devices()]
    return compile_ptx(SOURCES, min(capabilities))


def _start() -> str | None:
    # A failure here must not end a program that MJX can run.
    try:
        kernel()
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return None
