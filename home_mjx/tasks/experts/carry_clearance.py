"""Collision checks for objects that agents carry."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.physics.hand_control import CARRY_CLEARANCE
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.env.hand_actions import held_object_ids
from home_mjx.tasks.sensors.cameras import eye_position
from home_mjx.tasks.sensors.reachability import MAX_HAND_ANGLE, box_distances, obstacle_footprints, plan_radius

NUM_TURN_SAMPLES = 8  # samples of a turn that are checked for collisions
MAX_OVERSHOOT = 0.4  # [rad], maximum overshoot that is corrected by turning back
MAX_FIELD_DISPLACEMENT = 0.5  # [m], maximum displacement of an object whose initial position's field is still used
MIN_DROPPED_DISPLACEMENT = 0.05  # [m], minimum displacement of an object that has been held before
MIN_PICK_DISTANCE, MAX_PICK_DISTANCE = 0.4, 0.9  # [m], range of distances from which agents pick up objects
OBSTACLE_CLEARANCE = 0.05  # [m], clearance between a carried object and obstacles


def has_hands(snapshot: Snapshot) -> bool:
    """Return whether agents have hands and houses have movable bodies."""
    return snapshot.config.hands and snapshot.bank.spec.num_bodies > 0


def displacements(
    snapshot: Snapshot, start: Float[Array, "k 3"], selected: Bool[Array, " i"], middle: Float[Array, "a 3"]
) -> Float[Array, " a"]:
    """Return each object's distance from the nearest start of a selected movable instance [m]; 0 if none.

    It is also 0 without `has_hands`.

    Args:
        snapshot: The environment.
        start: Position of each movable body at the start, see `start_positions` [m].
        selected: Mask of instances.
        middle: Present centre of the object that each agent targets [m].
    """
    if not has_hands(snapshot):
        return jnp.zeros(middle.shape[0], jnp.float32)
    physics, house = snapshot.bank.physics, snapshot.house
    instance = physics.body_instance[house]
    counts = (instance >= 0) & selected[jnp.clip(instance, 0, selected.shape[0] - 1)]
    away = jnp.linalg.norm(middle[:, None] - start[None], axis=-1)
    return jnp.where(jnp.any(counts), jnp.min(jnp.where(counts[None], away, jnp.inf), axis=1), 0.0)


def pick_distance(snapshot: Snapshot, middle: Float[Array, "a 3"]) -> Float[Array, " a"]:
    """Return the distance in plan from which agents pick up objects centred at `middle` [m]: larger for lower ones.

    It is from `MIN_PICK_DISTANCE` to `MAX_PICK_DISTANCE`.
    """
    below = eye_position(snapshot.config, snapshot.pose)[:, 2] - middle[:, 2]
    return jnp.clip(
        below / jnp.tan(jnp.float32(MAX_HAND_ANGLE)) + jnp.float32(OBSTACLE_CLEARANCE),
        MIN_PICK_DISTANCE,
        MAX_PICK_DISTANCE,
    )


def carried_radius(snapshot: Snapshot, agent: Int[Array, ""]) -> Float[Array, ""]:
    """Return the plan radius of an agent's carried object plus `OBSTACLE_CLEARANCE` [m]; 0 if it carries nothing.

    Requires `has_hands`.
    """
    body, physics = jnp.maximum(snapshot.held[agent], 0), snapshot.bank.physics
    radius = plan_radius(physics.body_size[snapshot.house, body], physics.body_quat[snapshot.house, body])
    return jnp.where(snapshot.held[agent] >= 0, radius + jnp.float32(OBSTACLE_CLEARANCE), 0.0)


def carried_discs(snapshot: Snapshot, yaw: Float[Array, " a"]) -> tuple[Float[Array, "a 2"], Float[Array, " a"]]:
    """Return discs (centres, radii [m]) in plan that carried objects would cover at headings `yaw` [rad].

    Agents that carry nothing have their own disc. Requires `has_hands`.
    """
    radius = jax.vmap(lambda agent: carried_radius(snapshot, agent))(jnp.arange(snapshot.config.num_agents))
    own = jnp.array([body.radius for body in snapshot.config.agents], jnp.float32)
    holds = snapshot.held >= 0
    ahead = jnp.where(holds, own + jnp.float32(CARRY_CLEARANCE) + radius, 0.0)
    way = jnp.stack([jnp.cos(yaw), jnp.sin(yaw)], axis=-1)
    return snapshot.pose.pos[:, :2] + way * ahead[:, None], jnp.where(holds, radius, own)


def would_collide(snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    """Return at which positions an agent's carried object would be too close to obstacles; False if it carries none.

    Too close is less than `carried_radius` in plan from a box at the object's present height. Requires `has_hands`.

    Args:
        snapshot: The environment.
        agent: Index of the agent.
        place: Positions of the object's centre [m]; z is unused.
    """
    held, radius = snapshot.held[agent], carried_radius(snapshot, agent)
    body = jnp.maximum(held, 0)
    boxes = obstacle_footprints(snapshot.scene, held_object_ids(snapshot)[agent])
    low, high = snapshot.scene.moving.box[body, :, 2]
    met = (box_distances(boxes, place[:, :2]) < radius) & (boxes.top > low) & (boxes.bottom < high)
    return (held >= 0) & jnp.any(met, axis=1)


def choose_clear_turns(snapshot: Snapshot, turn: Float[Array, " a"]) -> Float[Array, " a"]:
    """Return `turn` [rad], replaced by the longer way round where only that keeps a carried object clear of obstacles.

    A turn of an agent that carries something keeps the direction in which it has begun. Turns are to the left, less
    than half a revolution. Requires `has_hands`.
    """
    radius = jnp.array([body.radius for body in snapshot.config.agents], jnp.float32)
    part = jnp.linspace(0.0, 1.0, NUM_TURN_SAMPLES + 1, dtype=jnp.float32)[1:]

    def meets_any(agent: Int[Array, ""], turn: Float[Array, ""]) -> Bool[Array, ""]:
        """Return whether any sample of an agent's turn would collide."""
        yaw = snapshot.pose.yaw[agent] + part * turn
        ahead = radius[agent] + jnp.float32(CARRY_CLEARANCE) + carried_radius(snapshot, agent)
        way = jnp.stack([jnp.cos(yaw), jnp.sin(yaw), jnp.zeros_like(yaw)], axis=-1) * ahead
        return jnp.any(would_collide(snapshot, agent, snapshot.pose.pos[agent] + way))

    agents = jnp.arange(turn.shape[0])
    short, long = (jax.vmap(meets_any)(agents, way) for way in (turn, reverse_turns(turn)))
    return resolve_turns(turn, short & ~long, jnp.where(snapshot.held >= 0, _turn_direction(snapshot), 0.0))


def reverse_turns(turn: Float[Array, " a"]) -> Float[Array, " a"]:
    """Return turns with the same final heading in the opposite direction [rad]; 0 stays 0."""
    return turn - jnp.sign(turn) * jnp.float32(2 * math.pi)


def resolve_turns(
    turn: Float[Array, " a"], blocked: Bool[Array, " a"], direction: Float[Array, " a"]
) -> Float[Array, " a"]:
    """Return `turn`, the shorter turn to the left [rad], reversed to the longer way round where it is `blocked`.

    A turn that has begun (`direction`: 1 left, -1 right, 0 none) goes on instead, except to correct an overshoot of at
    most `MAX_OVERSHOOT`: otherwise agents could oscillate.
    """
    back = (direction * turn < 0) & (jnp.abs(turn) > jnp.float32(MAX_OVERSHOOT))
    return jnp.where(jnp.where(direction == 0, blocked, back), reverse_turns(turn), turn)


def _turn_direction(snapshot: Snapshot) -> Float[Array, " a"]:
    """Return the direction of agents' turns in the last action: 1 to the left, -1 to the right, 0 neither.

    Continuous turns are rounded, so that those up to half the maximum rate count as neither.
    """
    names, action = action_names(snapshot.config), snapshot.action
    if snapshot.config.discrete is None:
        return jnp.round(action[:, names.index("turn_left")])
    return action[:, names.index("turn_left")] - action[:, names.index("turn_right")]
