"""Define a sensor: distances to the nearest obstacle ahead, left and right, by ray casting."""

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.raycast_render import cast
from home_mjx.tasks import ArraySpec, EnvConfig, Sensor, Snapshot, register_sensor

ANGLES = jnp.deg2rad(jnp.array([-45.0, 0.0, 45.0]))


class Whiskers(Sensor):
    """Sensor `whiskers` (3,): free distance at half the body's height [m]: right, ahead, left."""

    name = "whiskers"
    casts_rays = True

    def spec(self, config: EnvConfig) -> dict[str, ArraySpec]:
        """Return the spec: one distance per whisker."""
        return {"whiskers": ArraySpec((3,), "float32", 0.0, config.max_depth, "free distance [m]")}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: object) -> dict[str, jax.Array]:
        """Return the distances with a leading agent axis, even for one agent."""
        angle = snapshot.pose.yaw[:, None] + ANGLES[None]  # (agents, 3)
        way = jnp.stack([jnp.cos(angle), jnp.sin(angle), jnp.zeros_like(angle)], axis=-1)
        start = jnp.broadcast_to(snapshot.pose.pos[:, None], way.shape)
        own = snapshot.bank.spec.num_instances + jnp.arange(way.shape[0], dtype=jnp.int32)  # agents' own bodies
        hit = cast(snapshot.scene, start, way, exclude=jnp.broadcast_to(own[:, None], angle.shape))
        return {"whiskers": jnp.minimum(hit.t, config.max_depth)}


home_mjx.use_compile_cache()
register_sensor(Whiskers())
env = home_mjx.make("PointNav-v0", num_houses=2, sensors=("whiskers",), impl="kinematic", ctrl_dt=0.3)
reset, step = jax.jit(jax.vmap(env.reset)), jax.jit(jax.vmap(env.step))
states = reset(jax.random.split(jax.random.key(0), 4))
for _ in range(20):  # move ahead, and turn away from close obstacles
    right, ahead, left = states.obs["whiskers"].T
    turn = jnp.where(ahead < 1.0, jnp.sign(left - right), 0.0)
    action = jnp.stack([jnp.clip(ahead - 0.4, 0, 1), jnp.zeros(4), turn, jnp.zeros(4)], axis=-1)
    states = step(states, action)
print("free distance [m], right, ahead, left of each agent:")
print(states.obs["whiskers"].round(2))
