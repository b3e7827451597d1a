"""What agents know of themselves."""

import math

import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs

FARTHEST = 1000.0  # [m]: no house is larger
HELD_WORDS = (Semantic.FINE, Semantic.COARSE, Semantic.BASIC, Semantic.MATERIAL, Semantic.SIZE)
FASTEST = 100.0  # [m/s, rad/s]: far beyond what motors and falls give


class OwnState(Sensor):
    """`state` (10,): position, heading, speeds and contact of every agent.

    x, y, z [m]; cosine and sine of yaw; pitch [rad]; forward and left speed [m/s]; yaw rate [rad/s]; 1 while touching
    anything but the floor.
    """

    name = "state"

    def spec(self, config: EnvConfig) -> Specs:
        """Ten numbers."""
        high = (*[FARTHEST] * 3, 1.0, 1.0, math.pi / 2, *[FASTEST] * 3, 1.0)
        low = (*[-x for x in high[:-1]], 0.0)
        text = "x, y, z [m], cos and sin of yaw, pitch [rad], forward and left speed [m/s], yaw rate [rad/s], contact"
        return {"state": ArraySpec((10,), "float32", low, high, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Pose, velocity and contact flag."""
        pose = snapshot.pose
        angles = jnp.stack([jnp.cos(pose.yaw), jnp.sin(pose.yaw), pose.pitch], axis=-1)
        contact = snapshot.contact.astype(jnp.float32)[:, None]
        return {"state": jnp.concatenate([pose.pos, angles, snapshot.velocity, contact], axis=-1)}


class HeldObject(Sensor):
    """`held_object` (5,): fine and coarse category, colour, material and size of what the hand holds; -1 nothing.

    The numbers are those of `goal_words` 1 to 5.
    """

    name = "held_object"

    def spec(self, config: EnvConfig) -> Specs:
        """Five words."""
        text = "of what the hand holds: fine, coarse, colour, material, size; -1 nothing, or unknown"
        return {"held_object": ArraySpec((len(HELD_WORDS),), "int32", -1, 32767, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Columns of the semantic row of the body in each hand."""
        bank, house, held = snapshot.bank, snapshot.house, snapshot.held
        nothing = jnp.full((held.shape[0], len(HELD_WORDS)), -1, jnp.int32)
        if not bank.spec.num_bodies:
            return {"held_object": nothing}
        instance = bank.physics.body_instance[house, jnp.maximum(held, 0)]
        row = bank.geometry.instance_semantic[house, jnp.maximum(instance, 0)]
        words = bank.semantics[row][:, jnp.array(HELD_WORDS)].astype(jnp.int32)
        return {"held_object": jnp.where(held[:, None] >= 0, words, nothing)}


class PrevAction(Sensor):
    """`prev_action` (n,): what the agent did last: its numbers, or 1 at the discrete action chosen; 0 at the start.

    As it was understood: clipped, and `stop` for who has stopped.
    """

    name = "prev_action"

    def spec(self, config: EnvConfig) -> Specs:
        """As many numbers as the action has, or as there are discrete actions."""
        names = config.action_names
        low = -1.0 if config.discrete is None else 0.0
        return {"prev_action": ArraySpec((len(names),), "float32", low, 1.0, ", ".join(names))}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """What the environment keeps."""
        return {"prev_action": snapshot.action}


class PrevReward(Sensor):
    """`prev_reward` (1,): reward of the last step; 0 at the start."""

    name = "prev_reward"

    def spec(self, config: EnvConfig) -> Specs:
        """One number."""
        return {"prev_reward": ArraySpec((1,), "float32", text="reward of the last step")}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """What the environment keeps."""
        return {"prev_reward": snapshot.reward[:, None]}
