"""Walking down a field of distances, over cells that agents can cross, around what is in the way just now."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.grid import cell_of, is_home, place_position, row_of_cell
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.leaves import slowness
from home_mjx.tasks.experts.window import descend_window, nearest_free, window_distances, window_places

LOOK_AHEAD = 6  # cells
SAMPLES = 8  # places of a straight way that are looked at
CLOSE, THERE = 0.2, 0.3  # parts of a step: a way as long as a step, or of no length, may be off by so much

# Distance of some cells, given by level, row and column and as entries of `Navigation.cell` [m].
Far = Callable[[Int[Array, "n 3"], Int[Array, " n"]], Float[Array, " n"]]


def descend(
    snapshot: Snapshot,
    agent: Int[Array, ""],
    far: Far,
    least: float = 0.0,
    within: Float[Array, ""] | float = 0.0,
) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
    """A place on the way down [m] to which an agent can walk straight, and whether none is lower than where it is.

    The way is that of the field, but around leaves of doors and other agents as they stand now. The place is the
    farthest of its next `LOOK_AHEAD` cells for which all cells of the straight way are free; the next one for an agent
    that has run into something. Who walks in steps is led aside before the end, if a step would lead beyond it: see
    `within_steps`.

    Args:
        snapshot: The environment.
        agent: Its number.
        far: The field.
        least: The way ends here, too, if less than so much of it is left [m].
        within: So near to its end is near enough [m].
    """
    bank, house, moves = snapshot.bank, snapshot.house, snapshot.config.discrete
    pos, touches = snapshot.pose.pos[agent], snapshot.contact[agent]
    path = _path(snapshot, agent, far)
    place = jax.vmap(lambda cell: place_position(bank, house, cell))(path[1:])
    free, slow, slow_end = _ways(snapshot, agent, place)
    straight = free & (slow <= jax.lax.cummax(slow_end))  # where the way itself leads past a leaf it may, too
    aim = place[jnp.argmax(jnp.where(straight & ~touches, jnp.arange(LOOK_AHEAD), 0)), :2]
    end, settled = place[-1, :2], jnp.all(path[-1] == path[-2])
    left = jnp.linalg.norm(end - pos[:2])
    if moves is None:
        return aim, jnp.all(path[-1] == path[0]) | (left < jnp.float32(least))
    stride = moves.forward_step_size
    aside = within_steps(snapshot, agent, end, stride, within)
    ends = left < jnp.float32(max(THERE * stride, least))
    return jnp.where(settled & straight[-1], aside, aim), settled & ends


def straight_distance(
    snapshot: Snapshot, places: Int[Array, "n 3"], point: Float[Array, "3"], apart: Float[Array, ""]
) -> Float[Array, " n"]:
    """Of cells to a circle around a point in the plan [m]: the field of what lies where no field was made for.

    Args:
        snapshot: The environment.
        places: Level, row and column of the cells.
        point: The point [m].
        apart: Radius of the circle [m].
    """
    place = jax.vmap(lambda p: place_position(snapshot.bank, snapshot.house, p))(places)
    return jnp.abs(jnp.linalg.norm(place[:, :2] - point[:2], axis=1) - apart)


def is_free(snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "3"]) -> Bool[Array, ""]:
    """Whether an agent can walk straight to a place [m]: the way is looked at in `SAMPLES` places."""
    free, _, _ = _ways(snapshot, agent, place[None])
    return free[0]


def within_steps(
    snapshot: Snapshot,
    agent: Int[Array, ""],
    end: Float[Array, "2"],
    stride: float,
    within: Float[Array, ""] | float = 0.0,
) -> Float[Array, "2"]:
    """Where to walk so that whole steps end at a place that is less than two steps away [m].

    That is the tip of a triangle with two sides of one step each, on the side where the way is free; the place itself,
    if it is farther away or one step leads to it.

    Args:
        snapshot: The environment.
        agent: Number of who walks.
        end: The place [m].
        stride: Length of a step [m].
        within: A step that ends so near to the place leads to it [m].
    """
    pos = snapshot.pose.pos[agent]
    way = end - pos[:2]
    left = jnp.linalg.norm(way)
    close = jnp.maximum(jnp.float32(CLOSE * stride), jnp.float32(within))
    fits = (jnp.abs(left - jnp.float32(stride)) < close) | (left > jnp.float32(2 * stride))
    along = jnp.where(left > 0, way / jnp.maximum(left, 1e-6), jnp.array([1.0, 0.0], jnp.float32))
    across = jnp.array([-along[1], along[0]])
    out = jnp.sqrt(jnp.maximum(jnp.float32(stride) ** 2 - left * left / 4, 0.0))
    tips = pos[:2] + way / 2 + jnp.array([[1.0], [-1.0]], jnp.float32) * out * across
    free, slow, _ = _ways(snapshot, agent, jnp.concatenate([tips, jnp.full((2, 1), pos[2])], axis=1))
    free = free & (slow <= 1)
    tip = jnp.where(free[0], tips[0], tips[1])
    return jnp.where(fits | ~jnp.any(free), end, tip)


def _path(snapshot: Snapshot, agent: Int[Array, ""], far: Far) -> Int[Array, "k 3"]:
    """Where it is, and the next `LOOK_AHEAD` cells on the way down."""
    bank, house = snapshot.bank, snapshot.house
    numbers = bank.navigation.cell[house]
    at = cell_of(bank, house, snapshot.pose.pos[agent])
    at = bank.navigation.place[row_of_cell(numbers[at[0], at[1], at[2]])].astype(jnp.int32)
    places, inside = window_places(at, numbers.shape)
    cell = numbers[places[:, 0], places[:, 1], places[:, 2]]
    home = inside & is_home(bank, house, cell)
    room = bank.navigation.room[house]
    elsewhere = room[places[:, 0], places[:, 1], places[:, 2]] != room[at[0], at[1], at[2]]
    middle = jax.vmap(lambda p: place_position(bank, house, p))(places)
    known = jnp.where(home, far(places, cell).astype(jnp.float32), jnp.inf)
    length = jnp.float32(bank.spec.cell) * slowness(snapshot, middle, agent)
    return at + descend_window(window_distances(known, length), nearest_free(known, elsewhere), LOOK_AHEAD)


def _ways(
    snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "k 3"]
) -> tuple[Bool[Array, " k"], Float[Array, " k"], Float[Array, " k"]]:
    """To which places all cells of the straight way are free; how slow the way is at most; how slow its ends are."""
    bank, house, pos = snapshot.bank, snapshot.house, snapshot.pose.pos[agent]
    part = jnp.linspace(0.0, 1.0, SAMPLES, dtype=jnp.float32)[:, None]
    between = pos + part * (place - pos)[:, None]
    cell = jax.vmap(lambda at: cell_of(bank, house, at))(between.reshape(-1, 3))
    home = is_home(bank, house, bank.navigation.cell[house][cell[:, 0], cell[:, 1], cell[:, 2]])
    gone = jnp.linalg.norm(between - pos, axis=-1)
    off = gone < jnp.float32(bank.spec.cell)  # an agent may stand beside the cells
    slow = slowness(snapshot, between.reshape(-1, 3), agent).reshape(between.shape[:2])
    ends = jnp.maximum(slow[:, 0], slow[:, -1])
    return jnp.all(home.reshape(slow.shape) | off, axis=1), jnp.max(slow, axis=1), ends
