"""Decoding of hand actions: the target of a command is the object or surface at the view centre."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.physics.hand_control import HandCommands
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import face_normals, object_ids
from home_mjx.raycast_render.scene.types import Hit
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import AgentPose, Snapshot
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.reachability import check_placement, obstacle_footprints, plan_radius

MIN_COMMAND = 0.5  # absolute value above which an action element counts as a command
MIN_PLACE_GAP = 0.01  # [m], minimum gap between an object that is put down and its neighbours
NUM_AIM_ANGLES = 9  # number per direction, with an `max_aim_angle`
MIN_SURFACE_NORMAL_Z = 0.7  # minimum z component of the normal of a surface on which objects can be placed


def decode_hand_commands(config: EnvConfig, snapshot: Snapshot, action: Float[Array, "a 3"]) -> HandCommands:
    """Return hand commands of all agents: indices -1, place inf and throw 0 if there is none.

    Reach, mass and room only rank the targets of several rays. A target that fails them is commanded all the same if
    there is no better one, and `apply_hand_commands` ignores it if it is out of reach or too heavy.

    Args:
        config: Options.
        snapshot: The environment.
        action: `pick` above 0.5 grasps the body at the view centre, or places the held object on the surface there;
            below -0.5 it drops it. `throw` above 0.5 throws along the view direction. `turn` above 0.5 opens the door
            at the view centre, below -0.5 closes it. With a `max_aim_angle` the nearest usable target counts: a body
            that can be lifted, a spot with room for the held object, or a door.
    """
    bank, house = snapshot.bank, snapshot.house
    eyes, (pick, throw, turn) = eye_position(config, snapshot.pose), action.T
    view = aim_directions(config, snapshot.pose)
    hit = cast_past_hand(config, snapshot, eyes, view)
    fixed = (hit.instance >= 0) & (hit.instance < bank.spec.num_instances)  # not an agent
    body = jnp.where(fixed, bank.geometry.instance_body[house, jnp.where(fixed, hit.instance, 0)], -1)
    point = eyes[:, None] + view * hit.t[..., None]
    near, holds = is_in_reach(config, snapshot, point), snapshot.held >= 0
    level = fixed & (face_normals(snapshot.scene, view, hit)[..., 2] > MIN_SURFACE_NORMAL_Z)
    puts = (pick > MIN_COMMAND) & holds & jnp.any(level, axis=-1)
    door = door_indices(snapshot, hit)
    taken = _pick_target(body, body >= 0, near & _is_liftable(config, snapshot, body))
    return HandCommands(
        pick=jnp.where((pick > MIN_COMMAND) & ~holds, taken, -1),
        place=jnp.where(puts[:, None], _pick_target(point, level, near & _has_room(snapshot, point)), jnp.inf),
        drop=pick < -MIN_COMMAND,
        throw=jnp.where((throw > MIN_COMMAND)[:, None], view[:, 0], 0.0),
        door=jnp.where(jnp.abs(turn) > MIN_COMMAND, _pick_target(door, door >= 0, near), -1),
        open=turn > 0,
    )


def aim_directions(config: EnvConfig, pose: AgentPose) -> Float[Array, "a n 3"]:
    """Return unit directions of hands in the world frame: view centre first, then by angle from it.

    n is 1, or `NUM_AIM_ANGLES` squared with a `max_aim_angle`, which turns and tilts reach at most. Of equal angles the
    lower and then the right one is first.
    """
    angle = math.radians(config.max_aim_angle)
    offsets = np.linspace(-angle, angle, NUM_AIM_ANGLES) if angle else np.zeros(1)
    turn, tilt = (x.reshape(-1) for x in np.meshgrid(offsets, offsets))
    order = np.argsort(np.hypot(turn, tilt), kind="stable")
    yaw = pose.yaw[:, None] + jnp.asarray(turn[order], jnp.float32)
    pitch = pose.pitch[:, None] + jnp.asarray(tilt[order], jnp.float32)
    level = jnp.cos(pitch)
    return jnp.stack([jnp.cos(yaw) * level, jnp.sin(yaw) * level, jnp.sin(pitch)], axis=-1)


def is_in_reach(config: EnvConfig, snapshot: Snapshot, point: Float[Array, "a n 3"]) -> Bool[Array, "a n"]:
    """Return which world points [m] are within each agent's reach of its body's axis, from feet to top, inclusive."""
    half, reach = jnp.array([(body.height / 2, body.reach) for body in config.agents], jnp.float32).T
    offset = point - snapshot.pose.pos[:, None]
    beyond = jnp.maximum(jnp.abs(offset[..., 2]) - half[:, None], 0.0)
    return jnp.linalg.norm(offset.at[..., 2].set(beyond), axis=-1) <= reach[:, None]


def _is_liftable(config: EnvConfig, snapshot: Snapshot, body: Int[Array, "a n"]) -> Bool[Array, "a n"]:
    """Return which bodies (indices) have at most the mass that each agent's hand lifts; -1: undefined result."""
    if not snapshot.bank.spec.num_bodies:
        return body >= 0
    lift = jnp.array([body.max_lift_mass for body in config.agents], jnp.float32)
    mass, bodies = snapshot.bank.physics.body_mass[snapshot.house, jnp.maximum(body, 0)], snapshot.body_scale
    mass = mass if bodies is None or bodies.mass is None else mass * bodies.mass
    return mass <= lift[:, None]


def _has_room(snapshot: Snapshot, point: Float[Array, "a n 3"]) -> Bool[Array, "a n"]:
    """Return at which points [m] each agent's held object would be supported and clear of others.

    It is False at points that are not finite. All are True with exact aim (n is 1), and in banks without movable
    bodies. Results of agents with empty hands have no meaning.
    """
    bank, house, held = snapshot.bank, snapshot.house, jnp.maximum(snapshot.held, 0)
    if not bank.spec.num_bodies or point.shape[1] == 1:
        return jnp.ones(point.shape[:2], bool)
    physics = bank.physics
    radius = jax.vmap(plan_radius)(physics.body_size[house, held], physics.body_quat[house, held])

    def one(point: Array, radius: Array, carried: Array) -> Array:
        """Return the mask of one agent's points."""
        bears, apart = check_placement(
            obstacle_footprints(snapshot.scene, carried), point[:, :2], point[:, 2], radius + MIN_PLACE_GAP
        )
        return bears & apart

    return jax.vmap(one)(jnp.where(jnp.isfinite(point), point, jnp.float32(1e6)), radius, held_object_ids(snapshot))


def door_indices(snapshot: Snapshot, hit: Hit) -> Int[Array, "a n"]:
    """Return the index of the door leaf that each ray of each agent hits; -1 none."""
    physics, house = snapshot.bank.physics, snapshot.house
    leaf = physics.door_valid[house] & (physics.door_instance[house] == hit.instance[..., None])
    number = jnp.where(leaf, jnp.arange(leaf.shape[-1], dtype=jnp.int32), -1)
    return jnp.max(number, axis=-1, initial=-1)  # for houses without doors


def _pick_target(values: Array, fits: Bool[Array, "a n"], good: Bool[Array, "a n"]) -> Array:
    """Return per agent the value of the first column that fits and is good, else that fits, else the first column."""
    count = fits.shape[1]
    cost = jnp.where(fits & good, 0, jnp.where(fits, count, 2 * count)) + jnp.arange(count)
    return values[jnp.arange(fits.shape[0]), jnp.argmin(cost, axis=-1)]


def cast_past_hand(
    config: EnvConfig, snapshot: Snapshot, eyes: Float[Array, "a 3"], view: Float[Array, "a n 3"]
) -> Hit:
    """Cast rays from each agent's eyes along `view`; its own body and the object that it carries are not hit."""
    own, carried = agent_ids(snapshot.bank, config.num_agents)[:, None], held_object_ids(snapshot)[:, None]
    own, carried = (jnp.broadcast_to(x, view.shape[:2]) for x in (own, carried))
    origin = jnp.broadcast_to(eyes[:, None], view.shape)
    hit = cast(snapshot.scene, origin, view, exclude=own)
    covers = (carried >= 0) & (object_ids(snapshot.scene, hit) == carried)
    past = cast(snapshot.scene, origin, view, t_min=jnp.where(covers, hit.t, 0.0), exclude=carried)
    return jax.tree.map(lambda a, b: jnp.where(covers, a, b), past, hit)


def held_object_ids(snapshot: Snapshot) -> Int[Array, " a"]:
    """Return the object id of the body that each agent holds; -1 none."""
    bank, house, body = snapshot.bank, snapshot.house, jnp.maximum(snapshot.held, 0)
    if not bank.spec.num_bodies:
        return snapshot.held
    ids = bank.geometry.instance_object[house, jnp.maximum(bank.physics.body_instance[house, body], 0)]
    return jnp.where(snapshot.held >= 0, ids, -1)
