"""Where what an agent carries would meet something."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.physics.hands import CARRY
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.handling import carried_ids
from home_mjx.tasks.env.moves import action_names
from home_mjx.tasks.sensors.cameras import eye_position
from home_mjx.tasks.sensors.reaching import STEEPEST, footprints, plan_gaps, plan_radius

PARTS = 8  # of a turn that are looked at
BOUND = 0.4  # [rad]: who has turned too far by less than that turns back
MOVED = 0.5  # [m], from where it stood: there a field still leads to a thing
DROPPED = 0.05  # [m]: what is farther from where it stood has been in a hand
NEAREST, FARTHEST = 0.4, 0.9  # [m], at which agents stand from what they take
AROUND = 0.05  # [m], between what is carried and what stands beside the way


def has_hands(snapshot: Snapshot) -> bool:
    """Whether agents have hands and houses have things for them."""
    return snapshot.config.hands and snapshot.bank.spec.num_bodies > 0


def moved_by(snapshot: Snapshot, meant: Bool[Array, " i"], middle: Float[Array, "a 3"]) -> Float[Array, " a"]:
    """How far things are from where one that is meant stood when the house was made [m]; 0 of what never moves.

    Args:
        snapshot: The environment.
        meant: Which instances are meant.
        middle: Of the thing that each agent is after [m].
    """
    if not has_hands(snapshot):
        return jnp.zeros(middle.shape[0], jnp.float32)
    physics, house = snapshot.bank.physics, snapshot.house
    instance = physics.body_instance[house]
    counts = (instance >= 0) & meant[jnp.clip(instance, 0, meant.shape[0] - 1)]
    away = jnp.linalg.norm(middle[:, None] - physics.body_pos[house][None], axis=-1)
    return jnp.where(jnp.any(counts), jnp.min(jnp.where(counts[None], away, jnp.inf), axis=1), 0.0)


def at_hand(snapshot: Snapshot, middle: Float[Array, "a 3"]) -> Float[Array, " a"]:
    """How far away from a thing agents stand to take it [m]: what is low they look down at from farther away.

    Args:
        snapshot: The environment.
        middle: Of the thing that each agent is after [m].
    """
    below = eye_position(snapshot.config, snapshot.pose)[:, 2] - middle[:, 2]
    return jnp.clip(below / jnp.tan(jnp.float32(STEEPEST)) + jnp.float32(AROUND), NEAREST, FARTHEST)


def carried_radius(snapshot: Snapshot, agent: Int[Array, ""]) -> Float[Array, ""]:
    """How far what an agent carries reaches from its own middle in the plan [m]; 0: it carries nothing."""
    body, physics = jnp.maximum(snapshot.held[agent], 0), snapshot.bank.physics
    radius = plan_radius(physics.body_size[snapshot.house, body], physics.body_quat[snapshot.house, body])
    return jnp.where(snapshot.held[agent] >= 0, radius + jnp.float32(AROUND), 0.0)


def carried_discs(snapshot: Snapshot, yaw: Float[Array, " a"]) -> tuple[Float[Array, "a 2"], Float[Array, " a"]]:
    """Where what agents carry would be in the plan if they looked there, and how far it reaches [m].

    Args:
        snapshot: The environment; agents have hands.
        yaw: Where each agent looks [rad].

    Returns:
        Middles and radii; the agents' own where they carry nothing.
    """
    radius = jax.vmap(lambda agent: carried_radius(snapshot, agent))(jnp.arange(snapshot.config.num_agents))
    own = jnp.array([body.radius for body in snapshot.config.physics.agents], jnp.float32)
    holds = snapshot.held >= 0
    ahead = jnp.where(holds, own + jnp.float32(CARRY) + radius, 0.0)
    way = jnp.stack([jnp.cos(yaw), jnp.sin(yaw)], axis=-1)
    return snapshot.pose.pos[:, :2] + way * ahead[:, None], jnp.where(holds, radius, own)


def meets(snapshot: Snapshot, agent: Int[Array, ""], place: Float[Array, "n 3"]) -> Bool[Array, " n"]:
    """Whether what an agent carries before it, as high as now, would come near anything on its way through some places.

    Args:
        snapshot: The environment; agents have hands.
        agent: Number of the agent.
        place: The places [m].
    """
    held, radius = snapshot.held[agent], carried_radius(snapshot, agent)
    body = jnp.maximum(held, 0)
    boxes = footprints(snapshot.scene, carried_ids(snapshot)[agent])
    low, high = snapshot.scene.moving.box[body, :, 2]
    met = (plan_gaps(boxes, place[:, :2]) < radius) & (boxes.top > low) & (boxes.bottom < high)
    return (held >= 0) & jnp.any(met, axis=1)


def clear_turns(snapshot: Snapshot, turn: Float[Array, " a"]) -> Float[Array, " a"]:
    """The same turns [rad], but the other way round where only that keeps what agents carry off what stands around.

    Args:
        snapshot: The environment; agents have hands.
        turn: Of each agent, to the left [rad]; less than a half one.
    """
    radius = jnp.array([body.radius for body in snapshot.config.physics.agents], jnp.float32)
    part = jnp.linspace(0.0, 1.0, PARTS + 1, dtype=jnp.float32)[1:]

    def meets_any(agent: Int[Array, ""], turn: Float[Array, ""]) -> Bool[Array, ""]:
        yaw = snapshot.pose.yaw[agent] + part * turn
        ahead = radius[agent] + jnp.float32(CARRY) + carried_radius(snapshot, agent)
        way = jnp.stack([jnp.cos(yaw), jnp.sin(yaw), jnp.zeros_like(yaw)], axis=-1) * ahead
        return jnp.any(meets(snapshot, agent, snapshot.pose.pos[agent] + way))

    agents = jnp.arange(turn.shape[0])
    short, long = (jax.vmap(meets_any)(agents, way) for way in (turn, other_way(turn)))
    return way_round(turn, short & ~long, jnp.where(snapshot.held >= 0, _turning(snapshot), 0.0))


def other_way(turn: Float[Array, " a"]) -> Float[Array, " a"]:
    """Turns that end alike, the other way round [rad]."""
    return turn - jnp.sign(turn) * jnp.float32(2 * math.pi)


def way_round(turn: Float[Array, " a"], blocked: Bool[Array, " a"], turning: Float[Array, " a"]) -> Float[Array, " a"]:
    """Turns [rad], the other way round where this one is blocked; but who has begun with one goes on with it.

    A step farther the other way round may look better, and from there this one again.

    Args:
        turn: The shorter way round, to the left [rad].
        blocked: Whether the other one is better.
        turning: Which way round each agent turns: 1 to the left, -1 to the right, 0 neither.
    """
    back = (turning * turn < 0) & (jnp.abs(turn) > jnp.float32(BOUND))
    return jnp.where(jnp.where(turning == 0, blocked, back), other_way(turn), turn)


def _turning(snapshot: Snapshot) -> Float[Array, " a"]:
    """Which way round agents have turned in the last step: 1 to the left, -1 to the right, 0 neither."""
    names, action = action_names(snapshot.config), snapshot.action
    if snapshot.config.discrete is None:
        return jnp.round(action[:, names.index("turn_left")])
    return action[:, names.index("turn_left")] - action[:, names.index("turn_right")]
