"""Descent of distance fields over walkable cells, around obstacles at their current poses."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.geometry.geodesic import MAX_RISE
from home_mjx.navigation.grid import (
    cell_at_feet,
    cell_number,
    continue_levels,
    grid_position,
    is_home_cell,
    is_passable_cell,
    row_of_cell,
)
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.experts.door_avoidance import cost_factors
from home_mjx.tasks.experts.local_planner import (
    HALF_WIDTH,
    WIDTH,
    descend_window,
    nearest_walkable,
    window_distances,
    window_places,
)

MAX_LOOK_AHEAD = 6  # [cells], maximum distance of a waypoint along the path
NUM_SEGMENT_SAMPLES = 8  # number of points of a straight segment that are checked
STEP_TOLERANCE, END_TOLERANCE = 0.2, 0.3  # tolerances, as fractions of a step, of a distance of one step and of zero

# Distance of cells [m], from their (level, row, column) and their entries of `NavigationArrays.cell`.
DistanceFunction = Callable[[Int[Array, "n 3"], Int[Array, " n"]], Float[Array, " n"]]


def descend_field(
    snapshot: Snapshot,
    agent: Int[Array, ""],
    field: DistanceFunction,
    min_distance: float = 0.0,
    tolerance: Float[Array, ""] | float = 0.0,
) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
    """Return a waypoint (x, y) [m] down a field, which an agent can walk straight to, and whether the path ends here.

    The path follows the field, but around door leaves and other agents at their current poses. The waypoint is the
    farthest of its next `MAX_LOOK_AHEAD` cells with a free straight segment, or that of `_next_cell` after a collision.
    With discrete moves the agent steps aside before the end if a step would overshoot it: see `step_aside`.

    Args:
        snapshot: The environment.
        agent: Index of the agent.
        field: Function that returns remaining distances of cells [m]; inf where no path leads.
        min_distance: Plan distance to the last of these cells below which the path ends, too [m].
        tolerance: As for `step_aside` [m]; only for discrete moves.
    """
    bank, house, moves = snapshot.bank, snapshot.house, snapshot.config.discrete
    pos, touches = snapshot.feet[agent], snapshot.in_contact[agent]
    path = _descend_cells(snapshot, agent, field)
    place = jax.vmap(lambda cell: grid_position(bank, house, cell))(path[1:])
    free, slow, slow_end = _check_segments(snapshot, agent, place)
    straight = free & (slow <= jax.lax.cummax(slow_end))  # may pass a leaf only if the path itself does
    aim = place[jnp.where(touches, _next_cell(snapshot, agent, place, straight), _last_index(straight)), :2]
    end, settled = place[-1, :2], jnp.all(path[-1] == path[-2])
    left = jnp.linalg.norm(end - pos[:2])
    if moves is None:
        return aim, jnp.all(path[-1] == path[0]) | (left < jnp.float32(min_distance))
    stride = moves.forward_step_size
    aside = step_aside(snapshot, agent, end, stride, tolerance)
    ends = left < jnp.float32(max(END_TOLERANCE * stride, min_distance))
    return jnp.where(settled & straight[-1], aside, aim), settled & ends


def circle_distance(
    snapshot: Snapshot, places: Int[Array, "n 3"], point: Float[Array, "3"], radius: Float[Array, ""]
) -> Float[Array, " n"]:
    """Return plan distances of centres of cells (level, row, column) to a circle around a point [m]; inside it, too.

    They are not negative. They replace a stored field for points that have none, such as objects that have moved.
    """
    place = jax.vmap(lambda p: grid_position(snapshot.bank, snapshot.house, p))(places)
    return jnp.abs(jnp.linalg.norm(place[:, :2] - point[:2], axis=1) - radius)


def is_free(snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "3"]) -> Bool[Array, ""]:
    """Return whether sampled points of the straight way to a floor point [m] are home cells; leaves do not matter.

    Points within `bank.spec.cell` of the agent's feet are not checked.
    """
    free, _, _ = _check_segments(snapshot, agent, place[None])
    return free[0]


def step_aside(
    snapshot: Snapshot,
    agent: Int[Array, ""],
    end: Float[Array, "2"],
    step_length: float,
    tolerance: Float[Array, ""] | float = 0.0,
) -> Float[Array, "2"]:
    """Return a waypoint (x, y) [m] from which one whole step ends at a target less than two steps away.

    It is the apex of a triangle with two sides of one step each, on a free side, the left one if both are. It is the
    target itself if that is farther away, if one step reaches it, or if no side is free.

    Args:
        snapshot: The environment.
        agent: Index of the agent.
        end: The target [m].
        step_length: Length of a step [m].
        tolerance: Maximum distance to the target after a step that reaches it [m].
    """
    pos = snapshot.feet[agent]
    way = end - pos[:2]
    left = jnp.linalg.norm(way)
    close = jnp.maximum(jnp.float32(STEP_TOLERANCE * step_length), jnp.float32(tolerance))
    fits = (jnp.abs(left - jnp.float32(step_length)) < close) | (left > jnp.float32(2 * step_length))
    along = jnp.where(left > 0, way / jnp.maximum(left, 1e-6), jnp.array([1.0, 0.0], jnp.float32))
    across = jnp.array([-along[1], along[0]])
    out = jnp.sqrt(jnp.maximum(jnp.float32(step_length) ** 2 - left * left / 4, 0.0))
    tips = pos[:2] + way / 2 + jnp.array([[1.0], [-1.0]], jnp.float32) * out * across
    free, slow, _ = _check_segments(snapshot, agent, jnp.concatenate([tips, jnp.full((2, 1), pos[2])], axis=1))
    free = free & (slow <= 1)
    tip = jnp.where(free[0], tips[0], tips[1])
    return jnp.where(fits | ~jnp.any(free), end, tip)


def _last_index(straight: Bool[Array, " k"]) -> Int[Array, ""]:
    """Return the index of the last True; 0 if there is none."""
    return jnp.argmax(jnp.where(straight, jnp.arange(straight.shape[0]), 0))


def _next_cell(
    snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "k 3"], straight: Bool[Array, " k"]
) -> Int[Array, ""]:
    """Return the index of the next cell of a path (positions [m]) after a collision.

    With discrete moves it is the cell with a free straight segment that one step ends nearest to; towards a nearer one
    an agent would overstep.
    """
    moves = snapshot.config.discrete
    if moves is None:
        return jnp.zeros((), jnp.int32)
    away = jnp.linalg.norm(place[:, :2] - snapshot.feet[agent, :2], axis=1)
    return jnp.argmin(jnp.where(straight, jnp.abs(away - jnp.float32(moves.forward_step_size)), jnp.inf))


def _descend_cells(snapshot: Snapshot, agent: Int[Array, ""], field: DistanceFunction) -> Int[Array, "k 3"]:
    """Return the agent's cell and the next `MAX_LOOK_AHEAD` cells down the field: level, row, column.

    The path changes levels on stairs; where it ends, its last cell is repeated.
    """
    bank, house = snapshot.bank, snapshot.house
    at = cell_at_feet(bank, house, snapshot.feet[agent])
    at = bank.navigation.cell_coords[row_of_cell(cell_number(bank, house, at))].astype(jnp.int32)
    places, inside = window_places(at, bank.navigation.cell.shape[1:])
    places = continue_levels(bank, house, at, places)
    cell = cell_number(bank, house, places)
    home = inside & is_home_cell(bank, house, cell)
    room = bank.navigation.room
    elsewhere = room[house, places[:, 0], places[:, 1], places[:, 2]] != room[house, at[0], at[1], at[2]]
    middle = jax.vmap(lambda p: grid_position(bank, house, p))(places)
    known = jnp.where(home, field(places, cell).astype(jnp.float32), jnp.inf)
    length = jnp.float32(bank.spec.cell) * cost_factors(snapshot, middle, agent)
    height, passable = middle[:, 2], inside & is_passable_cell(bank, house, cell)
    far = window_distances(known, length, height, passable)
    elsewhere |= jnp.abs(height - snapshot.feet[agent, 2]) >= jnp.float32(MAX_RISE)
    path = descend_window(far, height, nearest_walkable(known, elsewhere), MAX_LOOK_AHEAD, passable)
    row, column = (path + HALF_WIDTH).T
    return jnp.concatenate([places[row * WIDTH + column, :1], at[1:] + path], axis=1)


def _check_segments(
    snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "k 3"]
) -> tuple[Bool[Array, " k"], Float[Array, " k"], Float[Array, " k"]]:
    """Check straight segments from an agent's feet to positions `place` [m], at `NUM_SEGMENT_SAMPLES` points each.

    Returns:
        Whether each segment is in home cells, except for its first `bank.spec.cell`; the maximum of `cost_factors`
        along it; their maximum at its two ends.
    """
    bank, house, pos = snapshot.bank, snapshot.house, snapshot.feet[agent]
    part = jnp.linspace(0.0, 1.0, NUM_SEGMENT_SAMPLES, dtype=jnp.float32)[:, None]
    between = pos + part * (place - pos)[:, None]
    cell = jax.vmap(lambda at: cell_at_feet(bank, house, at))(between.reshape(-1, 3))
    home = is_home_cell(bank, house, cell_number(bank, house, cell))
    gone = jnp.linalg.norm(between - pos, axis=-1)
    off = gone < jnp.float32(bank.spec.cell)  # an agent may be outside walkable cells
    slow = cost_factors(snapshot, between.reshape(-1, 3), agent).reshape(between.shape[:2])
    ends = jnp.maximum(slow[:, 0], slow[:, -1])
    return jnp.all(home.reshape(slow.shape) | off, axis=1), jnp.max(slow, axis=1), ends
