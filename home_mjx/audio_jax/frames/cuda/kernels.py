"""What kernels of moving sound have in common: whether they work here, their transforms, and how XLA calls them."""

import functools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from home_mjx.audio_jax.frames.passes import num_passes, radices
from home_mjx.core.native.platforms import PTX_TARGET, devices_of, problem_of, ptx_for_all, works
from home_mjx.core.native.varying import varying_as

FOLDER = Path(__file__).parent
FIRST_SOURCES = (FOLDER / "fft.cuh", FOLDER / "first.cu")
SUMS_SOURCES = (FOLDER / "sums.cu",)
FILTER_SOURCES = (FOLDER / "fft.cuh", FOLDER / "filtered.cu")
NOISE_SOURCES = (FOLDER / "noise.cu",)
LATE_SOURCES = (FOLDER / "fft.cuh", FOLDER / "late.cu")
PER_THREAD, MOST_THREADS = 8, 768  # values of a transform, as in fft.cuh, and threads
WARP = 32
# Bytes of memory that a block may share, by compute capability; of others it is a safe guess.
SHARED_BYTES = {70: 98_304, 75: 65_536, 80: 166_912, 86: 101_376, 87: 166_912, 89: 101_376, 90: 232_448, 100: 232_448}
LEAST_SHARED_BYTES = 49_152


@functools.cache
def cuda_available() -> bool:
    """Whether the kernels work here; warns once if there is an NVIDIA GPU and they do not."""
    return works("cuda", problem_of("cuda", _start), "moving sound is made by slower operations of XLA")


def _start() -> None:
    for sources in (FIRST_SOURCES, SUMS_SOURCES, FILTER_SOURCES, LATE_SOURCES):
        ptx_of(sources, PER_THREAD * WARP)
    ptx_of(NOISE_SOURCES, 1)


@functools.cache
def ptx_of(sources: tuple[Path, ...], size: int) -> str:
    """PTX that all GPUs of this process can run; `size` is that of its transforms, or how many noises there are."""
    return ptx_for_all(sources, {"SIZE": size})


@functools.cache
def shared_bytes() -> int:
    """What a block may share on all GPUs of this process."""
    found = (int(device.compute_capability.replace(".", "")) for device in devices_of("cuda"))
    return min((SHARED_BYTES.get(x, LEAST_SHARED_BYTES) for x in found), default=LEAST_SHARED_BYTES)


@functools.cache
def transform_size(count: int) -> int | None:
    """Values of the cheapest transform that holds so many and that a block can make; None if there is none.

    Example:
        >>> transform_size(2143), transform_size(7000)
        (2560, None)
    """
    block = PER_THREAD * WARP
    sizes = [size for size in range(block, PER_THREAD * MOST_THREADS + 1, block) if size >= count and num_passes(size)]
    return min(sizes, key=lambda size: size * (num_passes(size) + 1), default=None)


def turns_of(size: int) -> Array:
    """The complex numbers that passes of a transform multiply by, see `transform` in fft.cuh, as pairs."""
    each = [np.outer(1 + np.arange(rows), np.arange(done)) / (done * radix) for done, rows, radix in _joined(size)]
    return as_pairs(np.exp(-2j * np.pi * np.concatenate([x.ravel() for x in each])))


def _joined(size: int) -> list[tuple[int, int, int]]:
    """Of each pass but the first: how many values are transformed together before it, rows of its turns, and its radix.

    In the order of `radix_of` in fft.cuh, with as many rows as `turned` there says.
    """
    first, *others = radices(size)
    order = (first, *others[::-1])
    return [(math.prod(order[:i]), 4 if radix == 8 else radix - 1, radix) for i, radix in enumerate(order) if i]


def as_pairs(values: np.ndarray) -> Array:
    """Complex numbers as pairs of floats."""
    return jnp.asarray(np.stack([np.real(values), np.imag(values)], axis=-1), jnp.float32)


def transform_bytes(size: int) -> int:
    """Memory for the values of a transform and its turns."""
    return 8 * (size + size // 16 + sum(done * rows for done, rows, _ in _joined(size)))


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
