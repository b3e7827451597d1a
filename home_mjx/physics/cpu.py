"""The fused step on CPUs: `native`, compiled by Numba and called by XLA. Compiled on first use."""

import functools

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.core.native.forked import note_start
from home_mjx.core.native.platforms import problem_of, works
from home_mjx.core.native.varying import varying_false

TARGET = "home_mjx_step"

_kept: list[object] = []  # compiled functions that XLA may call until the process ends


def step_cpu(*operands: Array) -> tuple[Array, ...]:
    """Steps environments (e ...); operands and results in the order of `native.handler`."""
    floats = [x.astype(jnp.int32 if jnp.issubdtype(x.dtype, jnp.integer) else jnp.float32) for x in operands]
    house, qpos, qvel, _, action = floats[-5:]
    count, agents = house.shape[0], action.shape[1]
    results = (
        jax.ShapeDtypeStruct(qpos.shape, jnp.float32),
        jax.ShapeDtypeStruct(qvel.shape, jnp.float32),
        jax.ShapeDtypeStruct(qvel.shape, jnp.float32),
        jax.ShapeDtypeStruct((count, agents), jnp.int32),
        jax.ShapeDtypeStruct((count, 2), jnp.int32),
    )
    if 0 in (count, agents):
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    never = varying_false(operands)
    stepped = jax.ffi.ffi_call(TARGET, results)(*floats)
    return tuple(jnp.where(never, jnp.zeros_like(x), x) for x in stepped)


@functools.cache
def cpu_available() -> bool:
    """Whether the step works here; warns once if there is a CPU backend and it does not."""
    return works("cpu", problem_of("cpu", _start), "physics is stepped by the slower MJX")


def _start() -> None:
    note_start()
    from home_mjx.physics.native.handler import build_handler

    task, handler = build_handler()
    _kept.extend((task, handler))
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(handler.ctypes), platform="cpu", api_version=1)
