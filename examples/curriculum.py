"""Train with a curriculum: PPO on paths that get longer with success, in varied houses, in one compiled program."""

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.training import PPO, NetworkConfig, PPOConfig

WANTED, LONGER = 0.3, 1.3  # success rate at which the maximum path length grows, and its growth factor

home_mjx.use_compile_cache()
options = {"sensors": ("depth", "goal_words"), "width": 16, "height": 16, "impl": "kinematic", "ctrl_dt": 0.3}
options |= {"actions": "continuous", "stop": False, "min_length": 0.3, "episode_length": 60}
ranges = {"camera_height": (-0.2, 0.2), "depth_noise": (0.0, 1.0)}
env = home_mjx.make("RoomNav-v0", num_houses=2, split="train", variation=ranges, **options)
config = PPOConfig(
    num_envs=16,
    num_timesteps=4096,  # use 1e8 for an agent that finds rooms in held-out houses
    unroll_length=32,
    num_minibatches=2,
    num_epochs=1,
    optimizer="adam",
    learning_rate=1e-3,
    network=NetworkConfig(features=32, memory=32, channels=(8, 16)),
)
ppo, tasks = PPO(env.core, config), env.params.tasks
length = tasks.rows.columns["length"]
limit = float(jnp.quantile(length, 0.1))
params = env.params.replace(tasks=tasks.with_weights(length <= limit))
state = ppo.init(params, jax.random.key(0))
for update in range(1, config.num_updates + 1):
    state, metrics = ppo.update(params, state)
    success = float(metrics["episode/success"]) / max(float(metrics["episode/episodes"]), 1)
    print(f"{update * config.batch_size:6d} steps, paths up to {limit:.1f} m, success {success:.2f}")
    limit *= LONGER if success >= WANTED else 1
    params = params.replace(tasks=tasks.with_weights(length <= limit))
