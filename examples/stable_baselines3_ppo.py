"""Train with Stable-Baselines3's PPO on a batch of environments, which is one `VecEnv`."""

from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

import home_mjx
from home_mjx.adapters.stable_baselines3 import BatchVecEnv

home_mjx.use_compile_cache()
options = {"sensors": ("state", "goal"), "impl": "kinematic", "actions": "discrete", "stop": True}
envs = BatchVecEnv(16, "PointNav-v0", num_houses=2, episode_length=60, **options)
envs = VecMonitor(envs, info_keywords=("success", "spl"))
model = PPO("MultiInputPolicy", envs, n_steps=32, batch_size=128, n_epochs=2, seed=0, verbose=0)
model.learn(1024)
episodes = list(model.ep_info_buffer or ())
mean = {name: sum(episode[name] for episode in episodes) / max(len(episodes), 1) for name in ("r", "success", "spl")}
print(
    f"after {model.num_timesteps} steps: return {mean['r']:+.2f}, success {mean['success']:.2f}, SPL {mean['spl']:.2f}"
)
envs.close()
