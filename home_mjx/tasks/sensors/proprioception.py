"""Sensors of an agent's own state: pose, held object, last action and reward."""

import math

import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs

MAX_COORDINATE = 1000.0  # [m], bound of positions; larger than any house
HELD_COLUMNS = (Semantic.FINE, Semantic.COARSE, Semantic.COLOR, Semantic.MATERIAL, Semantic.SIZE)
MAX_VELOCITY = 100.0  # [m/s, rad/s], bound of velocities; far above those of motors and falls


class OwnState(Sensor):
    """`state` (10,): position, heading, velocity and contact of every agent.

    x, y, z [m]; cosine and sine of yaw; pitch [rad]; forward and left speed [m/s]; yaw rate [rad/s]; 1 while touching
    anything but the floor.
    """

    name = "state"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `state`: ten numbers."""
        high = (*[MAX_COORDINATE] * 3, 1.0, 1.0, math.pi / 2, *[MAX_VELOCITY] * 3, 1.0)
        low = (*[-x for x in high[:-1]], 0.0)
        text = "x, y, z [m], cos and sin of yaw, pitch [rad], forward and left speed [m/s], yaw rate [rad/s], contact"
        return {"state": ArraySpec((10,), "float32", low, high, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `state` (a, 10): position, cosine and sine of yaw, pitch, velocity (3), contact flag; see `spec`."""
        pose = snapshot.pose
        angles = jnp.stack([jnp.cos(pose.yaw), jnp.sin(pose.yaw), pose.pitch], axis=-1)
        contact = snapshot.in_contact.astype(jnp.float32)[:, None]
        return {"state": jnp.concatenate([pose.pos, angles, snapshot.velocity, contact], axis=-1)}


class HeldObject(Sensor):
    """`held_object` (5,): fine and coarse category, colour, material and size of the held object; -1 nothing.

    The encoding is that of `goal_words` 1 to 5.
    """

    name = "held_object"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `held_object`: five indices."""
        text = "of the held object: fine, coarse, colour, material, size; -1 nothing, or unknown"
        return {"held_object": ArraySpec((len(HELD_COLUMNS),), "int32", -1, 32767, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `held_object`: columns `HELD_COLUMNS` of the semantics of the body in each hand; -1 if it is empty."""
        bank, house, held = snapshot.bank, snapshot.house, snapshot.held
        nothing = jnp.full((held.shape[0], len(HELD_COLUMNS)), -1, jnp.int32)
        if not bank.spec.num_bodies:
            return {"held_object": nothing}
        instance = bank.physics.body_instance[house, jnp.maximum(held, 0)]
        row = bank.geometry.instance_semantic[house, jnp.maximum(instance, 0)]
        words = bank.semantics[row][:, jnp.array(HELD_COLUMNS)].astype(jnp.int32)
        return {"held_object": jnp.where(held[:, None] >= 0, words, nothing)}


class PrevAction(Sensor):
    """`prev_action` (n,): the last action: its numbers, or one-hot for discrete actions; 0 at the start.

    The action is as decoded: clipped, and `stop` for agents that have stopped.
    """

    name = "prev_action"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `prev_action`: one number per action element, or per discrete action."""
        names = config.action_names
        low = -1.0 if config.discrete is None else 0.0
        return {"prev_action": ArraySpec((len(names),), "float32", low, 1.0, ", ".join(names))}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `prev_action` (a, n): the last action of each agent; 0 after a reset."""
        return {"prev_action": snapshot.action}


class PrevReward(Sensor):
    """`prev_reward` (1,): reward of the last step; 0 at the start."""

    name = "prev_reward"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `prev_reward`: one number."""
        return {"prev_reward": ArraySpec((1,), "float32", text="reward of the last step")}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `prev_reward` (a, 1): the last reward of each agent; 0 after a reset."""
        return {"prev_reward": snapshot.reward[:, None]}
