"""Energy decay in coupled rooms: by native kernels on CPUs and NVIDIA GPUs, by XLA operations elsewhere."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.late_reverb.lookup.room_matrices import MAX_STACK_ROOMS, decay_in_rooms_by_xla
from home_mjx.core.native.kernel import Kernel, call_native, compile_sources, launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes, with_fallback_gradient
from home_mjx.core.native.vmap_call import call_kernel, traced_constant

SOURCE = Path(__file__).with_name("coupled_decay.cu")
WARP = 32  # threads of a block
SIZES = (8, 12, 16, 24)  # sizes of matrices below that of the largest house, as in coupled_decay.cu
BINS_PER_COLUMN = 8  # consecutive bins computed from one column, as in coupled_decay.cu
MAX_REGISTER_ELEMENTS = 100  # maximum matrix elements in a thread's registers


def decay_in_rooms(
    rates: Float[Array, "s bands r r"],
    start: Float[Array, " r"],
    listener: Float[Array, " r"],
    bins: int,
    num_rooms: Int[Array, ""] | int | None = None,
) -> Float[Array, "s k bands"]:
    """Compute the energy density at a listener after n = 0, 1 ... `bins` - 1 bins from dw / dn = -M w.

    It is the sum of the rooms' densities w, weighted by `listener`; w is `start` at n = 0.

    Args:
        rates: M [1/bin] of each door state s and octave.
        start: Initial energy density w of each room.
        listener: Weight of the listener in each room.
        bins: Number of bins.
        num_rooms: Number of rooms before padding, with which the others exchange nothing; None: r.
    """
    rooms = start.shape[0]
    fast: dict[str, Callable[..., Array]] = {}
    if 0 < rooms <= MAX_STACK_ROOMS and KERNEL.is_usable("cpu"):
        fast["cpu"] = functools.partial(_decay_by_cpu, bins=bins)
    if _available(rooms):
        fast["cuda"] = functools.partial(_decay_by_cuda, bins=bins)
    count = jnp.full((), rooms if num_rooms is None else num_rooms, jnp.int32)

    def by_xla(rates: Array, start: Array, listener: Array, count: Array) -> Array:
        """Ignore the number of rooms: padding exchanges nothing."""
        return decay_in_rooms_by_xla(rates, start, listener, bins)

    return with_fallback_gradient(by_xla, fast)(rates, start, listener, count)


def ptx_of(rooms: int) -> str:
    """Return PTX for up to `rooms` rooms; all GPUs of this process can run it."""
    return compile_sources(SOURCE, ROOMS=rooms, MAX_ELEMENTS=MAX_REGISTER_ELEMENTS)


def threads_per_matrix(rooms: int) -> int:
    """Return the minimum power of two of threads that can hold a matrix of `rooms` rows in registers, in whole columns.

    Each thread holds at most `MAX_REGISTER_ELEMENTS`. If `WARP` threads cannot, the result is twice `WARP`.

    Example:
        >>> threads_per_matrix(8), threads_per_matrix(20), threads_per_matrix(51)
        (1, 4, 64)
    """
    lanes = 1
    while rooms * -(-rooms // lanes) > MAX_REGISTER_ELEMENTS and lanes <= WARP:
        lanes *= 2
    return lanes


def _available(rooms: int) -> bool:
    """Return whether the CUDA kernel is usable for `rooms` rooms."""
    supported = rooms > 0 and threads_per_matrix(rooms) <= WARP
    return supported and KERNEL.is_usable("cuda") and _bytes(rooms) <= max_shared_bytes()


def _sizes(rooms: int) -> list[int]:
    """Return the sizes of matrices of a kernel for up to `rooms` rooms: those of `SIZES` below it, then `rooms`."""
    return [size for size in SIZES if size < rooms] + [rooms]


def _bytes(rooms: int) -> int:
    """Return the shared memory of a block [bytes]: elements and `BINS_PER_COLUMN` rows per matrix, at an odd pitch."""
    return max(4 * (WARP // threads_per_matrix(n) + 1) * n * (n + BINS_PER_COLUMN) for n in _sizes(rooms))


def _decay_by_cuda(*given: Array, bins: int) -> Float[Array, "s k bands"]:
    """Compute energy densities at a listener in k = `bins` bins by the CUDA kernel; `_available` must be True.

    `given` are the arrays of `decay_in_rooms`; rooms after the first `count` must exchange nothing.
    """
    return call_kernel(launch_decay, (bins,), (), given)


def _decay_by_cpu(*given: Array, bins: int) -> Float[Array, "s k bands"]:
    """Compute energy densities at a listener in k = `bins` bins by the CPU kernel; arguments as of `_decay_by_cuda`."""
    return call_kernel(_call_decay, (bins,), (), given)


def _call_decay(bins: int, *given: Array) -> tuple[Array, ...]:
    """Call the CPU kernel for the operands of `launch_decay`; return one array (e s bins bands)."""
    envs, states, octaves, *_ = given[0].shape
    result = jax.ShapeDtypeStruct((envs, states, bins, octaves), jnp.float32)
    return tuple(call_native(KERNEL.name, given, [result])) if envs else (jnp.zeros(result.shape, result.dtype),)


def _compile_chunks() -> tuple[Any, Any]:
    """Compile the CPU kernel; Numba is imported only here, because it loads slowly."""
    from home_mjx.audio_jax.late_reverb.lookup.numba_decay import compile_chunks

    return compile_chunks()


KERNEL = Kernel(
    "home_mjx_rooms", "room energy decay uses slower XLA operations", cpu=_compile_chunks, cuda=lambda: ptx_of(8)
)


def launch_decay(bins: int, *given: Array) -> tuple[Array, ...]:
    """Launch the kernel of `decay_in_rooms` for rates (e s bands r r), starts (e r), listeners (e r), room counts (e).

    Returns:
        One array (e s bins bands).
    """
    envs, states, octaves, rooms, _ = given[0].shape
    matrices = states * octaves
    groups = max(-(-matrices * threads_per_matrix(size) // WARP) for size in _sizes(rooms))
    result = jax.ShapeDtypeStruct((envs, states, bins, octaves), jnp.float32)
    operands = *given, traced_constant((envs, states, octaves, bins))
    return launch_ptx("decay_in_rooms", ptx_of(rooms), (envs * groups,), WARP, _bytes(rooms), operands, (result,))
