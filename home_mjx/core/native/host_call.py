"""Python functions that XLA calls on the CPU, with NumPy views of its buffers.

They serve work that needs the interpreter anyway. `jax.pure_callback` copies its arguments with JAX on the same
thread pool that waits for the callback, so large arguments deadlock (decision 6). Here no JAX code runs until the
function returns.
"""

import ctypes
import logging
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from home_mjx.core.native import ffi
from home_mjx.core.native.kernel import register_target

HostFunction = Callable[[Sequence[np.ndarray], Sequence[np.ndarray]], None]

DTYPES = {
    1: (ctypes.c_bool, np.bool_),
    4: (ctypes.c_int32, np.int32),
    11: (ctypes.c_float, np.float32),
    12: (ctypes.c_double, np.float64),
}  # by XLA's type number
BUFFER_DTYPE, COUNT_BEFORE = 2, 2  # word offsets: dtype in a buffer; buffer count before a frame's array of buffers
API_CREATE_ERROR, INTERNAL = 6, 13

log = logging.getLogger(__name__)


def register_host_call(target: str, function: HostFunction) -> None:
    """Register a Python function as a CPU target of `jax.ffi.ffi_call`.

    Args:
        target: Unique name of the target.
        function: Function of the operands, which it must not modify, and the results, which it fills. All are arrays
            of bool, int32, float32 or float64, valid until it returns. It may run on several threads at once and must
            not call JAX. An exception ends the program as JAX's own run-time error.

    Example:
        >>> register_host_call("my_double", lambda given, results: np.copyto(results[0], 2 * given[0]))
        >>> import jax
        >>> jax.ffi.ffi_call("my_double", jax.ShapeDtypeStruct((2,), "float32"))(np.ones(2, np.float32))
        Array([2., 2.], dtype=float32)
    """

    @ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)
    def handler(frame: int) -> int | None:
        """Call `function` with NumPy views if XLA requests execution; return an XLA error's address, or None."""
        if not _wants_work(frame):
            return None
        try:
            function(_buffers(frame, ffi.OPERANDS), _buffers(frame, ffi.RESULTS))
        except Exception as error:  # no exception may propagate into XLA
            log.debug("a host function failed", exc_info=True)
            return _error(frame, f"{type(error).__name__}: {error}")
        return None

    register_target(target, handler)


def _words(address: int) -> Any:
    """Return a pointer to 64-bit integers at an address."""
    return ctypes.cast(address, ctypes.POINTER(ctypes.c_int64))


def _halves(address: int) -> Any:
    """Return a pointer to 32-bit integers at an address."""
    return ctypes.cast(address, ctypes.POINTER(ctypes.c_int32))


def _wants_work(frame: int) -> bool:
    """Return whether XLA requests execution; into a metadata query (False), write the interface version."""
    extension = _words(frame)[ffi.FRAME_EXTENSION]
    if extension and _halves(extension + ffi.WORD * ffi.EXTENSION_TYPE)[0] == ffi.METADATA:
        _words(_words(extension)[ffi.EXTENSION_METADATA])[ffi.METADATA_VERSION] = ffi.API_VERSION
        return False
    return _halves(frame + ffi.WORD * ffi.FRAME_STAGE)[0] == ffi.EXECUTE


def _buffers(frame: int, kind: int) -> list[np.ndarray]:
    """Return NumPy views, without copies, of all operands or results; `kind` is `ffi.OPERANDS` or `ffi.RESULTS`."""
    words = _words(frame)
    return [_view(_words(words[kind])[i]) for i in range(words[kind - COUNT_BEFORE])]


def _view(buffer: int) -> np.ndarray:
    """Return the `XLA_FFI_Buffer` at an address as a NumPy view; zeros of its shape if it has no elements."""
    words = _words(buffer)
    item, dtype = DTYPES[_halves(buffer + ffi.WORD * BUFFER_DTYPE)[0]]
    shape = tuple(_words(words[ffi.BUFFER_DIMS])[: words[ffi.BUFFER_RANK]])
    if 0 in shape:
        return np.zeros(shape, dtype)  # XLA passes a null address
    return np.ctypeslib.as_array(ctypes.cast(words[ffi.BUFFER_DATA], ctypes.POINTER(item)), shape)


def _error(frame: int, message: str) -> int:
    """Create an XLA error with a message, which XLA copies, and return the error's address."""
    text = ctypes.create_string_buffer(message.encode())
    ask = (ctypes.c_int64 * 4)(4 * ffi.WORD, 0, ctypes.addressof(text), INTERNAL)
    create = _words(_words(frame)[ffi.FRAME_API])[API_CREATE_ERROR]
    return ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(create)(ctypes.addressof(ask))
