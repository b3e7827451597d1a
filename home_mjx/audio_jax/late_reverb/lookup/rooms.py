"""How energy falls in rooms that exchange it: by an own kernel on GPUs, by operations of XLA elsewhere."""

import functools
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.core.native.platforms import by_platform, call_kernel, problem_of, ptx_for_all, shared_bytes, works
from home_mjx.core.native.vmap_call import batched, numbers

TERMS = 6  # of the exponential series
HALVINGS = 3  # of the step before it
SOURCE = Path(__file__).with_name("rooms.cu")
THREADS, WARP = 64, 32  # of a block, as in rooms.cu, and of a warp
RUN = 8  # bins that are found of one column, as in rooms.cu
MOST_NUMBERS = 100  # of a matrix in a thread's registers


def fallen(
    rates: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    """Energy density at a listener after 0, 1, 2 ... bins, of dw / dn = -M w, n counting bins.

    Args:
        rates: M of each state of the doors and each octave.
        start: w at first.
        listener: Share of the listener in each room.
        bins: How many.
    """
    rooms = start.shape[0]
    fast = {"cuda": functools.partial(_by_cuda, bins=bins)} if _available(rooms) else {}
    return by_platform(functools.partial(fallen_by_xla, bins=bins), fast)(rates, start, listener)


def fallen_by_xla(
    rates: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    """The same in operations of XLA."""
    return _over_time(_exponential(rates), start, listener, bins)


def _exponential(matrix: Float[Array, "*x r r"]) -> Float[Array, "*x r r"]:
    """exp(-matrix), by its series after some halvings."""
    small = -matrix / 2**HALVINGS
    one = jnp.eye(matrix.shape[-1], dtype=jnp.float32)
    power = total = jnp.broadcast_to(one, small.shape)
    for n in range(1, TERMS):
        power = _product(power, small) / n
        total = total + power
    for _ in range(HALVINGS):
        total = _product(total, total)
    return total


def _over_time(
    step: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    """Energy density at the listener after 0, 1, 2 ... steps.

    That after a n + b steps is what b steps before the listener, a row, find of what n steps a times made, a column;
    so no power of a step is multiplied by more than a few vectors.
    """
    powers = [step]
    while 2 ** len(powers) < bins:
        powers.append(_product(powers[-1], powers[-1]))
    half = len(powers) // 2
    row = jnp.broadcast_to(listener, (*step.shape[:2], 1, listener.size))
    column = jnp.broadcast_to(start[:, None], (*step.shape[:3], 1))
    for power in powers[:half]:
        row = jnp.concatenate([row, _product(row, power)], axis=-2)
    for power in powers[half:]:
        column = jnp.concatenate([column, _product(power, column)], axis=-1)
    heard = _product(jnp.swapaxes(column, -1, -2), jnp.swapaxes(row, -1, -2))  # (s, bands, a, b)
    return jnp.swapaxes(heard.reshape(*step.shape[:2], -1)[..., :bins], 1, 2)


def _product(left: Float[Array, "*x n m"], right: Float[Array, "*x m k"]) -> Float[Array, "*x n k"]:
    """Of many small matrices: as sums, which compilers fuse, instead of a call for each product of matrices."""
    return jnp.sum(left[..., :, :, None] * right[..., None, :, :], axis=-2)


@functools.cache
def _cuda_available() -> bool:
    """Whether the kernel works here; warns once if there is an NVIDIA GPU and it does not."""
    return works("cuda", problem_of("cuda", _start), "energy of rooms falls by slower operations of XLA")


def _start() -> None:
    ptx_of(8)


@functools.cache
def ptx_of(rooms: int) -> str:
    """PTX for so many rooms that all GPUs of this process can run."""
    return ptx_for_all(SOURCE, {"SIZE": rooms, "LANES": lanes_of(rooms)})


def lanes_of(rooms: int) -> int:
    """Threads of each matrix, a power of two, such that each holds some columns in registers; above `WARP`: too many.

    Example:
        >>> lanes_of(8), lanes_of(20), lanes_of(51)
        (1, 4, 64)
    """
    lanes = 1
    while rooms * -(-rooms // lanes) > MOST_NUMBERS and lanes <= WARP:
        lanes *= 2
    return lanes


def _available(rooms: int) -> bool:
    return rooms > 0 and lanes_of(rooms) <= WARP and _cuda_available() and _bytes(rooms) <= shared_bytes()


def _bytes(rooms: int) -> int:
    """Memory of a block: of each matrix its numbers and some rows, an odd number of matrices apart."""
    return 4 * (THREADS // lanes_of(rooms) + 1) * rooms * (rooms + RUN)


def _by_cuda(
    rates: Float[Array, "s bands r r"], start: Float[Array, " r"], listener: Float[Array, " r"], bins: int
) -> Float[Array, "s k bands"]:
    return _op(bins)(rates[None], start[None], listener[None])[0][0]


@functools.cache
def _op(bins: int) -> Callable[..., tuple[Array, ...]]:
    return batched(functools.partial(run_rooms, bins), 0, 1)


def run_rooms(bins: int, *given: Array) -> tuple[Array, ...]:
    """The kernel for environments: matrices (e s bands r r), starts (e r), listeners (e r); gives (e s bins bands)."""
    envs, states, octaves, rooms, _ = given[0].shape
    blocks = -(-envs * states * octaves // (THREADS // lanes_of(rooms)))
    result = jax.ShapeDtypeStruct((envs, states, bins, octaves), jnp.float32)
    operands = *given, numbers((envs, states, octaves, bins))
    return call_kernel("fall_in_rooms", ptx_of(rooms), (blocks, 1), THREADS, _bytes(rooms), operands, result)
