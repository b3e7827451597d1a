"""XLA FFI handlers of kernels in Numba: chunks of work on XLA's threads.

Numba's cache on disk hashes the values that a function closes over. Compiled functions and intrinsics have a different
hash in every process. A handler therefore closes over the names of symbols, and calls the kernel at their addresses.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

import functools
from typing import Any, no_type_check

import llvmlite.binding
from numba import cfunc, types

from home_mjx.core.native import ffi, memory
from home_mjx.core.native.memory import call, symbol_address
from home_mjx.core.native.numba_cache import verify_cache

WORD_FUNCTION = types.intp(types.intp)  # signature of all C functions of a kernel
TASK = "home_mjx_task"  # symbol


@verify_cache
def build_handler(name: str, count: Any, work: Any) -> tuple[Any, Any]:
    """Build the XLA FFI handler of a kernel and the task of XLA's threads; add their symbols to LLVM.

    Both come from Numba's cache if possible. Keep them and the arguments alive while XLA may call the handler.

    Args:
        name: Unique prefix of the kernel's symbols.
        count: C function of a call frame that returns the number of chunks.
        work: C function of a job, see `ffi.run_chunks`.
    """
    digest = ffi.hash_sources(ffi.__file__, memory.__file__)
    count_symbol, work_symbol, task = f"{name}_count", f"{name}_work", _build_task(digest)
    for symbol, function in ((count_symbol, count), (work_symbol, work), (TASK, task)):
        llvmlite.binding.add_symbol(symbol, function.address)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def handler(frame):
        """Run the kernel's chunks if XLA requests execution; XLA's handler function."""
        _ = digest
        if ffi.is_execute_call(frame):
            chunks = call(symbol_address(count_symbol), frame)
            ffi.run_job(frame, chunks, symbol_address(work_symbol), symbol_address(TASK))
        return 0

    return handler, task


@functools.cache
def _build_task(digest: int) -> Any:
    """Compile the C function of a job that XLA's threads call, for all kernels; `digest` only keys Numba's cache."""

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def task(job):
        """Run a job on a thread of XLA."""
        _ = digest
        ffi.run_task(job)
        return 0

    return task
