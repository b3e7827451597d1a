"""The fused step on CPUs: `native`, compiled by Numba and called by XLA. Compiled on first use."""

import functools
from collections.abc import Sequence

import jax
from jaxtyping import Array

from home_mjx.core.native.fork_guard import note_start
from home_mjx.core.native.platforms import problem_of, works

TARGET = "home_mjx_step"

_kept: list[object] = []  # compiled functions that XLA may call until the process ends


def step_cpu(operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> Sequence[Array]:
    """Steps environments (e ...); operands and results in the order of `native.data.operands`."""
    return jax.ffi.ffi_call(TARGET, results)(*operands)


@functools.cache
def cpu_available() -> bool:
    """Whether the step works here; warns once if there is a CPU backend and it does not."""
    return works("cpu", problem_of("cpu", _start), "physics is stepped by the slower MJX")


def _start() -> None:
    note_start()
    from home_mjx.physics.numba.handler import build_handler

    compiled = build_handler()
    _kept.extend(compiled)
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(compiled[-1].ctypes), platform="cpu", api_version=1)
