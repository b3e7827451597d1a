"""CUDA kernels with arrays of any size, launched without XLA, which compiles a program for each shape.

`ctypes` calls of the CUDA driver. JAX shares the device's primary context; each `CudaStream` has its own order of work.
"""

import ctypes
import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Int

from home_mjx.core.native.platforms import local_devices
from home_mjx.errors import BackendError

LIBRARY = "libcuda.so.1"
NON_BLOCKING = 1  # stream flag: independent of the default stream
RELEASE_THRESHOLD = 4  # attribute of a memory pool: bytes that it keeps
KEPT_BYTES = 8 << 30  # of freed memory, for the next arrays

Word = ctypes.c_uint64


class DeviceArray:
    """Memory of a device, freed with the object.

    Attributes:
        address: Device address.
        shape: Shape of the array.
        dtype: Type of its items.
    """

    def __init__(self, stream: "CudaStream", shape: tuple[int, ...], dtype: Any) -> None:
        self.stream, self.shape, self.dtype = stream, shape, np.dtype(dtype)
        self.nbytes = max(int(np.prod(shape, dtype=np.int64)) * self.dtype.itemsize, 1)
        self.address = stream.allocate(self.nbytes)

    def __del__(self) -> None:
        """Free the memory after all work of its stream that is queued now."""
        if hasattr(self, "address"):
            self.stream.release(self.address)


class CudaStream:
    """Queue of copies and kernel launches on one GPU, for one thread at a time.

    Args:
        ptx: PTX of all kernels.

    Raises:
        BackendError: There is no GPU, or the driver reports an error; so do all methods.
    """

    def __init__(self, ptx: str) -> None:
        self._driver, self._context, self._module = _load(ptx)
        self._stream = ctypes.c_void_p()
        self._functions: dict[str, ctypes.c_void_p] = {}
        self._call("cuStreamCreate", ctypes.byref(self._stream), ctypes.c_uint(NON_BLOCKING))

    def __del__(self) -> None:
        """Destroy the queue after its work; arrays hold it, so that they are freed first."""
        if getattr(self, "_stream", None):
            self._call("cuStreamDestroy_v2", self._stream)

    def empty(self, shape: tuple[int, ...], dtype: Any) -> DeviceArray:
        """Return an uninitialized array."""
        return DeviceArray(self, shape, dtype)

    def zeros(self, shape: tuple[int, ...], dtype: Any) -> DeviceArray:
        """Return an array of zeros."""
        array = self.empty(shape, dtype)
        self._call(
            "cuMemsetD8Async", Word(array.address), ctypes.c_ubyte(0), ctypes.c_size_t(array.nbytes), self._stream
        )
        return array

    def upload(self, values: np.ndarray) -> DeviceArray:
        """Return a copy of an array on the device."""
        values = np.ascontiguousarray(values)
        array = self.empty(values.shape, values.dtype)
        if values.nbytes:
            source = ctypes.c_void_p(values.ctypes.data)
            self._call(
                "cuMemcpyHtoDAsync_v2", Word(array.address), source, ctypes.c_size_t(values.nbytes), self._stream
            )
            self.synchronize()
        return array

    def download(self, array: DeviceArray, count: int | None = None) -> np.ndarray:
        """Return a copy of an array, or of its first `count` rows, after all work that is queued."""
        shape = array.shape if count is None else (count, *array.shape[1:])
        values = np.empty(shape, array.dtype)
        if values.nbytes:
            target = ctypes.c_void_p(values.ctypes.data)
            self._call(
                "cuMemcpyDtoHAsync_v2", target, Word(array.address), ctypes.c_size_t(values.nbytes), self._stream
            )
        self.synchronize()
        return values

    def launch(
        self, name: str, blocks: int, threads: int, words: Int[np.ndarray, " n"], shared: int = 0, rows: int = 1
    ) -> None:
        """Queue a kernel of one argument, a structure of 8-byte words.

        Args:
            name: Name of the kernel.
            blocks: Number of blocks along the first axis; nothing is launched if it is 0.
            threads: Threads per block.
            words: The structure.
            shared: Dynamic shared memory of a block [bytes].
            rows: Number of blocks along the second axis.
        """
        if not blocks or not rows:
            return
        words = np.ascontiguousarray(words, np.int64)
        given = (ctypes.c_void_p * 1)(words.ctypes.data)
        grid = (ctypes.c_uint(x) for x in (blocks, rows, 1, threads, 1, 1, shared))
        self._call("cuLaunchKernel", self._function(name), *grid, self._stream, given, None)

    def synchronize(self) -> None:
        """Wait for all work that is queued."""
        self._call("cuStreamSynchronize", self._stream)

    def allocate(self, nbytes: int) -> int:
        """Return the address of new memory."""
        address = Word()
        self._call("cuMemAllocAsync", ctypes.byref(address), ctypes.c_size_t(nbytes), self._stream)
        return address.value

    def release(self, address: int) -> None:
        """Free memory after all work that is queued."""
        self._call("cuMemFreeAsync", Word(address), self._stream)

    def _function(self, name: str) -> ctypes.c_void_p:
        """Return a kernel of the module, looked up once."""
        if name not in self._functions:
            function = ctypes.c_void_p()
            self._call("cuModuleGetFunction", ctypes.byref(function), self._module, name.encode())
            self._functions[name] = function
        return self._functions[name]

    def _call(self, name: str, *arguments: Any) -> None:
        """Call the driver in the device's context."""
        _check(self._driver, self._driver.cuCtxSetCurrent(self._context), "cuCtxSetCurrent")
        _check(self._driver, getattr(self._driver, name)(*arguments), name)


def pack_words(values: Sequence[Any]) -> Int[np.ndarray, " n"]:
    """Return arrays' addresses, integers and floats (as bits of double precision) as 8-byte words; None is address 0.

    The arrays must live until the kernel is queued.

    Example:
        >>> pack_words([2, None, 1.0]).tolist()
        [2, 0, 4607182418800017408]
    """
    out = np.zeros(len(values), np.int64)
    for i, value in enumerate(values):
        if isinstance(value, float):
            out[i : i + 1].view(np.float64)[:] = value
        elif value is not None:
            out[i] = getattr(value, "address", value)
    return out


@functools.cache
def _library() -> ctypes.CDLL:
    """Load and initialize the driver."""
    try:
        library = ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise BackendError(f"no CUDA driver found: {error}") from error
    _check(library, library.cuInit(0), "cuInit")
    return library


@functools.cache
def _load(ptx: str) -> tuple[ctypes.CDLL, ctypes.c_void_p, ctypes.c_void_p]:
    """Return the driver, the context of JAX's first GPU and the PTX's module, which stay until the process ends."""
    found = local_devices("cuda")
    if not found:
        raise BackendError("JAX has no NVIDIA GPU in this process")
    library, device = _library(), ctypes.c_int()
    context, module, pool = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_void_p()
    ordinal = getattr(found[0], "local_hardware_id", None) or 0
    _check(library, library.cuDeviceGet(ctypes.byref(device), ctypes.c_int(ordinal)), "cuDeviceGet")
    _check(library, library.cuDevicePrimaryCtxRetain(ctypes.byref(context), device), "cuDevicePrimaryCtxRetain")
    _check(library, library.cuCtxSetCurrent(context), "cuCtxSetCurrent")
    _check(library, library.cuModuleLoadData(ctypes.byref(module), ptx.encode()), "cuModuleLoadData")
    _check(library, library.cuDeviceGetDefaultMemPool(ctypes.byref(pool), device), "cuDeviceGetDefaultMemPool")
    kept = Word(KEPT_BYTES)
    _check(library, library.cuMemPoolSetAttribute(pool, RELEASE_THRESHOLD, ctypes.byref(kept)), "cuMemPoolSetAttribute")
    return library, context, module


def _check(library: ctypes.CDLL, status: int, name: str) -> None:
    """Raise `BackendError` with the driver's message unless `status` is 0."""
    if status:
        text = ctypes.c_char_p()
        library.cuGetErrorString(ctypes.c_int(status), ctypes.byref(text))
        message = text.value.decode() if text.value else f"error {status}"
        raise BackendError(f"the CUDA driver failed in {name}: {message}")
