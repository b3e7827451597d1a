"""Geodesic distance fields on the device, for goals that are defined at run time."""

import functools
import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.native.kernel import Kernel, call_native
from home_mjx.core.native.vmap_call import call_kernel
from home_mjx.geometry.geodesic import is_walkable_rise
from home_mjx.navigation.grid import is_passable_cell, row_of_cell

REGION_DISTANCE = 1e4  # [m], height difference by which regions without heights are separated
FORTH, BACK = slice(None), slice(None, None, -1)  # orders of rows


class _GridMoves(NamedTuple):
    """Moves that a sweep may make into each cell: from the row before, straight and diagonal, and along the row."""

    free: Bool[Array, "ny nx"]
    straight: Bool[Array, "ny nx"]  # from the cell in the row before
    right: Bool[Array, "ny nx"]  # diagonal, from one column before
    left: Bool[Array, "ny nx"]  # diagonal, from one column behind
    along: Bool[Array, "ny nx"]  # between the cell and that one column before; in both directions


def distance_field(
    free: Bool[Array, "ny nx"],
    source: Bool[Array, "ny nx"],
    cell: float,
    step_factor: Float[Array, "ny nx"] | float = 1.0,
    height: Float[Array, "ny nx"] | None = None,
    passable: Bool[Array, "ny nx"] | None = None,
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
        height: Height of the cells [m], which are joined as in `geometry.geodesic.grid_edges`; None: equal heights.
        passable: Cells of which both must be beside a diagonal step; None: `free`.

    Returns:
        Distances in plan [m]; inf if there is no path, and in cells that are not free. With a factor of 1 and equal
        heights, equal to `geometry.geodesic.distance_fields` up to rounding.

    Example:
        >>> fields = jax.vmap(distance_field, (None, 0, None))(free, sources, 0.1)  # doctest: +SKIP
    """
    start = jnp.where(free & source, jnp.float32(0), jnp.inf)
    step = jnp.broadcast_to(jnp.float32(cell) * step_factor, free.shape)
    corners = free if passable is None else passable
    down, up = (
        _grid_moves(free[way], corners[way], None if height is None else height[way], cell) for way in (FORTH, BACK)
    )
    return KERNEL.select(_sweep_in_jax, {"cpu": _sweep_natively}, start, step, down, up)


def _sweep_in_jax(
    start: Float[Array, "ny nx"], step: Float[Array, "ny nx"], down: _GridMoves, up: _GridMoves
) -> Float[Array, "ny nx"]:
    """Return the distances [m] that sweeps converge to from `start`, 0 at sources, else inf.

    `step` is the length of a straight step into each cell [m], `up` has the moves of the grid upside down.
    """

    def changed(carry: tuple[Array, Array]) -> Array:
        """Return whether the last round lowered a distance."""
        return jnp.any(carry[0] < carry[1])

    def rounds(carry: tuple[Array, Array]) -> tuple[Array, Array]:
        """Sweep down, then up; return the distances after and before."""
        distance, _ = carry
        return _sweep(up, _sweep(down, distance, step)[BACK], step[BACK])[BACK], distance

    distance, _ = jax.lax.while_loop(changed, rounds, rounds((start, start)))
    return distance


@jax.custom_jvp
def _sweep_natively(
    start: Float[Array, "ny nx"], step: Float[Array, "ny nx"], down: _GridMoves, up: _GridMoves
) -> Float[Array, "ny nx"]:
    """Return the same as `_sweep_in_jax` by the kernel, up to rounding; moves upwards are those downwards, reversed."""
    bits = (
        move.astype(jnp.int32) << bit for bit, move in enumerate((down.straight, down.right, down.left, down.along))
    )
    return call_kernel(_call_sweeps, (), (), (start, step, sum(bits, jnp.zeros(start.shape, jnp.int32))))


_sweep_natively.defjvp(lambda primals, tangents: jax.jvp(_sweep_in_jax, primals, tangents))


def _call_sweeps(start: Float[Array, "e ny nx"], *grids: Array) -> tuple[Array, ...]:
    """Call the kernel for at least one cell."""
    if start.size == 0:
        return (start,)
    return tuple(call_native(KERNEL.name, (start, *grids), [jax.ShapeDtypeStruct(start.shape, jnp.float32)]))


def _compile_chunks() -> tuple[Any, Any]:
    """Compile the kernel; Numba is imported only here, because it loads slowly."""
    from home_mjx.navigation.numba_sweeps import compile_chunks

    return compile_chunks()


KERNEL = Kernel("home_mjx_distance_field", "distance fields on the CPU are slower", cpu=_compile_chunks)


def _grid_moves(
    free: Bool[Array, "ny nx"], passable: Bool[Array, "ny nx"], height: Float[Array, "ny nx"] | None, cell: float
) -> _GridMoves:
    """Return the moves into free cells from the row before and along the row, see `_GridMoves`.

    A diagonal one needs both cells beside it `passable`. Heights [m] limit moves, and detours of diagonal ones over
    either corner, by `is_walkable_rise` at the cell size `cell` [m]; None: no limit.
    """

    def joined(rows: int, columns: int) -> Array:
        """Return whether each cell and the one that many rows and columns before are free and walkable."""
        return free & _shift_grid(free, rows, columns, False) & walkable(rows, columns)

    def walkable(rows: int, columns: int) -> Array:
        """Return whether the rise from the cell that many rows and columns before is walkable."""
        if height is None:
            return jnp.ones_like(free)
        return is_walkable_rise(height - _shift_grid(height, rows, columns, 0.0), cell * math.hypot(rows, columns))

    def diagonal(column: int) -> Array:
        """Return the moves from the row before, one column before (`column` 1) or behind (-1)."""
        before, beside = walkable(1, 0), walkable(0, column)
        corners = _shift_grid(passable, 1, 0, False) & _shift_grid(passable, 0, column, False)
        corners &= before & _shift_grid(before, 0, column, False) & beside & _shift_grid(beside, 1, 0, False)
        return corners & joined(1, column)

    return _GridMoves(free, joined(1, 0), diagonal(1), diagonal(-1), joined(0, 1))


def _sweep(moves: _GridMoves, distance: Float[Array, "ny nx"], step: Float[Array, "ny nx"]) -> Float[Array, "ny nx"]:
    """Return distances [m] after one pass over the rows, from the first to the last.

    Each cell is lowered from its three neighbours in the row before, then along its row in both directions. `step` is
    the length of a straight step into each cell [m]. Cells that are not free get inf.
    """

    def row(there: Float[Array, " nx"], here: tuple[_GridMoves, Array, Array]) -> tuple[Array, Array]:
        """Lower the distances of one row from those of the row before, `there`."""
        move, known, length = here
        diagonal = length * jnp.float32(2**0.5)
        best = jnp.minimum(known, jnp.where(move.straight, there + length, jnp.inf))
        for side, is_open in ((1, move.right), (-1, move.left)):
            best = jnp.minimum(best, jnp.where(is_open, _shift(there, side, jnp.inf) + diagonal, jnp.inf))
        best = _along(move.along, jnp.where(move.free, best, jnp.inf), length)
        return best, best

    nothing = jnp.full(step.shape[1], jnp.inf, jnp.float32)
    return jax.lax.scan(row, nothing, (moves, distance, step))[1]


def _shift_grid(values: Array, rows: int, columns: int, fill: float | bool) -> Array:
    """Return values shifted towards higher indices by `rows` and `columns`, lower if negative; `fill` moves in."""
    pad = [(max(by, 0), max(-by, 0)) for by in (rows, columns)]
    wide = jnp.pad(values, pad, constant_values=fill)
    return wide[max(-rows, 0) :, max(-columns, 0) :][: values.shape[0], : values.shape[1]]


def _shift(values: Array, step: int, fill: float | bool) -> Array:
    """Return a row (nx,) shifted by one cell, to higher indices for `step` 1, lower for -1; `fill` moves in."""
    moved = jnp.roll(values, step)
    return moved.at[0 if step > 0 else -1].set(fill)


def _along(
    joined: Bool[Array, " nx"], distance: Float[Array, " nx"], length: Float[Array, " nx"]
) -> Float[Array, " nx"]:
    """Lower distances [m] along a row in both directions by steps between `joined` cells; blocked cells have inf.

    `joined` is True where a cell connects with the one before it; `length` is that of a step into each cell [m].
    """

    def join(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[Array, Array]:
        """Join two segments of the row: each is its length, inf if blocked, and the minimum distance at its end."""
        return a[0] + b[0], jnp.minimum(b[1], a[1] + b[0])

    far = jnp.float32(jnp.inf)
    right = jax.lax.associative_scan(join, (jnp.where(joined, length, far), distance))[1]
    back = jnp.where(_shift(joined, -1, False), length, far)
    left = jax.lax.associative_scan(join, (back, distance), reverse=True)[1]
    return jnp.minimum(right, left)


def goal_fields(
    bank: HouseBank, house: Int[Array, ""], level: Int[Array, ""], goals: Float[Array, "g 3"]
) -> Float[Array, "g ny nx"]:
    """Compute the geodesic distances from all cells of one level of a house to each of several goal points.

    Args:
        bank: The houses.
        house: Index of the house, not clipped.
        level: Index of the level's grid.
        goals: Points on that level [m]; free cells whose centre is within one cell of it in x and y have distance 0.
            z is unused.

    Returns:
        Distances to each goal [m], over paths on this level only, in any region; inf if there is no path, or no
        free cell at the goal.
    """
    region = bank.navigation.region[house, level]
    free, cell = region >= 0, bank.navigation.cell[house, level]
    narrow = is_passable_cell(bank, house, cell) & ~free
    # Other regions have no heights. They are not joined to the home region or to one another.
    height = bank.navigation.height[row_of_cell(cell)]
    height = jnp.where(narrow | (region == 0), height, jnp.float32(REGION_DISTANCE) * region.astype(jnp.float32))
    rows, columns = free.shape
    scaled = (goals[:, :2] - bank.navigation.origin[house][None]) / jnp.float32(bank.spec.cell)
    x, y = jnp.arange(columns, dtype=jnp.float32) + 0.5, jnp.arange(rows, dtype=jnp.float32) + 0.5
    near_x = jnp.abs(x[None] - scaled[:, :1]) <= 1
    near_y = jnp.abs(y[None] - scaled[:, 1:]) <= 1
    source = near_y[:, :, None] & near_x[:, None, :]
    field = functools.partial(distance_field, cell=bank.spec.cell, height=height, passable=free | narrow)
    return jax.vmap(field, (None, 0))(free, source)
