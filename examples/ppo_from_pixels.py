"""Train with recurrent PPO from depth images: the loop of `home-mjx train`, as a starting point for changes."""

import jax

import home_mjx
from home_mjx.training import PPO, NetworkConfig, PPOConfig

home_mjx.use_compile_cache()
options = {"sensors": ("depth", "goal"), "width": 16, "height": 16, "impl": "kinematic", "ctrl_dt": 0.3}
env = home_mjx.make("PointNav-v0", num_houses=2, split="train", episode_length=60, **options)
config = PPOConfig(
    num_envs=16,
    num_timesteps=4096,  # use 1e8 for an agent that navigates in held-out houses
    unroll_length=32,
    num_minibatches=2,
    num_epochs=1,
    optimizer="adam",
    learning_rate=1e-3,
    network=NetworkConfig(features=32, memory=32, channels=(8, 16)),
)
ppo = PPO(env.core, config)
state = ppo.init(env.params, jax.random.key(0))
for update in range(1, config.num_updates + 1):
    state, metrics = ppo.update(env.params, state)
    episodes = max(float(metrics["episode/episodes"]), 1)
    print(f"{update * config.batch_size:6d} steps, mean return {float(metrics['episode/return']) / episodes:+.2f}")
