"""Geodesic distance fields on the device, for goals that are defined at run time."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank


def distance_field(
    free: Bool[Array, "ny nx"],
    source: Bool[Array, "ny nx"],
    cell: float,
    step_factor: Float[Array, "ny nx"] | float = 1.0,
) -> Float[Array, "ny nx"]:
    """Compute the length of the shortest 8-connected path over free cells to the nearest source, without corner cuts.

    Rows are swept down and up until convergence (Zhao, "A fast sweeping method for Eikonal equations", 2005), here for
    the metric of the grid graph. Each row is relaxed by a parallel scan (Blelloch 1990). The number of rounds is the
    number of up-down turns of the most winding path, not its length.

    Args:
        free: Cells that a path may cross.
        source: Cells with distance 0; cells that are not free are ignored.
        cell: Cell size [m].
        step_factor: Factor on the length of steps between cells; positive. A step has that of its farther cell from
            the source.

    Returns:
        Distances [m]; inf if there is no path. With a factor of 1 equal to `geometry.geodesic.distance_fields` up to
        rounding.

    Example:
        >>> fields = jax.vmap(distance_field, (None, 0, None))(free, sources, 0.1)  # doctest: +SKIP
    """
    far = jnp.float32(jnp.inf)
    start = jnp.where(free & source, jnp.float32(0), far)
    step = jnp.broadcast_to(jnp.float32(cell) * step_factor, free.shape)

    def changed(carry: tuple[Array, Array]) -> Array:
        return jnp.any(carry[0] < carry[1])

    def rounds(carry: tuple[Array, Array]) -> tuple[Array, Array]:
        distance, _ = carry
        down = _sweep(free, distance, step)
        return _sweep(free[::-1], down[::-1], step[::-1])[::-1], distance

    first = jnp.where(jnp.isfinite(start), start, far)
    distance, _ = jax.lax.while_loop(changed, rounds, rounds((first, first)))
    return distance


def _sweep(
    free: Bool[Array, "ny nx"], distance: Float[Array, "ny nx"], step: Float[Array, "ny nx"]
) -> Float[Array, "ny nx"]:
    """Return distances lowered row by row from the first: from the row before and then along the row itself.

    `step` is the length of a straight step into each cell [m]. Cells that are not free get inf.
    """

    def row(
        above: tuple[Bool[Array, " nx"], Float[Array, " nx"]], here: tuple[Array, Array, Array]
    ) -> tuple[tuple[Array, Array], Array]:
        free_above, there = above
        open_, known, length = here
        best = jnp.minimum(known, there + length)
        diagonal = length * jnp.float32(2**0.5)
        for side in (1, -1):
            beside = _shift(open_, side, False) & free_above & _shift(free_above, side, False)
            best = jnp.minimum(best, jnp.where(beside, _shift(there, side, jnp.inf) + diagonal, jnp.inf))
        best = _along(open_, jnp.where(open_, best, jnp.inf), length)
        return (open_, best), best

    nothing = jnp.zeros(free.shape[1], bool), jnp.full(free.shape[1], jnp.inf, jnp.float32)
    return jax.lax.scan(row, nothing, (free, distance, step))[1]


def _shift(values: Array, step: int, fill: float | bool) -> Array:
    """Return at each column the value `step` (1 or -1) columns before it; `fill` where there is none."""
    moved = jnp.roll(values, step)
    return moved.at[0 if step > 0 else -1].set(fill)


def _along(
    open_: Bool[Array, " nx"], distance: Float[Array, " nx"], length: Float[Array, " nx"]
) -> Float[Array, " nx"]:
    """Lower distances along a row in both directions; `length` is that of steps into a cell. Blocked cells have inf."""

    def join(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[Array, Array]:
        # (length of the segment, inf if it is blocked; minimum distance at its end)
        return a[0] + b[0], jnp.minimum(b[1], a[1] + b[0])

    step = jnp.where(open_, length, jnp.float32(jnp.inf))
    right = jax.lax.associative_scan(join, (step, distance))[1]
    left = jax.lax.associative_scan(join, (step, distance), reverse=True)[1]
    return jnp.minimum(right, left)


def goal_fields(
    bank: HouseBank, house: Int[Array, ""], level: Int[Array, ""], goals: Float[Array, "g 3"]
) -> Float[Array, "g ny nx"]:
    """Compute distance fields of one level of a house to goal points.

    Args:
        bank: The houses.
        house: Index of the house, not clipped.
        level: Index of the level's grid.
        goals: Points on that level [m]; free cells whose centre is within one cell of it in x and y are its sources.

    Returns:
        Distances over cells of any region to each goal's sources [m]; inf if there is no path, or no source.
    """
    free = bank.navigation.region[house, level] >= 0
    rows, columns = free.shape
    scaled = (goals[:, :2] - bank.navigation.origin[house][None]) / jnp.float32(bank.spec.cell)
    x, y = jnp.arange(columns, dtype=jnp.float32) + 0.5, jnp.arange(rows, dtype=jnp.float32) + 0.5
    near_x = jnp.abs(x[None] - scaled[:, :1]) <= 1
    near_y = jnp.abs(y[None] - scaled[:, 1:]) <= 1
    source = near_y[:, :, None] & near_x[:, None, :]
    return jax.vmap(distance_field, (None, 0, None))(free, source, bank.spec.cell)
