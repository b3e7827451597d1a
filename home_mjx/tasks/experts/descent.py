"""Walking down a field of distances, over cells that agents can cross."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_of, is_home, place_position, row_of_cell

LOOK_AHEAD = 6  # cells
SAMPLES = 8  # places of a straight way that are looked at

# Distance of some cells, given by level, row and column and as entries of `Navigation.cell`, in any unit.
Far = Callable[[Int[Array, "n 3"], Int[Array, " n"]], Array]


def descend(
    bank: HouseBank,
    house: Int[Array, ""],
    pos: Float[Array, "3"],
    touches: Bool[Array, ""],
    far: Far,
    least: float = 0.0,
) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
    """A place on the way down [m] to which an agent can walk straight, and whether none is lower than where it is.

    It is the farthest of the next `LOOK_AHEAD` cells for which all cells of the straight way are free; the next one for
    an agent that has run into something.

    Args:
        bank: The houses.
        house: Index of the house.
        pos: Middle of the agent [m].
        touches: It has run into something.
        far: The field.
        least: The way ends here, too, if less than so much of it is left [m].
    """
    numbers, part = bank.navigation.cell[house], jnp.linspace(0.0, 1.0, SAMPLES, dtype=jnp.float32)[:, None]
    at = cell_of(bank, house, pos)
    at = bank.navigation.place[row_of_cell(numbers[at[0], at[1], at[2]])].astype(jnp.int32)
    first, aim = at, place_position(bank, house, at)
    for step in range(LOOK_AHEAD):
        around = at + jnp.array([(0, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)], jnp.int32)
        around = jnp.clip(around, 0, jnp.array(numbers.shape, jnp.int32) - 1)
        cell = numbers[around[:, 0], around[:, 1], around[:, 2]]
        home, down = is_home(bank, house, cell), far(around, cell)
        best = jnp.argmin(jnp.where(home, down.astype(jnp.float32), jnp.inf))
        at = jnp.where(jnp.any(home), around[best], at)
        there = place_position(bank, house, at)
        between = jax.vmap(lambda p, there=there: cell_of(bank, house, p))(pos + part * (there - pos))
        free = jnp.all(is_home(bank, house, numbers[between[:, 0], between[:, 1], between[:, 2]]))
        aim = jnp.where((free & ~touches) | (step == 0), there, aim)
    end = jnp.linalg.norm(place_position(bank, house, at) - pos) < jnp.float32(least)
    return aim[:2], jnp.all(at == first) | end
