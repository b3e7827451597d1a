"""Sensors of an agent's place: relative to its start, and to its surroundings."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.core.pytree import Pytree
from home_mjx.navigation.grid import cell_at_feet
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position

MAX_COORDINATE = 1000.0  # [m], bound of positions; larger than any house
NUM_RAYS = 64
MAP_SIZE, MAP_CELL = 32, 0.2  # [cells] per side of the map, and edge of a cell [m]


class GpsCompassState(Pytree):
    """State of `GpsCompass`: initial pose of each of A agents."""

    pos: Float[Array, "a 3"]  # [m]
    yaw: Float[Array, " a"]  # [rad]


class GpsCompass(Sensor):
    """`gps` (3,) and `compass` (2,): pose in the frame of the agent's start, as in Habitat.

    x, y, z [m] forward, left and up from the start; cosine and sine of the turn to the left since then.
    """

    name = "gps_compass"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the specs of `gps` and `compass` by name."""
        return {
            "gps": ArraySpec((3,), "float32", -MAX_COORDINATE, MAX_COORDINATE, "forward, left and up of the start [m]"),
            "compass": ArraySpec((2,), "float32", -1.0, 1.0, "cosine and sine of the turn to the left since the start"),
        }

    def init(self, config: EnvConfig) -> GpsCompassState:
        """Return zeros; `update` sets the start at a reset."""
        return GpsCompassState(
            jnp.zeros((config.num_agents, 3), jnp.float32), jnp.zeros(config.num_agents, jnp.float32)
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: GpsCompassState) -> GpsCompassState:
        """Return the present pose at a reset (step 0), else the stored one unchanged."""
        now = GpsCompassState(snapshot.pose.pos, snapshot.pose.yaw)
        return jax.tree.map(lambda new, old: jnp.where(snapshot.step == 0, new, old), now, state)

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: GpsCompassState) -> dict[str, Array]:
        """Return `gps`, the position [m], and `compass`, cosine and sine of the yaw, in the frame of the start."""
        away, turn = snapshot.pose.pos - state.pos, snapshot.pose.yaw - state.yaw
        cos, sin = jnp.cos(state.yaw), jnp.sin(state.yaw)
        x, y = cos * away[:, 0] + sin * away[:, 1], cos * away[:, 1] - sin * away[:, 0]
        return {
            "gps": jnp.stack([x, y, away[:, 2]], axis=-1),
            "compass": jnp.stack([jnp.cos(turn), jnp.sin(turn)], axis=-1),
        }


class Lidar(Sensor):
    """`lidar` (64,): horizontal distances all around at eye height [m], from straight ahead to the left."""

    name = "lidar"
    casts_rays = True

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `lidar`: `NUM_RAYS` distances [m]."""
        text = "from straight ahead to the left [m], clipped"
        return {"lidar": ArraySpec((NUM_RAYS,), "float32", 0.0, config.max_depth, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `lidar` (a, 64): distances to the first hits [m], at most `max_depth`; the own body is ignored."""
        angles = snapshot.pose.yaw[:, None] + jnp.arange(NUM_RAYS) * jnp.float32(2 * math.pi / NUM_RAYS)
        ways = jnp.stack([jnp.cos(angles), jnp.sin(angles), jnp.zeros_like(angles)], axis=-1)
        eyes = jnp.broadcast_to(eye_position(config, snapshot.pose)[:, None], ways.shape)
        own = jnp.broadcast_to(agent_ids(snapshot.bank, config.num_agents)[:, None], angles.shape)
        hit = cast(snapshot.scene, eyes, ways, exclude=own)
        return {"lidar": jnp.minimum(hit.t, jnp.float32(config.max_depth))}


class LocalMap(Sensor):
    """`local_map` (32, 32): walkable cells around the agent, which is at the centre and faces up.

    1 in walkable cells, also of regions that the agent cannot reach, 0 elsewhere; from the house as compiled, on the
    agent's level.
    """

    name = "local_map"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `local_map`: a square of zeros and ones."""
        return {
            "local_map": ArraySpec((MAP_SIZE, MAP_SIZE), "uint8", 0, 1, f"1: free; {MAP_CELL} m a cell, ahead is up")
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `local_map`: 1 where a cell's centre is walkable; row 0 is the farthest ahead, column 0 leftmost.

        Cells beyond the house's grid are 0.
        """
        bank, house = snapshot.bank, snapshot.house
        steps = (jnp.arange(MAP_SIZE) - (MAP_SIZE - 1) / 2) * jnp.float32(MAP_CELL)
        ahead, left = jnp.meshgrid(-steps, -steps, indexing="ij")

        def look(feet: Float[Array, "3"], yaw: Float[Array, ""]) -> Array:
            """Return the map of one agent."""
            cos, sin = jnp.cos(yaw), jnp.sin(yaw)
            x, y = feet[0] + cos * ahead - sin * left, feet[1] + sin * ahead + cos * left
            level = cell_at_feet(bank, house, feet)[0]
            column, row = (
                jnp.floor((p - o) / jnp.float32(bank.spec.cell)).astype(jnp.int32)
                for p, o in zip((x, y), bank.navigation.origin[house], strict=True)
            )
            rows, columns = bank.navigation.region.shape[2:]
            known = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
            region = bank.navigation.region[house, level, jnp.clip(row, 0, rows - 1), jnp.clip(column, 0, columns - 1)]
            return (known & (region >= 0)).astype(jnp.uint8)

        return {"local_map": jax.vmap(look)(snapshot.feet, snapshot.pose.yaw)}
