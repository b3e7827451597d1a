"""Compilation of CPU kernels in a second process, while the first one reads houses."""

from collections.abc import Iterator
from contextlib import contextmanager

import jax

from home_mjx.audio_jax.kernels.cpu import chunks as sound
from home_mjx.core.native.numba_cache import is_recorded
from home_mjx.core.workers import usable_cores, worker_pool
from home_mjx.physics.kinematic import chunks as kinematic
from home_mjx.physics.numba import chunks as dynamic

# Half a minute, ten and eight seconds; those of rays take five, and the first process compiles them meanwhile.
SLOWEST = (dynamic.compile_chunks, sound.compile_chunks, kinematic.compile_chunks)


@contextmanager
def compile_beside() -> Iterator[None]:
    """Compile the kernels of `SLOWEST` in a process of its own during a `with` block, unless Numba's cache has them.

    A kernel that this process needs earlier is waited for, see `numba_cache`. Nothing is done on a GPU or one core.
    """
    if jax.default_backend() != "cpu" or usable_cores() == 1 or all(map(is_recorded, SLOWEST)):
        yield
        return
    with worker_pool(1, imports_main=False) as pool:
        pool.submit(compile_slowest)
        yield


def compile_slowest() -> None:
    """Compile the kernels of `SLOWEST` into Numba's cache."""
    for compile_chunks in SLOWEST:
        compile_chunks()
