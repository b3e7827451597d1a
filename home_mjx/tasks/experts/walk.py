"""Expert policy: follow the shortest path, turn to the target, stop as the task requires."""

import math
from typing import Protocol, runtime_checkable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.transforms import wrap_angle
from home_mjx.navigation.grid import stored_distance
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.moves import action_names
from home_mjx.tasks.experts.carrying import DROPPED, MOVED, at_hand, clear_turns, has_hands, moved_by
from home_mjx.tasks.experts.descent import descend, straight_distance
from home_mjx.tasks.experts.grips import elsewhere, find_grip, is_aimed, open_doors, use_hands
from home_mjx.tasks.experts.leaves import faces_shut_leaf, opening
from home_mjx.tasks.experts.speaking import or_words
from home_mjx.tasks.rules.features import Looked, inside, look
from home_mjx.tasks.rules.machine import advance, conditions
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.rules.words import FAILURE, Feature, Kind, Word
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.sight import SHIFTS, clear

LAG = 0.2  # [m], maximum distance that a moving target gains until `stop` takes effect
MARGIN = 0.1  # [m], by which agents with hands go closer than required, because carried objects push
TOUCHING = 0.05  # [m], the same in contact, where a carried object may keep the agent away
PATIENT = 2  # rounds of `elsewhere` after which objects are picked up from any position
OPENS = 6  # [steps] between attempts to open a door; in between the agent moves clear or through
ON_THE_SPOT = 1.0  # [rad], turn of a waiting agent, because no action is idle
FACING = 0.1  # [rad], maximum heading error of an agent that opens a door
ALIGNED = 0.8  # [rad], heading error above which an agent turns before it walks


@runtime_checkable
class HasExpert(Protocol):
    """State of a task with its own expert."""

    def expert(self, snapshot: Snapshot) -> Array:
        """Return the current actions of every acting agent."""
        ...


def expert_action(snapshot: Snapshot, state: RowState | HasExpert) -> Array:
    """Return the expert's current action for every agent.

    Args:
        snapshot: The environment.
        state: State of its task: a `RowState`, or one with its own expert.

    Returns:
        Actions in the environment's format, with an axis of all agents, or of the acting ones if the task has its own
        expert.

    Example:
        >>> action = expert_action(env.core.snapshot(env.params, state), state.task)  # doctest: +SKIP
    """
    if isinstance(state, HasExpert):
        return state.expert(snapshot)
    config, program, looked = snapshot.config, state.program, looks(snapshot, state)
    values, box = looked.values, looked.box
    guide = jnp.maximum(program.guide[jnp.maximum(state.stage, 0)], 0)
    later = lasting(snapshot, state, looked)
    stop, (way, there) = should_stop(state, later), downhill(snapshot, state, guide, box[:, guide])
    if not has_hands(snapshot):
        error, tilt, near = facing(snapshot, state, looked, way, there)
        waits = should_wait(state, values)
        actions = to_actions(config, jnp.where(waits, ON_THE_SPOT, error), tilt, near | waits, stop)
        return or_words(snapshot, state, values, actions)
    farther = values.at[Feature.DISTANCE].add(MARGIN)  # carried objects push
    spare = jnp.where(snapshot.contact, TOUCHING, MARGIN)[:, None, None]
    stop = stop & (there | should_stop(state, later.at[Feature.DISTANCE].add(spare)))
    grip = find_grip(snapshot, state, values, box[:, guide])
    works = (grip.take | grip.put) & ~stop
    meant = state.means.instance[guide]
    dropped = moved_by(snapshot, meant, box[:, guide].mean(axis=1)) > DROPPED
    goes, before, where = elsewhere(snapshot, state, dropped)
    busy, right, face = opening(snapshot)
    busy = busy & ~goes & (before % 2 == 0)  # skipped in every second round, because it may not help
    stuck = goes & ~works & (snapshot.held >= 0) & (snapshot.contact | (before > 0))  # by its carried object
    way = jnp.where(stuck, where, way)
    # Rows lead to positions from which objects can be carried away: pick up there, even if reachable before.
    settles = grip.put | dropped | snapshot.contact | (before >= PATIENT)
    stands = works & (there | (grip.ready & settles)) & ~goes
    error, tilt, near = facing(snapshot, state, looked.replace(values=farther), way, there & ~works)
    heading = jnp.where(goes & (there | snapshot.contact), where, way)
    walks = wrap_angle(heading - snapshot.pose.yaw)
    error = jnp.where(stands, grip.turn, jnp.where(works, walks, error))
    tilt, near = jnp.where(stands, grip.tilt, tilt), jnp.where(works, stands, near)
    busy &= ~stands & ~stop
    error, near = jnp.where(busy, wrap_angle(face - snapshot.pose.yaw), error), jnp.where(busy, right, near)
    waits = should_wait(state, values)
    error, near = jnp.where(waits, ON_THE_SPOT, error), near | waits
    actions = to_actions(config, clear_turns(snapshot, error), tilt, near, stop)
    actions = use_hands(config, actions, grip, stands & is_aimed(config, grip))
    faces = jnp.where(busy, right & (jnp.abs(error) < FACING), faces_shut_leaf(snapshot, snapshot.pose.yaw))
    actions = open_doors(config, actions, faces & ~stands & ~stop & (snapshot.step % OPENS == 0))
    return or_words(snapshot, state, values, actions)


def looks(snapshot: Snapshot, state: RowState) -> Looked:
    """Return the current feature values: from the task's state if it keeps them, else computed anew."""
    time = snapshot.step - state.since
    if state.looked is None:
        return look(snapshot, state.program, state.means, snapshot.tasks.field, time)
    return state.looked.replace(values=state.looked.values.at[Feature.TIME].set(time.astype(jnp.float32)))


def facing(
    snapshot: Snapshot,
    state: RowState,
    looked: Looked,
    way: Float[Array, " a"],
    there: Bool[Array, " a"],
) -> tuple[Float[Array, " a"], Float[Array, " a"], Bool[Array, " a"]]:
    """Return turn to the left and tilt up [rad]: along the path, or to the guide's target if only a look is missing.

    Args:
        snapshot: The environment.
        state: State of its row task.
        looked: See `looks`.
        way: Heading of the path [rad].
        there: True if the path ends here.

    Returns:
        Turn, tilt, and which agents stop to look.
    """
    guide = jnp.maximum(state.program.guide[jnp.maximum(state.stage, 0)], 0)
    points, free = looked.points[:, guide], looked.free[:, guide]
    agents = jnp.arange(points.shape[0])
    offset = points[agents, jnp.argmax(free, axis=-1)] - eye_position(snapshot.config, snapshot.pose)
    is_thing = state.program.descriptor[guide, Word.KIND] == Kind.OBJECT
    # An agent that does not see the target from its viewpoint walks on to the centre of the cell.
    near = is_thing & jnp.any(free, axis=-1) & (there | should_look(state, looked.values))
    faces = jnp.arctan2(offset[:, 1], offset[:, 0])
    heading = jnp.where(near & jnp.all(jnp.isfinite(offset), axis=-1), faces, way)
    level = jnp.linalg.norm(offset[:, :2], axis=-1)
    rise = jnp.where(near & jnp.isfinite(level), jnp.arctan2(offset[:, 2], jnp.maximum(level, 0.3)), 0.0)
    return wrap_angle(heading - snapshot.pose.yaw), rise - snapshot.pose.pitch, near


def should_look(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the current stage needs only a look or a `stop` of each agent."""
    turned = values.at[jnp.array([Feature.STOPPED, Feature.SEEN])].set(1.0)
    after, _, taken = advance(state.program, state.stage, conditions(state.program, turned))
    return jnp.broadcast_to(taken & (after != FAILURE), values.shape[1:2])


def lasting(snapshot: Snapshot, state: RowState, looked: Looked) -> Float[Array, "feature a d d"]:
    """Return feature values with margins for the step in which `stop` takes effect, one step later.

    A collision must not push an agent out of its room by then, and a moving target must stay visible and close.
    """
    values, walks, shifts = looked.values, jnp.any(state.emission.speed > 0), jnp.asarray(SHIFTS[1:], jnp.float32)

    def shifted(shift: Float[Array, "3"]) -> Bool[Array, "a d"]:
        pose = snapshot.pose.replace(pos=snapshot.pose.pos + shift)
        return inside(snapshot.replace(pose=pose), state.means)

    deep = jnp.all(jax.vmap(shifted)(shifts), axis=0) | snapshot.contact[:, None]
    values = values.at[Feature.INSIDE].multiply(deep.astype(jnp.float32)[:, :, None])
    target = jnp.maximum(state.emission.emitter[0], 0).astype(jnp.int32)
    eyes, own = eye_position(snapshot.config, snapshot.pose), agent_ids(snapshot.bank, values.shape[1])
    box = looked.box[:, target]
    free = jax.vmap(clear, (None, 0, 0, 0, 0))(snapshot.scene, eyes, box, box.mean(axis=1)[:, None] + shifts, own)
    shows = jnp.all(free, axis=-1)[:, None, None] | ~walks
    values = values.at[Feature.CLEAR].multiply(shows.astype(jnp.float32))
    return values.at[Feature.STRAIGHT].add(jnp.where(walks, LAG, 0.0))


def should_wait(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the current stage needs only time."""
    later = values.at[Feature.TIME].set(jnp.inf)
    after, _, taken = advance(state.program, state.stage, conditions(state.program, later))
    quiet = advance(state.program, state.stage, conditions(state.program, values))[2]
    return jnp.broadcast_to(taken & ~quiet & (after != FAILURE), values.shape[1:2])


def should_stop(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the current stage needs only the `stop` of each agent."""
    program = state.program
    said = values.at[Feature.STOPPED].set(1.0)
    after, _, taken = advance(program, state.stage, conditions(program, said))
    quiet = advance(program, state.stage, conditions(program, values))[2]
    return jnp.broadcast_to(taken & ~quiet & (after != FAILURE), values.shape[1:2])


def downhill(
    snapshot: Snapshot, state: RowState, guide: Int[Array, ""], box: Float[Array, "a 2 3"]
) -> tuple[Float[Array, " a"], Bool[Array, " a"]]:
    """Return the heading of the shortest path to a descriptor's target [rad], and whether the path ends here.

    Each agent can walk straight along it, see `descend`; inside a target room it walks on. The field of a dropped
    object is
    outdated: agents head for its current position.

    Args:
        snapshot: The environment.
        state: State of its row task.
        guide: Index of the descriptor.
        box: Bounds of the nearest object that it selects [m].
    """
    moves, column = snapshot.config.discrete, jnp.maximum(state.program.field[guide], 0).astype(jnp.int32)
    least = moves.forward_step_size / 2 if moves and has_hands(snapshot) else 0.0  # a further step would overshoot
    is_room = state.program.descriptor[guide, Word.KIND] == Kind.ROOM  # any position beyond its threshold counts
    within = jnp.where(is_room, jnp.inf, 0.0)
    middle = box.mean(axis=1)
    away, apart = moved_by(snapshot, state.means.instance[guide], middle), at_hand(snapshot, middle)

    def ahead(agent: Int[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        def far(places: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            known = stored_distance(snapshot.tasks.field, cell, column)
            if not has_hands(snapshot):
                return known
            now = straight_distance(snapshot, places, middle[agent], apart[agent])
            return jnp.where(away[agent] > MOVED, now, known)

        return descend(snapshot, agent, far, least, within)

    aim, there = jax.vmap(ahead)(jnp.arange(snapshot.config.num_agents))
    aim = aim - snapshot.pose.pos[:, :2]
    inwards = there & is_room  # straight on, away from the threshold
    return jnp.where(inwards, snapshot.pose.yaw, jnp.arctan2(aim[:, 1], aim[:, 0])), there & ~is_room


def turn_towards(
    snapshot: Snapshot, aim: Float[Array, "a 2"], agents: Int[Array, " a"] | None = None
) -> Float[Array, " a"]:
    """Return the turns to the left after which agents face positions [rad].

    Args:
        snapshot: The environment.
        aim: Position for each agent [m].
        agents: Indices of the agents; None: all.
    """
    pose = snapshot.pose
    pos, yaw = (pose.pos, pose.yaw) if agents is None else (pose.pos[agents], pose.yaw[agents])
    way = aim - pos[:, :2]
    return wrap_angle(jnp.arctan2(way[:, 1], way[:, 0]) - yaw)


def to_actions(
    config: EnvConfig,
    error: Float[Array, " a"],
    tilt: Float[Array, " a"],
    near: Bool[Array, " a"],
    stop: Bool[Array, " a"],
) -> Array:
    """Return actions that turn by `error` to the left and tilt by `tilt` up [rad] and, unless `near`, walk forward."""
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
