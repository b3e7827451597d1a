"""What agents know of themselves."""

import math

import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs

FARTHEST = 1000.0  # [m]: no house is larger
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
