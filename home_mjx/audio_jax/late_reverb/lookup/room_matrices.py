"""Matrix exponentials of coupled rooms with XLA operations, and constants that native kernels share with them."""

import jax.numpy as jnp
from jaxtyping import Array, Float

SERIES_TERMS = 6  # terms of the exponential series
HALVINGS = 3  # halvings of the step before the series is evaluated
MAX_STACK_ROOMS = 40  # maximum number of rooms of the CPU kernel, whose matrices are on the stack


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
