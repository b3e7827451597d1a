"""Train with Brax's PPO, for existing Brax code; `home-mjx train` uses a recurrent PPO."""

import functools

import home_mjx
from home_mjx.adapters.brax import BraxEnv, wrap_for_training
from home_mjx.training import brax_compat

brax_compat.install()  # restores a function that brax 0.14.2 calls and JAX 0.10 removed
from brax.training.agents.ppo import networks  # noqa: E402
from brax.training.agents.ppo import train as ppo  # noqa: E402

home_mjx.use_compile_cache()
env = BraxEnv(home_mjx.make("PointNav-v0", num_houses=2, sensors=("state", "goal"), impl="kinematic", ctrl_dt=0.3))
layers = {"policy_hidden_layer_sizes": (32, 32), "value_hidden_layer_sizes": (32, 32)}
make_policy, params, _ = ppo.train(
    env,
    wrap_env_fn=wrap_for_training,
    num_timesteps=4096,
    episode_length=60,
    num_envs=32,
    batch_size=32,
    num_minibatches=4,
    unroll_length=8,
    num_evals=2,
    num_eval_envs=16,
    network_factory=functools.partial(networks.make_ppo_networks, **layers),
    progress_fn=lambda step, metrics: print(f"{step:6d} steps, return {metrics['eval/episode_reward']:+.2f}"),
)
