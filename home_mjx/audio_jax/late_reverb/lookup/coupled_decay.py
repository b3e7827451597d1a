"""Energy decay in coupled rooms: by a CUDA kernel on NVIDIA GPUs, by XLA operations elsewhere."""

import functools
from pathlib import Path

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.native.kernel import Kernel, compile_sources, launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes, with_fallback_gradient
from home_mjx.core.native.vmap_call import call_kernel, traced_constant

SERIES_TERMS = 6  # terms of the exponential series
HALVINGS = 3  # halvings of the step before the series is evaluated
SOURCE = Path(__file__).with_name("coupled_decay.cu")
WARP = 32  # threads of a block
SIZES = (8, 12, 16, 24)  # sizes of matrices below that of the largest house, as in coupled_decay.cu
BINS_PER_COLUMN = 8  # consecutive bins computed from one column, as in coupled_decay.cu
MAX_REGISTER_ELEMENTS = 100  # maximum matrix elements in a thread's registers
KERNEL = Kernel("home_mjx_rooms", "room energy decay uses slower XLA operations", cuda=lambda: ptx_of(8))


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
    fast = {"cuda": functools.partial(_decay_by_cuda, bins=bins)} if _available(rooms) else {}
    count = jnp.full((), rooms if num_rooms is None else num_rooms, jnp.int32)

    def by_xla(rates: Array, start: Array, listener: Array, count: Array) -> Array:
        """Ignore the number of rooms: padding exchanges nothing."""
        return decay_in_rooms_by_xla(rates, start, listener, bins)

    return with_fallback_gradient(by_xla, fast)(rates, start, listener, count)


def decay_in_rooms_by_xla(
    rates: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    """Compute `decay_in_rooms`, the energy density at a listener after 0 .. `bins` - 1 bins, with XLA operations."""
    return _propagate(_matrix_exponential(rates), start, listener, bins)


def _matrix_exponential(matrix: Float[Array, "*x r r"]) -> Float[Array, "*x r r"]:
    """Compute exp(-matrix) of square matrices: a Taylor series of -matrix / 8, squared `HALVINGS` times."""
    small = -matrix / 2**HALVINGS
    one = jnp.eye(matrix.shape[-1], dtype=jnp.float32)
    power = total = jnp.broadcast_to(one, small.shape)
    for n in range(1, SERIES_TERMS):
        power = _multiply(power, small) / n
        total = total + power
    for _ in range(HALVINGS):
        total = _multiply(total, total)
    return total


def _propagate(
    step: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    """Compute the energy density at the listener after 0, 1, ... `bins` - 1 multiplications with the matrix `step`.

    The density after a n + b steps is the product of a row and a column. The row is the listener's weights propagated
    by b steps, the column is the start propagated by a n steps. So powers of the step matrix multiply few vectors.
    """
    powers = [step]
    while 2 ** len(powers) < bins:
        powers.append(_multiply(powers[-1], powers[-1]))
    half = len(powers) // 2
    row = jnp.broadcast_to(listener, (*step.shape[:2], 1, listener.size))
    column = jnp.broadcast_to(start[:, None], (*step.shape[:3], 1))
    for power in powers[:half]:
        row = jnp.concatenate([row, _multiply(row, power)], axis=-2)
    for power in powers[half:]:
        column = jnp.concatenate([column, _multiply(power, column)], axis=-1)
    heard = _multiply(jnp.swapaxes(column, -1, -2), jnp.swapaxes(row, -1, -2))  # (s, bands, a, b)
    return jnp.swapaxes(heard.reshape(*step.shape[:2], -1)[..., :bins], 1, 2)


def _multiply(left: Float[Array, "*x n m"], right: Float[Array, "*x m k"]) -> Float[Array, "*x n k"]:
    """Return matrix products over the last two axes, as sums, which compilers fuse, without library calls."""
    return jnp.sum(left[..., :, :, None] * right[..., None, :, :], axis=-2)


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
