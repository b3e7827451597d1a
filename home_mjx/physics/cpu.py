"""CPU backend of the fused step: Numba code of `native`, called by XLA and compiled on first use."""

import functools
from collections.abc import Sequence

import jax
from jaxtyping import Array

from home_mjx.core.native.fork_guard import record_process
from home_mjx.core.native.platforms import find_problem, is_usable

TARGET = "home_mjx_step"

_kept: list[object] = []  # keeps compiled functions alive: XLA may call them until the process ends


def step_cpu(operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> Sequence[Array]:
    """Step environments (e ...) by one control step; operands and results are ordered as in `native.data.operands`."""
    return jax.ffi.ffi_call(TARGET, results)(*operands)


@functools.cache
def cpu_available() -> bool:
    """Return whether the CPU kernel works in this process; warn once if JAX has a CPU backend and it fails."""
    return is_usable("cpu", find_problem("cpu", _start), "falling back to slower MJX physics")


def _start() -> None:
    record_process()
    from home_mjx.physics.numba.handler import build_handler

    compiled = build_handler()
    _kept.extend(compiled)
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(compiled[-1].ctypes), platform="cpu", api_version=1)
