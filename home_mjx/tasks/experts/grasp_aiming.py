"""Grasp aiming of experts: at an object, to pick it up, or at a free spot, to put an object there."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import TOGGLE
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.env.hand_actions import cast_past_hand, held_object_ids, is_in_reach
from home_mjx.tasks.experts.front_plans import plan_front
from home_mjx.tasks.experts.hand_rays import nearest_hand_rays, round_to_steps, view_angles
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.program import leads_on
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.sensors.cameras import eye_position
from home_mjx.tasks.sensors.front_reach import front_box
from home_mjx.tasks.sensors.reachability import MIN_VISIBLE_POINTS, RAY_TOLERANCE, free_spots, pick_points, plan_radius

MAX_AIM_ERROR = 0.04  # [rad], maximum angle from the view centre at which hands reach their target
STEPS_PER_AIM = 24  # [steps] with one choice of aim point
RETREAT_PERIOD = 96  # [steps]; in its last `STEPS_PER_AIM` steps an agent moves away, because its attempts have failed
AIM_VARIATION = 0.3  # [rad], amplitude of the variation of aim points between attempts
GOLDEN_ANGLE = 2.4  # [rad], angle between successive directions of moving away


class GraspPlan(Pytree):
    """Command and aim of each agent's hand."""

    pick: Bool[Array, " a"]  # pick up the object that the guide selects
    place: Bool[Array, " a"]  # put the held object on the one that the guide selects
    drop: Bool[Array, " a"]  # drop an object that the guide does not select
    open: Bool[Array, " a"]  # open a front: of the guide, or of what is around the object that it selects
    toggle: Float[Array, " a"]  # 1: switch the object that the guide selects on, -1: off, 0: neither
    can_aim: Bool[Array, " a"]  # the target can be aimed at from here
    turn: Float[Array, " a"]  # [rad], to the left, until the target is at the view centre
    tilt: Float[Array, " a"]  # [rad], up


def plan_grasp(
    snapshot: Snapshot, state: RowState, values: Float[Array, "feature a d d"], box: Float[Array, "a 2 3"]
) -> GraspPlan:
    """Return hand commands for the current stage, and the aim for them; the stage's guide is its target descriptor.

    `values` are those of `FeatureValues`; `box` has the bounds of the nearest object that the guide selects [m].
    """
    guide = jnp.maximum(state.program.guide[jnp.maximum(state.stage, 0)], 0)
    take, put = _pending_commands(state, values, guide)
    toggle = _pending_toggle(snapshot, state, values, guide)
    holds = snapshot.held >= 0
    spread = math.radians(snapshot.config.max_aim_angle)
    helped = MAX_AIM_ERROR + 0.5 * spread
    tried = (snapshot.step - state.stage_start) // STEPS_PER_AIM
    turn, tilt, ready = _best_aim(
        snapshot, *_pick_candidates(snapshot, state.targets.instance[guide], box, spread), tried, helped
    )
    for_put = _best_aim(snapshot, *_place_candidates(snapshot, state, guide, box), tried, helped)
    puts = put & holds
    turn, tilt, ready = (jnp.where(puts, b, a) for a, b in zip((turn, tilt, ready), for_put, strict=True))
    leaf, opens = plan_front(snapshot, state, values, guide, take & ~holds)
    if not snapshot.bank.fronts.is_empty:
        for_front = _best_aim(snapshot, *_front_candidates(snapshot, leaf), tried, MAX_AIM_ERROR)
        turn, tilt, ready = (jnp.where(opens, b, a) for a, b in zip((turn, tilt, ready), for_front, strict=True))
    return GraspPlan(
        pick=take & ~holds & ~opens,
        place=puts & ~opens,
        drop=take & holds,
        open=opens,
        toggle=toggle,
        can_aim=ready,
        turn=turn,
        tilt=tilt,
    )


def plan_retreat(
    snapshot: Snapshot, state: RowState, dropped: Bool[Array, " a"]
) -> tuple[Bool[Array, " a"], Int[Array, " a"], Float[Array, " a"]]:
    """Return which agents should move away as their stage has lasted long: the last steps of each `RETREAT_PERIOD`.

    Args:
        snapshot: The environment.
        state: State of its row task.
        dropped: True if the object that an agent targets has been held before; the time of the whole episode counts
            then, because its stages restart again and again.

    Returns:
        Whether to move away; number of completed periods; direction to move in [rad].
    """
    time = jnp.where(dropped, snapshot.step, snapshot.step - state.stage_start)
    before = time // RETREAT_PERIOD
    return (
        time % RETREAT_PERIOD >= RETREAT_PERIOD - STEPS_PER_AIM,
        before,
        (before + 1).astype(jnp.float32) * jnp.float32(GOLDEN_ANGLE),
    )


def add_hand_commands(config: EnvConfig, actions: Array, grip: GraspPlan, aims: Bool[Array, " a"]) -> Array:
    """Return actions with hand commands: these replace discrete moves, or set the elements `pick` and `toggle`.

    `actions` have moves and looks. All but drops apply only where `aims`, in place with the target at the view
    centre.
    """
    names, picks, toggles = action_names(config), (grip.pick | grip.place) & aims, (grip.toggle != 0) & aims
    if config.discrete is not None:
        actions = jnp.where(picks, names.index("pick"), actions)
        actions = jnp.where(toggles, names.index(TOGGLE), actions) if config.can_toggle else actions
        return jnp.where(grip.drop, names.index("drop"), actions).astype(jnp.int32)
    if config.can_toggle:
        actions = actions.at[:, names.index(TOGGLE)].set(jnp.where(toggles, grip.toggle, 0.0))
    pick = jnp.where(grip.drop, -1.0, jnp.where(picks, 1.0, 0.0))
    return actions.at[:, names.index("pick")].set(pick)


def add_door_commands(config: EnvConfig, actions: Array, opens: Bool[Array, " a"]) -> Array:
    """Return actions that open the door in view where `opens`; other agents' actions stay, but turn no door."""
    names = action_names(config)
    if config.discrete is not None:
        return jnp.where(opens, names.index("open"), actions).astype(jnp.int32)
    return actions.at[:, names.index("turn_door")].set(jnp.where(opens, 1.0, 0.0))


def is_aimed(config: EnvConfig, grip: GraspPlan) -> Bool[Array, " a"]:
    """Return whether the view centre is as close to the hand's target as actions can bring it.

    That is within half a discrete turn and half a look, 2 mrad more each; else both angles are below `MAX_AIM_ERROR` /
    2.
    """
    if config.discrete is None:
        return jnp.maximum(jnp.abs(grip.turn), jnp.abs(grip.tilt)) < jnp.float32(MAX_AIM_ERROR / 2)
    half, step = (math.radians(x) / 2 + 2e-3 for x in (config.discrete.turn_angle, config.discrete.tilt_angle or 0))
    return (jnp.abs(grip.turn) < half) & (jnp.abs(grip.tilt) < step)


def _pending_commands(
    state: RowState, values: Float[Array, "feature a d d"], guide: Int[Array, ""]
) -> tuple[Bool[Array, " a"], Bool[Array, " a"]]:
    """Return whether the stage needs a target of descriptor `guide` picked up, and whether the held object put down.

    Found by trying: a transition that is not to FAILURE would be taken if it were. Never both; both False if a
    transition is possible now.
    """
    held = values[Feature.HELD, :, guide, 0] > 0
    done = values.at[Feature.STOPPED].set(1.0)
    down = done.at[Feature.ON].set(1.0).at[Feature.HELD].set(0.0)
    agents, picked = values.shape[1:2], values.at[Feature.HELD, :, guide].set(1.0)
    now, with_pick, if_done, if_down = (
        leads_on(state.program, state.stage, table)[0] for table in (values, picked, done, down)
    )
    take = ~now & with_pick & ~held
    put = ~now & ~if_done & if_down
    return jnp.broadcast_to(take, agents), jnp.broadcast_to(put & ~take, agents)


def _pending_toggle(
    snapshot: Snapshot, state: RowState, values: Float[Array, "feature a d d"], guide: Int[Array, ""]
) -> Float[Array, " a"]:
    """Return 1 if the stage needs a target of descriptor `guide` switched on, -1 off, 0 neither; found by trying.

    Neither, if a transition that is not to FAILURE is possible now or with `stop`.
    """
    if snapshot.switch_on is None:
        return jnp.zeros(values.shape[1], jnp.float32)
    now = values[Feature.SWITCHED_ON, :, guide, 0]
    changed = values.at[Feature.SWITCHED_ON, :, guide].set(1 - now[:, None])
    done = values.at[Feature.STOPPED].set(1.0)
    at_once, if_done, if_changed = (leads_on(state.program, state.stage, x)[0] for x in (values, done, changed))
    return jnp.where(~at_once & ~if_done & if_changed, 1 - 2 * now, 0.0)


def _pick_candidates(
    snapshot: Snapshot, meant: Bool[Array, " i"], box: Float[Array, "a 2 3"], spread: float
) -> tuple[Float[Array, "a p 3"], Bool[Array, "a p"]]:
    """Return points at which to grasp an object [m], and which are visible and in reach.

    The mask is all False with fewer than `MIN_VISIBLE_POINTS` of these. In banks with compartments, the points are
    those that `nearest_hand_rays` meet, and one is enough: little of an object in furniture may be visible, and between
    these rays a hand may meet another front than the one that is meant.

    Args:
        snapshot: The environment.
        meant: Instances of the object.
        box: Bounds of the object that each agent targets [m].
        spread: See `nearest_hand_rays` [rad].
    """
    config, eyes = snapshot.config, eye_position(snapshot.config, snapshot.pose)
    points = jax.vmap(pick_points)(eyes, jnp.where(jnp.isfinite(box), box, 0.0))
    way = points - eyes[:, None]
    way, least = way / jnp.linalg.norm(way, axis=-1, keepdims=True), MIN_VISIBLE_POINTS
    if not snapshot.bank.compartments.is_empty:
        way, least = nearest_hand_rays(config, snapshot.pose, points, spread), 1
    hit = cast_past_hand(config, snapshot, eyes, way)
    own = (hit.instance >= 0) & (hit.instance < meant.shape[0])
    own = own & meant[jnp.clip(hit.instance, 0, meant.shape[0] - 1)]
    seen = jnp.where(own[..., None], eyes[:, None] + way * jnp.where(own, hit.t, 0.0)[..., None], points)
    fits = own & is_in_reach(config, snapshot, seen)
    return seen, fits & (jnp.sum(fits, axis=-1, keepdims=True) >= least)


def _front_candidates(snapshot: Snapshot, leaf: Int[Array, ""]) -> tuple[Float[Array, "a p 3"], Bool[Array, "a p"]]:
    """Return points at which to open a front (a row of the doors) [m], and which are visible and in reach."""
    physics, house = snapshot.bank.physics, snapshot.house
    leaves = jax.tree.map(lambda x: x[house], DoorLeaves.from_physics(physics))
    box = front_box(leaves, leaf, snapshot.door_angle[leaf])
    meant = jnp.arange(snapshot.bank.spec.num_instances) == physics.door_instance[house, leaf]
    return _pick_candidates(snapshot, meant, jnp.broadcast_to(box, (snapshot.pose.yaw.shape[0], 2, 3)), 0.0)


def _place_candidates(
    snapshot: Snapshot, state: RowState, guide: Int[Array, ""], box: Float[Array, "a 2 3"]
) -> tuple[Float[Array, "a p 3"], Bool[Array, "a p"]]:
    """Return spots for the held body on the guide's nearest object [m]; whether each is free, visible and in reach.

    `box` has that object's bounds [m].
    """
    config, bank, house = snapshot.config, snapshot.bank, snapshot.house
    eyes, carried = eye_position(config, snapshot.pose), held_object_ids(snapshot)
    body, physics = jnp.maximum(snapshot.held, 0), bank.physics
    radius = jax.vmap(plan_radius)(physics.body_size[house, body], physics.body_quat[house, body])

    def one(box: Array, radius: Array, carried: Array) -> tuple[Array, Array]:
        """Return the spots of one agent."""
        return free_spots(snapshot.scene, box, state.targets.instance[guide], radius, carried)

    points, free = jax.vmap(one)(jnp.where(jnp.isfinite(box), box, 0.0), radius, carried)
    way = points - eyes[:, None]
    length = jnp.linalg.norm(way, axis=-1)
    hit = cast_past_hand(config, snapshot, eyes, way / length[..., None])
    return points, free & (hit.t >= length - RAY_TOLERANCE) & is_in_reach(config, snapshot, points)


def _best_aim(
    snapshot: Snapshot, points: Float[Array, "a p 3"], fits: Bool[Array, "a p"], tried: Int[Array, ""], most: float
) -> tuple[Float[Array, " a"], Float[Array, " a"], Bool[Array, " a"]]:
    """Return turn and tilt to the best aim point [rad], and whether a usable point has at most the error `most` [rad].

    `fits` marks usable points; without any, the aim is at another one. `tried`, the number of attempts before, varies
    the choice. Discrete actions turn and tilt by whole steps: usable points with a small remaining error are preferred.
    """
    config, pose = snapshot.config, snapshot.pose
    away = jnp.linalg.norm((points - eye_position(config, pose)[:, None])[..., :2], axis=-1)
    turn, tilt = view_angles(config, pose, points)
    done = round_to_steps(config, turn, tilt, pose.pitch)
    miss = jnp.hypot(turn - done[0], tilt - done[1])
    number = jnp.arange(points.shape[1], dtype=jnp.float32)
    varied = jnp.sin(number * tried.astype(jnp.float32))
    cost = miss + jnp.float32(AIM_VARIATION) * varied + 0.01 * jnp.abs(turn) + 0.03 * away
    near_enough = miss <= jnp.float32(most)
    rank = jnp.where(fits & near_enough, 0.0, jnp.where(fits, 10.0, 20.0))
    best = jnp.argmin(cost + rank, axis=-1)
    agents = jnp.arange(points.shape[0])
    return done[0][agents, best], done[1][agents, best], jnp.any(fits & near_enough, axis=-1)
