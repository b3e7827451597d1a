"""Train with Stable-Baselines3's PPO on the Gymnasium environment."""

import gymnasium
from stable_baselines3 import PPO

import home_mjx

home_mjx.use_compile_cache()
env = gymnasium.make(
    "home_mjx/PointNav-v0", num_houses=2, sensors=("state", "goal"), impl="kinematic", ctrl_dt=0.3, episode_length=60
)
model = PPO("MultiInputPolicy", env, n_steps=256, batch_size=64, n_epochs=2, seed=0, verbose=0)
model.learn(512)

obs, _ = env.reset(seed=0)
gained, over = 0.0, False
while not over:
    action, _ = model.predict(obs, deterministic=True)
    obs, reward, terminated, truncated, info = env.step(action)
    gained, over = gained + float(reward), terminated or truncated
print(f"after {model.num_timesteps} steps: return {gained:+.2f}, success {info['success']:.0f}")
env.close()
