"""Going along the shortest path, turning to what is meant, stopping where the task says so."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.grid import cell_of, place_position, row_of_cell
from home_mjx.schema.compiled import FIELD_FAR
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.environment.moves import action_names
from home_mjx.tasks.experts.grips import find_grip, has_hands, is_aimed, use_hands
from home_mjx.tasks.rows.features import boxes_now, nearest_meant, sights, table
from home_mjx.tasks.rows.machine import advance, conditions
from home_mjx.tasks.rows.row_task import RowState
from home_mjx.tasks.rows.words import FAILURE, Feature, Kind, Word
from home_mjx.tasks.sensors.cameras import eye_position

LOOK_AHEAD = 6  # cells
MARGIN = 0.1  # [m]: with something in its hand an agent goes so much nearer than it must
SAMPLES = 8  # places of a straight way that are looked at
ALIGNED = 0.8  # [rad]: an agent that looks farther away from its way turns first


def expert_action(snapshot: Snapshot, state: RowState) -> Array:
    """What every agent should do now.

    Args:
        snapshot: The environment.
        state: Of its row task.

    Returns:
        Actions as the environment takes them, with a leading agent axis.

    Example:
        >>> action = expert_action(env.core.snapshot(env.params, state), state.task)  # doctest: +SKIP
    """
    config, program = snapshot.config, state.program
    values = table(snapshot, program, state.means, snapshot.tasks.field, snapshot.step - state.since)
    guide = jnp.maximum(program.guide[jnp.maximum(state.stage, 0)], 0)
    _, box = nearest_meant(snapshot, program, state.means, boxes_now(snapshot))
    stop, (way, there) = should_stop(state, values), downhill(snapshot, state, guide)
    if not has_hands(snapshot):
        return to_actions(config, *facing(snapshot, state, values, box[:, guide], way, there), stop)
    farther = values.at[Feature.DISTANCE].add(MARGIN)  # what is carried pushes
    stop = stop & (there | should_stop(state, farther))
    grip = find_grip(snapshot, state, values, box[:, guide])
    works = (grip.take | grip.put) & ~stop
    stands = works & (grip.ready | there)
    error, tilt, near = facing(snapshot, state, farther, box[:, guide], way, there & ~works)
    walks = _apart(way, snapshot.pose.yaw)
    error = jnp.where(stands, grip.turn, jnp.where(works, walks, error))
    tilt, near = jnp.where(stands, grip.tilt, tilt), jnp.where(works, stands, near)
    actions = to_actions(config, error, tilt, near, stop)
    return use_hands(config, actions, grip, stands & is_aimed(config, grip))


def facing(
    snapshot: Snapshot,
    state: RowState,
    values: Float[Array, "feature a d d"],
    box: Float[Array, "a 2 3"],
    way: Float[Array, " a"],
    there: Bool[Array, " a"],
) -> tuple[Float[Array, " a"], Float[Array, " a"], Bool[Array, " a"]]:
    """Turn to the left and tilt up [rad] along the way, or towards what the guide means where that is all that is left.

    Args:
        snapshot: The environment.
        state: Of its row task.
        values: See `features.table`.
        box: Bounds of what the guide means [m].
        way: Heading of the way [rad].
        there: Whether it ends here.

    Returns:
        Turn, tilt, and who stands and looks.
    """
    guide = jnp.maximum(state.program.guide[jnp.maximum(state.stage, 0)], 0)
    points, free = (x[:, 0] for x in sights(snapshot, box[:, None]))
    agents = jnp.arange(points.shape[0])
    offset = points[agents, jnp.argmax(free, axis=-1)] - eye_position(snapshot.config, snapshot.pose)
    is_thing = state.program.descriptor[guide, Word.KIND] == Kind.OBJECT
    near = is_thing & (there | (jnp.any(free, axis=-1) & should_look(state, values)))
    faces = jnp.arctan2(offset[:, 1], offset[:, 0])
    heading = jnp.where(near & jnp.all(jnp.isfinite(offset), axis=-1), faces, way)
    level = jnp.linalg.norm(offset[:, :2], axis=-1)
    rise = jnp.where(near & jnp.isfinite(level), jnp.arctan2(offset[:, 2], jnp.maximum(level, 0.3)), 0.0)
    return _apart(heading, snapshot.pose.yaw), rise - snapshot.pose.pitch, near


def _apart(heading: Float[Array, " a"], yaw: Float[Array, " a"]) -> Float[Array, " a"]:
    return (heading - yaw + jnp.pi) % (2 * jnp.pi) - jnp.pi


def should_look(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Whether a transition of the present stage waits for no more than a look or a stop of each agent."""
    turned = values.at[jnp.array([Feature.STOPPED, Feature.SEEN])].set(1.0)
    after, _, taken = advance(state.program, state.stage, conditions(state.program, turned))
    return jnp.broadcast_to(taken & (after != FAILURE), values.shape[1:2])


def should_stop(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Whether a transition of the present stage waits for nothing but each agent's `stop`."""
    program = state.program
    said = values.at[Feature.STOPPED].set(1.0)
    after, _, taken = advance(program, state.stage, conditions(program, said))
    quiet = advance(program, state.stage, conditions(program, values))[2]
    good = taken & ~quiet & (after != FAILURE)
    return jnp.broadcast_to(good, values.shape[1:2])


def downhill(
    snapshot: Snapshot, state: RowState, guide: Int[Array, ""]
) -> tuple[Float[Array, " a"], Bool[Array, " a"]]:
    """Heading of the shortest way to what a descriptor means [rad], and whether no place is nearer.

    Each agent can walk straight to the place that it heads for: that is the farthest of the next `LOOK_AHEAD` cells for
    which all cells of the straight way are free; the next one for an agent that has run into something.
    """
    bank, house = snapshot.bank, snapshot.house
    field = snapshot.tasks.field[:, jnp.maximum(state.program.field[guide], 0)]
    numbers = bank.navigation.cell[house]
    moves = snapshot.config.discrete
    least = moves.forward_step_size / 2 if moves and has_hands(snapshot) else 0.0  # who goes on would pass the end
    part = jnp.linspace(0.0, 1.0, SAMPLES, dtype=jnp.float32)[:, None]

    def is_home(cell: Int[Array, "n"]) -> Bool[Array, "n"]:
        return (cell >= 0) & (cell - bank.navigation.first_cell[house] < bank.navigation.num_cells[house])

    def ahead(pos: Float[Array, "3"], touches: Bool[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        at = cell_of(bank, house, pos)
        at = bank.navigation.place[row_of_cell(numbers[at[0], at[1], at[2]])].astype(jnp.int32)
        first, aim = at, place_position(bank, house, at)
        for step in range(LOOK_AHEAD):
            around = at + jnp.array([(0, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)], jnp.int32)
            around = jnp.clip(around, 0, jnp.array(numbers.shape, jnp.int32) - 1)
            cell = numbers[around[:, 0], around[:, 1], around[:, 2]]
            home = is_home(cell)
            far = jnp.where(home, field[row_of_cell(cell)].astype(jnp.int32), FIELD_FAR + 1)
            at = jnp.where(jnp.any(home), around[jnp.argmin(far)], at)
            there = place_position(bank, house, at)
            between = jax.vmap(lambda p: cell_of(bank, house, p))(pos + part * (there - pos))
            free = jnp.all(is_home(numbers[between[:, 0], between[:, 1], between[:, 2]]))
            aim = jnp.where((free & ~touches) | (step == 0), there, aim)
        end = jnp.linalg.norm(place_position(bank, house, at) - pos) < jnp.float32(least)
        return aim[:2], jnp.all(at == first) | end

    aim, there = jax.vmap(ahead)(snapshot.pose.pos, snapshot.contact)
    aim = aim - snapshot.pose.pos[:, :2]
    return jnp.arctan2(aim[:, 1], aim[:, 0]), there


def to_actions(
    config: EnvConfig,
    error: Float[Array, " a"],
    tilt: Float[Array, " a"],
    near: Bool[Array, " a"],
    stop: Bool[Array, " a"],
) -> Array:
    """Actions that turn by `error` to the left and by `tilt` up [rad] and, unless near, go on."""
    if config.discrete is None:
        return _continuous(config, error, tilt, near, stop)
    return _discrete(config, error, tilt, near, stop)


def _continuous(config: EnvConfig, error: Array, tilt: Array, near: Array, stop: Array) -> Float[Array, "a n"]:
    dt = config.timing.ctrl_dt
    rates = jnp.array([body.turn_rate for body in config.physics.agents], jnp.float32)
    forward = jnp.where(jnp.abs(error) < ALIGNED, jnp.cos(error), 0.0)
    forward = jnp.where(near | stop, 0.0, forward)
    turn, look = jnp.clip(error / (rates * dt), -1, 1), jnp.clip(tilt / (config.look_rate * dt), -1, 1)
    actions = jnp.zeros((error.shape[0], len(action_names(config))), jnp.float32)
    return actions.at[:, 0].set(forward).at[:, 2].set(turn).at[:, 3].set(look)


def _discrete(config: EnvConfig, error: Array, tilt: Array, near: Array, stop: Array) -> Int[Array, " a"]:
    moves, names = config.discrete, action_names(config)
    assert moves is not None
    half, step = math.radians(moves.turn_angle) / 2, math.radians(moves.tilt_angle) / 2
    turn = jnp.where(error > 0, names.index("turn_left"), names.index("turn_right"))
    look = jnp.where(tilt > 0, names.index("look_up"), names.index("look_down"))
    there = jnp.where(jnp.abs(tilt) > step, look, names.index("move_forward"))
    ahead = jnp.where(near, there, names.index("move_forward"))
    chosen = jnp.where(jnp.abs(error) > half + 1e-3, turn, ahead)
    return jnp.where(stop, names.index("stop"), chosen).astype(jnp.int32)
