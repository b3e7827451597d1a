"""Common parts of the kernels of moving sound: compilation and transforms."""

import functools
import math
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from home_mjx.audio_jax.kernels.fft_plan import num_passes, radices
from home_mjx.core.native.kernel import compile_sources

FOLDER = Path(__file__).parent
DIRECT_SOURCES = (FOLDER / "fft.cuh", FOLDER / "direct_filter.cu")
MIX_SOURCES = (FOLDER / "path_mixing.cu",)
FILTER_SOURCES = (FOLDER / "fft.cuh", FOLDER / "bus_filter.cu")
NOISE_SOURCES = (FOLDER / "noise_responses.cu",)
LATE_SOURCES = (FOLDER / "fft.cuh", FOLDER / "late_frames.cu")
PER_THREAD, MAX_THREADS = 8, 768  # values of a transform per thread, as in fft.cuh, and maximum threads per block
WARP = 32


def compile_kernels() -> None:
    """Compile all kernels for the smallest size, as a test; raise `BackendError` if that fails."""
    for sources in (DIRECT_SOURCES, MIX_SOURCES, FILTER_SOURCES, LATE_SOURCES):
        ptx_of(sources, PER_THREAD * WARP)
    ptx_of(NOISE_SOURCES, 1)


def ptx_of(sources: tuple[Path, ...], size: int) -> str:
    """Return PTX of `sources` for all GPUs of this process, with the macro SIZE defined as `size`, also if it is 0.

    `size` is the transform size or the number of noises; 0 for sources without the macro.
    """
    return compile_sources(*sources, SIZE=size)


@functools.cache
def transform_size(count: int) -> int | None:
    """Return the size of the cheapest transform of at least `count` values in one block; None if there is none.

    Sizes are multiples of 256 up to 6144 with prime factors 2, 3 and 5; the cost is size (passes + 1).

    Example:
        >>> transform_size(2143), transform_size(7000)
        (2560, None)
    """
    block = PER_THREAD * WARP
    sizes = [size for size in range(block, PER_THREAD * MAX_THREADS + 1, block) if size >= count and num_passes(size)]
    return min(sizes, key=lambda size: size * (num_passes(size) + 1), default=None)


def twiddle_factors(size: int) -> Array:
    """Return the twiddle factors of all passes but the first, concatenated, as pairs; see `transform` in fft.cuh.

    Those of a pass are exp(-2 pi i r j / (n radix)), for each row r = 1, 2, ... those of j = 0 .. n - 1. n and the
    number of rows are from `_pass_sizes`.
    """
    each = [np.outer(1 + np.arange(rows), np.arange(done)) / (done * radix) for done, rows, radix in _pass_sizes(size)]
    return as_pairs(np.exp(-2j * np.pi * np.concatenate([x.ravel() for x in each])))


def _pass_sizes(size: int) -> list[tuple[int, int, int]]:
    """Return for each pass but the first: size of the transforms before it, rows of twiddle factors, and radix.

    The order is that of `radix_of` in fft.cuh, the number of rows that of `turned`.
    """
    first, *others = radices(size)
    order = (first, *others[::-1])
    return [(math.prod(order[:i]), 4 if radix == 8 else radix - 1, radix) for i, radix in enumerate(order) if i]


def as_pairs(values: np.ndarray) -> Array:
    """Convert complex numbers to float32 with a new last axis (real, imaginary)."""
    return jnp.asarray(np.stack([np.real(values), np.imag(values)], axis=-1), jnp.float32)


def transform_bytes(size: int) -> int:
    """Return the shared memory for one transform's complex values, padded, and its twiddle factors [bytes]."""
    return 8 * (size + size // 16 + sum(done * rows for done, rows, _ in _pass_sizes(size)))
