"""Train with PPO in one file of PyTorch, in the style of CleanRL (Huang et al., 2022).

JAX arrays become tensors without a copy. A truncated episode counts as terminated, as in CleanRL's PPO.
"""

import jax
import numpy as np
import torch
from torch import nn
from torch.distributions import Normal

import home_mjx
from home_mjx.adapters.pytorch import to_jax, to_torch
from home_mjx.tasks import AutoReset

NUM_ENVS, NUM_STEPS, NUM_UPDATES, EPOCHS, MINIBATCHES = 32, 32, 6, 4, 4
GAMMA, LAMBDA, CLIP, VALUE_COST, ENTROPY_COST, RATE = 0.99, 0.95, 0.2, 0.5, 1e-3, 1e-3


class Agent(nn.Module):
    """Policy and value networks of the same sizes."""

    def __init__(self, seen: int, actions: int) -> None:
        super().__init__()
        self.policy, self.critic = (
            nn.Sequential(nn.Linear(seen, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs))
            for outputs in (actions, 1)
        )
        self.log_scale = nn.Parameter(torch.full((actions,), -0.5))

    def value(self, obs: torch.Tensor) -> torch.Tensor:
        """Return the estimated return."""
        return self.critic(obs)[:, 0]

    def act(self, obs: torch.Tensor, action: torch.Tensor | None = None) -> tuple[torch.Tensor, ...]:
        """Return an action, its log-probability and the entropy."""
        choice = Normal(self.policy(obs), self.log_scale.exp())
        action = choice.sample() if action is None else action
        return action, choice.log_prob(action).sum(-1), choice.entropy().sum(-1)


def vector(obs: dict[str, jax.Array]) -> torch.Tensor:
    """Concatenate all observations to one squashed row per environment."""
    tensors = to_torch({name: obs[name] for name in sorted(obs)})
    row = torch.cat([x.reshape(len(x), -1) for x in tensors.values()], dim=-1)
    return torch.sign(row) * torch.log1p(row.abs())


torch.manual_seed(0)
home_mjx.use_compile_cache()
options = {"sensors": ("state", "goal"), "impl": "kinematic", "ctrl_dt": 0.3, "episode_length": 60}
env = home_mjx.make("PointNav-v0", num_houses=2, **options)
batch = AutoReset(env.core)
step = jax.jit(batch.step)
states = jax.jit(batch.reset)(env.params, jax.random.split(jax.random.key(0), NUM_ENVS))
obs = vector(states.obs)
agent = Agent(obs.shape[1], env.action_size).to(obs.device)
optimizer = torch.optim.Adam(agent.parameters(), lr=RATE, eps=1e-5)

for update in range(1, NUM_UPDATES + 1):
    kept = {name: [] for name in ("obs", "action", "log_prob", "value", "reward", "goes_on")}
    ended, succeeded = 0, 0.0
    for _ in range(NUM_STEPS):
        with torch.no_grad():
            action, log_prob, _ = agent.act(obs)
            value = agent.value(obs)
        states = step(env.params, states, to_jax(action.clamp(-1, 1).contiguous()))
        now = {"obs": obs, "action": action, "log_prob": log_prob, "value": value}
        now |= {"reward": to_torch(states.reward), "goes_on": 1.0 - to_torch(states.done).float()}
        for name, x in now.items():
            kept[name].append(x)
        obs = vector(states.obs)
        ended += int(states.done.sum())
        succeeded += float(np.sum(np.asarray(states.metrics["success"] * states.done)))

    data = {name: torch.stack(x) for name, x in kept.items()}
    with torch.no_grad():
        following, advantage = agent.value(obs), torch.zeros(NUM_ENVS, device=obs.device)
        advantages = torch.zeros_like(data["reward"])
        for t in reversed(range(NUM_STEPS)):
            error = data["reward"][t] + GAMMA * following * data["goes_on"][t] - data["value"][t]
            advantage = error + GAMMA * LAMBDA * data["goes_on"][t] * advantage
            advantages[t], following = advantage, data["value"][t]
    data |= {"advantage": advantages, "target": advantages + data["value"]}
    flat = {name: x.reshape(-1, *x.shape[2:]) for name, x in data.items()}

    for _ in range(EPOCHS):
        for rows in torch.randperm(NUM_ENVS * NUM_STEPS, device=obs.device).chunk(MINIBATCHES):
            part = {name: x[rows] for name, x in flat.items()}
            _, log_prob, entropy = agent.act(part["obs"], part["action"])
            ratio = (log_prob - part["log_prob"]).exp()
            weight = (part["advantage"] - part["advantage"].mean()) / (part["advantage"].std() + 1e-8)
            policy_loss = -torch.min(ratio * weight, ratio.clamp(1 - CLIP, 1 + CLIP) * weight).mean()
            value_loss = 0.5 * (agent.value(part["obs"]) - part["target"]).square().mean()
            loss = policy_loss + VALUE_COST * value_loss - ENTROPY_COST * entropy.mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimizer.step()
    print(
        f"{update * NUM_ENVS * NUM_STEPS:6d} steps, reward {data['reward'].mean():+.3f} a step, "
        f"{succeeded:.0f} of {ended} episodes ended at the goal"
    )
