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
from home_mjx.tasks.base.specs import DiscreteActions
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.experts.carry_clearance import (
    MAX_FIELD_DISPLACEMENT,
    MIN_DROPPED_DISPLACEMENT,
    choose_clear_turns,
    displacements,
    has_hands,
    pick_distance,
)
from home_mjx.tasks.experts.door_avoidance import is_facing_shut_leaf, plan_opening
from home_mjx.tasks.experts.field_descent import circle_distance, descend_field
from home_mjx.tasks.experts.grasp_aiming import add_door_commands, add_hand_commands, is_aimed, plan_grasp, plan_retreat
from home_mjx.tasks.experts.speech import insert_words
from home_mjx.tasks.rules.containment import start_positions
from home_mjx.tasks.rules.enums import Attribute, Feature, TargetKind
from home_mjx.tasks.rules.features import FeatureValues, compute_features, is_in_target_room
from home_mjx.tasks.rules.program import leads_on, needs_only
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.visibility import EYE_OFFSETS, is_unobstructed

MAX_TARGET_LAG = 0.2  # [m], maximum distance that a moving target gains until `stop` takes effect
DISTANCE_MARGIN = 0.1  # [m], by which agents with hands go closer than required, because carried objects push
CONTACT_DISTANCE_MARGIN = 0.05  # [m], the same in contact, where a carried object may keep the agent away
MAX_RETREATS = 2  # rounds of `plan_retreat` after which hands act from any position
OPEN_PERIOD = 6  # [steps] between attempts to open a door; in between the agent moves clear or through
MIN_TURN_STEPS = 1.5  # [steps], smallest turn that a teacher begins while it walks
IDLE_TURN = 1.0  # [rad], turn of a waiting agent, because no action is idle
MAX_DOOR_HEADING_ERROR = 0.1  # [rad], maximum heading error of an agent that opens a door
MAX_WALK_HEADING_ERROR = 0.8  # [rad], heading error above which an agent turns before it walks


@runtime_checkable
class HasExpert(Protocol):
    """State of a task with its own expert."""

    def expert(self, snapshot: Snapshot) -> Array:
        """Return the current actions of every acting agent."""
        ...


def expert_action(snapshot: Snapshot, state: RowState | HasExpert, teaches: bool = False) -> Array:
    """Return the expert's current action for every agent; `state` is a `RowState`, or has an expert of its own.

    Actions are in the environment's format with an agent axis, of the acting agents if `state` has its own expert.

    Args:
        snapshot: The environment.
        state: State of the task.
        teaches: Act with hands as an agent can that has no map. It picks objects up from where it first can aim at
            them, even if it may collide with what it carries, instead of from a position of the row, which nobody sees.
            Discrete looks become level before it walks, as continuous ones always do, so that it sees its way,
            and it begins no turn below `MIN_TURN_STEPS` while it walks.

    Example:
        >>> action = expert_action(env.core.snapshot(env.params, state), state.task)  # doctest: +SKIP
    """
    if isinstance(state, HasExpert):
        return state.expert(snapshot)
    config, program, looked = snapshot.config, state.program, current_features(snapshot, state)
    values, box = looked.values, looked.nearest_box
    guide = jnp.maximum(program.guide[jnp.maximum(state.stage, 0)], 0)
    later = pessimistic_features(snapshot, state, looked)
    stop, (way, there) = should_stop(state, later), heading_to_target(snapshot, state, guide, box[:, guide])
    if not has_hands(snapshot):
        error, tilt, near = plan_view(snapshot, state, looked, way, there)
        waits = should_wait(state, values)
        actions = to_actions(config, jnp.where(waits, IDLE_TURN, error), tilt, near | waits, stop)
        return insert_words(snapshot, state, values, actions)
    farther = values.at[Feature.DISTANCE].add(DISTANCE_MARGIN)  # carried objects push
    spare = jnp.where(snapshot.in_contact, CONTACT_DISTANCE_MARGIN, DISTANCE_MARGIN)[:, None, None]
    stop = stop & (there | should_stop(state, later.at[Feature.DISTANCE].add(spare)))
    grip = plan_grasp(snapshot, state, values, box[:, guide])
    toggles = grip.toggle != 0
    works = (grip.pick | grip.place | grip.open | toggles) & ~stop
    meant = state.targets.instance[guide]
    begin = start_positions(snapshot, program, state.targets)
    dropped = displacements(snapshot, begin, meant, box[:, guide].mean(axis=1)) > MIN_DROPPED_DISPLACEMENT
    goes, before, where = plan_retreat(snapshot, state, dropped)
    busy, right, face = plan_opening(snapshot)
    busy = busy & ~goes & (before % 2 == 0)  # skipped in every second round, because it may not help
    stuck = goes & ~works & (snapshot.held >= 0) & (snapshot.in_contact | (before > 0))  # by its carried object
    way = jnp.where(stuck, where, way)
    # Rows lead to positions from which objects can be carried away: pick up there, even if reachable before.
    settles = grip.place | toggles | dropped | snapshot.in_contact | jnp.bool_(teaches)
    settles = (settles & ~grip.open) | (before >= MAX_RETREATS)
    stands = works & (there | (grip.can_aim & settles)) & ~goes
    error, tilt, near = plan_view(snapshot, state, looked.replace(values=farther), way, there & ~works)
    heading = jnp.where(goes & (there | snapshot.in_contact), where, way)
    walks = wrap_angle(heading - snapshot.pose.yaw)
    error = jnp.where(stands, grip.turn, jnp.where(works, walks, error))
    tilt, near = jnp.where(stands, grip.tilt, tilt), jnp.where(works, stands, near)
    busy &= ~stands & ~stop
    error, near = jnp.where(busy, wrap_angle(face - snapshot.pose.yaw), error), jnp.where(busy, right, near)
    waits = should_wait(state, values)
    error, near = jnp.where(waits, IDLE_TURN, error), near | waits
    error = choose_clear_turns(snapshot, error)
    if teaches and config.discrete is not None:
        error = jnp.where(near | busy, error, without_small_turns(config, snapshot.action, error))
    actions = to_actions(config, error, tilt, near, stop, looks_first=teaches)
    aimed = stands & is_aimed(config, grip)
    actions = add_hand_commands(config, actions, grip, aimed)
    faces = jnp.where(
        busy, right & (jnp.abs(error) < MAX_DOOR_HEADING_ERROR), is_facing_shut_leaf(snapshot, snapshot.pose.yaw)
    )
    opens = faces & ~stands & ~stop & (snapshot.step % OPEN_PERIOD == 0)
    actions = add_door_commands(config, actions, opens | (aimed & grip.open & grip.can_aim))
    return insert_words(snapshot, state, values, actions)


def without_small_turns(
    config: EnvConfig, action: Float[Array, "a n"], error: Float[Array, " a"]
) -> Float[Array, " a"]:
    """Return turns to the left [rad], 0 where less than `MIN_TURN_STEPS` steps are left and none has just been taken.

    Agents thus walk on after a step that bends the path a little, and finish the turns that they have begun.

    Args:
        config: Options of the environment, with discrete actions.
        action: Last action of each agent, by `action_names`.
        error: Turns to the left [rad].
    """
    moves = config.discrete
    assert moves is not None
    names, least = action_names(config), jnp.float32(MIN_TURN_STEPS * math.radians(moves.turn_angle))
    went = action[:, names.index("turn_left")] - action[:, names.index("turn_right")]
    return jnp.where((jnp.abs(error) < least) & (went * jnp.sign(error) <= 0), 0.0, error)


def current_features(snapshot: Snapshot, state: RowState) -> FeatureValues:
    """Return the feature values of this step: from the task's state if it stores them, else computed anew."""
    time = snapshot.step - state.stage_start
    if state.features is None:
        return compute_features(snapshot, state.program, state.targets, snapshot.tasks.field, time)
    return state.features.replace(values=state.features.values.at[Feature.TIME].set(time.astype(jnp.float32)))


def plan_view(
    snapshot: Snapshot,
    state: RowState,
    looked: FeatureValues,
    path_heading: Float[Array, " a"],
    at_end: Bool[Array, " a"],
) -> tuple[Float[Array, " a"], Float[Array, " a"], Bool[Array, " a"]]:
    """Return turn to the left and tilt up [rad]: along the path, or to the guide's target if only a look is missing.

    On the path the view becomes level. The look goes to the first of the target's points that is in free sight.

    Args:
        snapshot: The environment.
        state: State of its row task.
        looked: See `current_features`.
        path_heading: Heading of the path [rad].
        at_end: True if the path ends here.

    Returns:
        Turn, tilt, and which agents stop to look.
    """
    guide = jnp.maximum(state.program.guide[jnp.maximum(state.stage, 0)], 0)
    points, free = looked.sight_points[:, guide], looked.is_sight_free[:, guide]
    agents = jnp.arange(points.shape[0])
    offset = points[agents, jnp.argmax(free, axis=-1)] - eye_position(snapshot.config, snapshot.pose)
    is_thing = state.program.descriptor[guide, Attribute.KIND] == TargetKind.OBJECT
    # An agent that does not see the target from its viewpoint walks on to the centre of the cell.
    near = is_thing & jnp.any(free, axis=-1) & (at_end | should_look(state, looked.values))
    faces = jnp.arctan2(offset[:, 1], offset[:, 0])
    heading = jnp.where(near & jnp.all(jnp.isfinite(offset), axis=-1), faces, path_heading)
    level = jnp.linalg.norm(offset[:, :2], axis=-1)
    rise = jnp.where(near & jnp.isfinite(level), jnp.arctan2(offset[:, 2], jnp.maximum(level, 0.3)), 0.0)
    return wrap_angle(heading - snapshot.pose.yaw), rise - snapshot.pose.pitch, near


def should_look(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the stage, not to FAILURE, needs at most SEEN and STOPPED; same for all agents."""
    turned = values.at[jnp.array([Feature.STOPPED, Feature.SEEN])].set(1.0)
    return jnp.broadcast_to(leads_on(state.program, state.stage, turned)[0], values.shape[1:2])


def pessimistic_features(snapshot: Snapshot, state: RowState, looked: FeatureValues) -> Float[Array, "feature a d d"]:
    """Return feature values with margins for the step in which `stop` takes effect, one step later.

    INSIDE must hold at all `EYE_OFFSETS`, unless in contact: a collision could push the agent out of its room. For a
    moving target CLEAR must hold for points around its middle, and STRAIGHT is larger by `MAX_TARGET_LAG`.
    """
    values, walks, shifts = (
        looked.values,
        jnp.any(state.sound_events.speed > 0),
        jnp.asarray(EYE_OFFSETS[1:], jnp.float32),
    )

    def shifted(shift: Float[Array, "3"]) -> Bool[Array, "a d"]:
        """Return `is_in_target_room` for agents moved by `shift` [m]."""
        pose = snapshot.pose.replace(pos=snapshot.pose.pos + shift)
        return is_in_target_room(snapshot.replace(pose=pose), state.targets)

    deep = jnp.all(jax.vmap(shifted)(shifts), axis=0) | snapshot.in_contact[:, None]
    values = values.at[Feature.INSIDE].multiply(deep.astype(jnp.float32)[:, :, None])
    target = jnp.maximum(state.sound_events.emitter[0], 0).astype(jnp.int32)
    eyes, own = eye_position(snapshot.config, snapshot.pose), agent_ids(snapshot.bank, values.shape[1])
    box = looked.nearest_box[:, target]
    free = jax.vmap(is_unobstructed, (None, 0, 0, 0, 0))(
        snapshot.scene, eyes, box, box.mean(axis=1)[:, None] + shifts, own
    )
    shows = jnp.all(free, axis=-1)[:, None, None] | ~walks
    values = values.at[Feature.CLEAR].multiply(shows.astype(jnp.float32))
    return values.at[Feature.STRAIGHT].add(jnp.where(walks, MAX_TARGET_LAG, 0.0))


def should_wait(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the stage, not to FAILURE, needs only time and is not taken now; same for all."""
    return needs_only(state.program, state.stage, values, values.at[Feature.TIME].set(jnp.inf))


def should_stop(state: RowState, values: Float[Array, "feature a d d"]) -> Bool[Array, " a"]:
    """Return whether a transition of the stage, not to FAILURE, needs only `stop`, and none is taken now.

    It is the same for all agents.
    """
    return needs_only(state.program, state.stage, values, values.at[Feature.STOPPED].set(1.0))


def heading_to_target(
    snapshot: Snapshot, state: RowState, guide: Int[Array, ""], box: Float[Array, "a 2 3"]
) -> tuple[Float[Array, " a"], Bool[Array, " a"]]:
    """Return the heading of the shortest path to a descriptor's target [rad], and whether the path ends here.

    Each agent can walk straight along it, see `descend_field`. In a target room it walks straight on and never ends.
    The field of an object that was moved is outdated: agents head for its current position. `guide` is the index of the
    descriptor, `box` has the bounds of the nearest object that it selects [m].
    """
    moves, column = snapshot.config.discrete, jnp.maximum(state.program.field[guide], 0).astype(jnp.int32)
    least = moves.forward_step_size / 2 if moves and has_hands(snapshot) else 0.0  # a further step would overshoot
    is_room = (
        state.program.descriptor[guide, Attribute.KIND] == TargetKind.ROOM
    )  # any position beyond its threshold counts
    within = jnp.where(is_room, jnp.inf, 0.0)
    middle = box.mean(axis=1)
    begin = start_positions(snapshot, state.program, state.targets)
    away = displacements(snapshot, begin, state.targets.instance[guide], middle)
    apart = pick_distance(snapshot, middle)

    def ahead(agent: Int[Array, ""]) -> tuple[Float[Array, "2"], Bool[Array, ""]]:
        """Return one agent's waypoint (x, y) [m], and whether its path ends."""

        def far(places: Int[Array, "n 3"], cell: Int[Array, " n"]) -> Float[Array, " n"]:
            """Return distances to the target [m]: from its field, or to a circle around it if it was moved."""
            known = stored_distance(snapshot.tasks.field, cell, column)
            if not has_hands(snapshot):
                return known
            now = circle_distance(snapshot, places, middle[agent], apart[agent])
            return jnp.where(away[agent] > MAX_FIELD_DISPLACEMENT, now, known)

        return descend_field(snapshot, agent, far, least, within)

    aim, there = jax.vmap(ahead)(jnp.arange(snapshot.config.num_agents))
    aim = aim - snapshot.pose.pos[:, :2]
    inwards = there & is_room  # straight on, away from the threshold
    return jnp.where(inwards, snapshot.pose.yaw, jnp.arctan2(aim[:, 1], aim[:, 0])), there & ~is_room


def turn_towards(
    snapshot: Snapshot, aim: Float[Array, "a 2"], agents: Int[Array, " a"] | None = None
) -> Float[Array, " a"]:
    """Return the turns to the left [rad] after which agents face positions `aim` [m], from -pi to pi.

    `agents` are the indices of the agents, one per position; None: all.
    """
    pose = snapshot.pose
    pos, yaw = (pose.pos, pose.yaw) if agents is None else (pose.pos[agents], pose.yaw[agents])
    way = aim - pos[:, :2]
    return wrap_angle(jnp.arctan2(way[:, 1], way[:, 0]) - yaw)


def to_actions(
    config: EnvConfig,
    error: Float[Array, " a"],
    tilt: Float[Array, " a"],
    hold: Bool[Array, " a"],
    stop: Bool[Array, " a"],
    looks_first: bool = False,
) -> Array:
    """Return actions that turn left by `error`, tilt up by `tilt` [rad] and, unless `hold` or `stop`, walk forward.

    A discrete action is the first that is needed: `stop`, a turn, a look (only with `hold`), or `move_forward`. Turns
    and looks of less than half a step are not needed. With `hold` but nothing to turn or look at, it is `move_forward`.
    With `looks_first` looks come before turns, also without `hold`. Continuous actions do not move with `stop`.
    """
    if config.discrete is None:
        return _continuous(config, error, tilt, hold, stop)
    return _discrete(config, error, tilt, hold, stop, looks_first)


def _continuous(config: EnvConfig, error: Array, tilt: Array, near: Array, stop: Array) -> Float[Array, "a n"]:
    """Return continuous actions as `to_actions` describes.

    Forward speed falls with the heading error, and is 0 above `MAX_WALK_HEADING_ERROR`.
    """
    dt = config.timing.ctrl_dt
    rates = jnp.array([body.turn_rate for body in config.agents], jnp.float32)
    forward = jnp.where(jnp.abs(error) < MAX_WALK_HEADING_ERROR, jnp.cos(error), 0.0)
    forward = jnp.where(near | stop, 0.0, forward)
    turn, look = jnp.clip(error / (rates * dt), -1, 1), jnp.clip(tilt / (config.max_pitch_rate * dt), -1, 1)
    actions = jnp.zeros((error.shape[0], len(action_names(config))), jnp.float32)
    return actions.at[:, 0].set(forward).at[:, 2].set(turn).at[:, 3].set(look)


def _look_or_forward(moves: DiscreteActions, names: tuple[str, ...], tilt: Array) -> Array | int:
    """Return the look that brings a pitch error `tilt` [rad] closer to 0; `move_forward` if none does."""
    forward = names.index("move_forward")
    if moves.tilt_angle is None:
        return forward
    look = jnp.where(tilt > 0, names.index("look_up"), names.index("look_down"))
    return jnp.where(jnp.abs(tilt) > math.radians(moves.tilt_angle) / 2, look, forward)


def _discrete(
    config: EnvConfig, error: Array, tilt: Array, near: Array, stop: Array, looks_first: bool
) -> Int[Array, " a"]:
    """Return indices of discrete actions as `to_actions` describes; turns below half a step are skipped."""
    moves, names = config.discrete, action_names(config)
    assert moves is not None
    half = math.radians(moves.turn_angle) / 2
    turn = jnp.where(error > 0, names.index("turn_left"), names.index("turn_right"))
    there = _look_or_forward(moves, names, tilt)
    ahead = jnp.where(near, there, names.index("move_forward"))
    chosen = jnp.where(jnp.abs(error) > half + 1e-3, turn, ahead)
    if looks_first:
        chosen = jnp.where(~near & (there != names.index("move_forward")), there, chosen)
    return jnp.where(stop, names.index("stop"), chosen).astype(jnp.int32)
