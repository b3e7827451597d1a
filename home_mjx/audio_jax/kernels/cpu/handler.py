"""XLA FFI handler of moving sound: renders chunks of environments on XLA's threads."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import llvmlite.binding
from numba import cfunc, njit, types

from home_mjx.audio_jax.base import delays
from home_mjx.audio_jax.kernels import reads
from home_mjx.audio_jax.kernels.cpu import early, fft, late, operands, paths
from home_mjx.audio_jax.kernels.cpu.early import render_early_chunk
from home_mjx.audio_jax.kernels.cpu.late import render_late_chunk
from home_mjx.audio_jax.kernels.cpu.operands import EARLY, ENVS_PER_CHUNK, KIND, constant
from home_mjx.core.native import ffi, memory
from home_mjx.core.native import simd as lanes
from home_mjx.core.native.memory import call, symbol_address
from home_mjx.core.native.numba_cache import verify_cache

WORK, TASK = "home_mjx_frames_work", "home_mjx_frames_task"

work_address, task_address = symbol_address(WORK), symbol_address(TASK)
compiled = njit(error_model="numpy")


@verify_cache
def build_handler() -> tuple[Any, Any, Any]:
    """Compile the work, the task and the handler, or load them from Numba's cache; keep all while XLA may call them.

    Task and handler call the work at its address. Otherwise each would compile its own copy, which doubles the time.
    """
    # Numba's cache tracks this file only. The digest in each function invalidates it when another module changes.
    parts: tuple[Any, ...] = (ffi, lanes, memory, delays, early, fft, late, operands, paths, reads)
    digest = ffi.hash_sources(*(part.__file__ for part in parts))

    @cfunc(types.intp(types.intp), cache=True)
    @no_type_check
    def work(job):
        _ = digest
        _work(job)
        return 0

    llvmlite.binding.add_symbol(WORK, work.address)

    @cfunc(types.intp(types.intp), cache=True)
    @no_type_check
    def task(job):
        _ = digest
        call(work_address(), job)
        ffi.release_job(job)
        return 0

    llvmlite.binding.add_symbol(TASK, task.address)

    @cfunc(types.intp(types.intp), cache=True)
    @no_type_check
    def handler(frame):
        _ = digest
        if ffi.is_execute_call(frame):
            job = ffi.open_job(frame, -(-ffi.dim(frame, ffi.RESULTS, 0, 0) // ENVS_PER_CHUNK), task_address())
            call(work_address(), job)
            ffi.close_job(job)
        return 0

    return work, task, handler


@compiled
@no_type_check
def _work(job):
    """Render chunks of environments until none is left."""
    while True:
        chunk = ffi.next_chunk(job)
        if chunk < 0:
            return
        frame = ffi.job_frame(job)
        first, end = chunk * ENVS_PER_CHUNK, min((chunk + 1) * ENVS_PER_CHUNK, ffi.dim(frame, ffi.RESULTS, 0, 0))
        if constant(frame, KIND) == EARLY:
            render_early_chunk(frame, first, end)
        else:
            render_late_chunk(frame, first, end)
        ffi.chunk_done(job)
