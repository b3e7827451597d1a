"""Moving sound in chunks of environments, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

from numba import cfunc

from home_mjx.audio_jax.base import delays
from home_mjx.audio_jax.kernels import delay_reads
from home_mjx.audio_jax.kernels.cpu import fft, operands, path_mixing, render_early, render_late
from home_mjx.audio_jax.kernels.cpu.operands import EARLY, ENVS_PER_CHUNK, KIND, constant
from home_mjx.audio_jax.kernels.cpu.render_early import render_early_chunk
from home_mjx.audio_jax.kernels.cpu.render_late import render_late_chunk
from home_mjx.core.native import ffi, memory
from home_mjx.core.native import simd as lanes
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.numba_cache import verify_cache

compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Return the C functions `count` (chunks of a call) and `work` (of a job), compiled or from Numba's disk cache."""
    # Numba's cache tracks this file only. The digest in each function invalidates it when another module changes.
    parts: Any = ffi, lanes, memory, delays, render_early, fft, render_late, operands, path_mixing, delay_reads
    digest = ffi.hash_sources(*(part.__file__ for part in parts))

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of chunks of a call."""
        _ = digest
        return -(-ffi.dim(frame, ffi.RESULTS, 0, 0) // ENVS_PER_CHUNK)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Render the chunks of a job."""
        _ = digest
        ffi.run_chunks(job, _render_chunk)
        return 0

    return count, work


@compiled
@no_type_check
def _render_chunk(frame, chunk):
    """Render environments of a chunk, early or late sound by the call's `KIND`; `frame`: XLA's call frame (address)."""
    first, end = chunk * ENVS_PER_CHUNK, min((chunk + 1) * ENVS_PER_CHUNK, ffi.dim(frame, ffi.RESULTS, 0, 0))
    if constant(frame, KIND) == EARLY:
        render_early_chunk(frame, first, end)
    else:
        render_late_chunk(frame, first, end)
