"""Run a batch of environments in one compiled loop: reset, act, step and automatic resets, all on the device."""

import time

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.tasks import AutoReset

NUM_ENVS, NUM_STEPS = 64, 120

home_mjx.use_compile_cache()  # later starts reuse compiled programs
options = {"impl": "kinematic", "ctrl_dt": 0.3, "episode_length": 60}
env = home_mjx.make("PointNav-v0", num_houses=2, sensors=("goal",), **options)
batch = AutoReset(env.core)


def towards(goal: jax.Array) -> jax.Array:
    """Convert distance, cosine and sine of the goal's bearing to an action that turns and moves towards it."""
    turn = jnp.clip(2 * jnp.arctan2(goal[:, 2], goal[:, 1]), -1, 1)
    nothing = jnp.zeros_like(turn)
    return jnp.stack([jnp.maximum(goal[:, 1], 0), nothing, turn, nothing], axis=-1)


@jax.jit
def run(params, states):
    """Step all environments; return done flags and success at the end of each episode."""

    def step(states, _):
        states = batch.step(params, states, towards(states.obs["goal"]))
        return states, (states.done, states.metrics["success"] * states.done)

    return jax.lax.scan(step, states, length=NUM_STEPS)


states = jax.jit(batch.reset)(env.params, jax.random.split(jax.random.key(0), NUM_ENVS))
states, _ = run(env.params, states)  # compiles
start = time.perf_counter()
states, (done, success) = jax.block_until_ready(run(env.params, states))
rate = NUM_ENVS * NUM_STEPS / (time.perf_counter() - start)
print(f"{rate:,.0f} steps per second; {success.sum():.0f} of {done.sum()} episodes ended at the goal")
