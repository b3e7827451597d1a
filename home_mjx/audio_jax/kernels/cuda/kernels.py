"""What kernels of moving sound have in common: whether they work here, and their transforms."""

import functools
import math
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from home_mjx.audio_jax.kernels.passes import num_passes, radices
from home_mjx.core.native.platforms import problem_of, ptx_for_all, works

FOLDER = Path(__file__).parent
FIRST_SOURCES = (FOLDER / "fft.cuh", FOLDER / "first.cu")
SUMS_SOURCES = (FOLDER / "sums.cu",)
FILTER_SOURCES = (FOLDER / "fft.cuh", FOLDER / "filtered.cu")
NOISE_SOURCES = (FOLDER / "noise.cu",)
LATE_SOURCES = (FOLDER / "fft.cuh", FOLDER / "late.cu")
PER_THREAD, MOST_THREADS = 8, 768  # values of a transform, as in fft.cuh, and threads
WARP = 32


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
