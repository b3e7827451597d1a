"""Train a recurrent agent with PPO in PyTorch: depth and goal, discrete actions, and `stop` as in Habitat's PointNav.

The network is that of DD-PPO (Wijmans et al., 2020) in small: a CNN for depth, an LSTM over time. An episode succeeds
only if the agent chooses `stop` at the goal. The LSTM starts every episode with zeros, in rollouts and in updates.
"""

import jax
import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical

import home_mjx
from home_mjx.adapters.pytorch import to_jax, to_torch
from home_mjx.tasks import AutoReset

NUM_ENVS, NUM_STEPS, NUM_UPDATES = 16, 32, 4  # 512, 64 and 10^4 for an agent
EPOCHS, MINIBATCHES, MEMORY = 2, 2, 64
GAMMA, LAMBDA, CLIP, VALUE_COST, ENTROPY_COST, RATE, MAX_NORM = 0.99, 0.95, 0.2, 0.5, 0.01, 2.5e-4, 0.5
MAX_DEPTH = 10.0  # [m], `EnvConfig.max_depth`
DEPTH, GOAL = "pixels/head_depth", "goal"

Memory = tuple[torch.Tensor, torch.Tensor]


class Agent(nn.Module):
    """A CNN, an LSTM cell, and heads for actions and value."""

    def __init__(self, obs: dict[str, torch.Tensor], actions: int) -> None:
        super().__init__()
        self.cnn = nn.Sequential(
            nn.Conv2d(1, 8, 5, 2), nn.ReLU(), nn.Conv2d(8, 16, 3, 2), nn.ReLU(), nn.Flatten()
        )  # fmt: skip
        features = self.cnn(see(obs)).shape[1] + obs[GOAL].shape[1]
        self.cell = nn.LSTMCell(features, MEMORY)
        self.policy, self.critic = nn.Linear(MEMORY, actions), nn.Linear(MEMORY, 1)
        nn.init.orthogonal_(self.policy.weight, 0.01)
        nn.init.zeros_(self.policy.bias)

    def start(self, count: int) -> Memory:
        """Return the memory of `count` environments at the start of their episodes."""
        zeros = torch.zeros(count, MEMORY, device=self.policy.weight.device)
        return zeros, zeros

    def step(self, obs: dict[str, torch.Tensor], memory: Memory, begins: torch.Tensor) -> tuple:
        """Return the policy, the value and the next memory; `begins` is 1 where an episode begins, which clears it."""
        kept = (1.0 - begins)[:, None]
        seen = torch.cat([self.cnn(see(obs)), squash(obs[GOAL])], dim=-1)
        memory = self.cell(seen, (memory[0] * kept, memory[1] * kept))
        return Categorical(logits=self.policy(memory[0])), self.critic(memory[0])[:, 0], memory


def see(obs: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return depth as images with values from 0 to 1 (Habitat's are normalised, too)."""
    return obs[DEPTH].permute(0, 3, 1, 2) / MAX_DEPTH


def squash(x: torch.Tensor) -> torch.Tensor:
    """Compress long distances."""
    return torch.sign(x) * torch.log1p(x.abs())


def observe(states: home_mjx.State) -> dict[str, torch.Tensor]:
    """Return what the agent observes as tensors, which share the arrays' memory."""
    return to_torch({name: states.obs[name] for name in (DEPTH, GOAL)})


def estimate_advantages(data: dict[str, torch.Tensor], last: torch.Tensor) -> torch.Tensor:
    """Return generalized advantage estimates (Schulman et al., 2016); a truncated episode counts as terminated."""
    advantages, following, advantage = torch.zeros_like(data["reward"]), last, torch.zeros_like(last)
    for t in reversed(range(len(advantages))):
        error = data["reward"][t] + GAMMA * following * data["goes_on"][t] - data["value"][t]
        advantage = error + GAMMA * LAMBDA * data["goes_on"][t] * advantage
        advantages[t], following = advantage, data["value"][t]
    return advantages


def compute_loss(agent: Agent, data: dict[str, torch.Tensor], memory: Memory) -> torch.Tensor:
    """Return PPO's loss of whole sequences (T, n): the memory runs through them again, from the rollout's first one."""
    log_probs, values, entropies = [], [], []
    for t in range(len(data["action"])):
        choice, value, memory = agent.step({DEPTH: data[DEPTH][t], GOAL: data[GOAL][t]}, memory, data["begins"][t])
        log_probs.append(choice.log_prob(data["action"][t]))
        values.append(value)
        entropies.append(choice.entropy())
    ratio = (torch.stack(log_probs) - data["log_prob"]).exp()
    weight = (data["advantage"] - data["advantage"].mean()) / (data["advantage"].std() + 1e-8)
    policy_loss = -torch.min(ratio * weight, ratio.clamp(1 - CLIP, 1 + CLIP) * weight).mean()
    value_loss = 0.5 * (torch.stack(values) - data["target"]).square().mean()
    return policy_loss + VALUE_COST * value_loss - ENTROPY_COST * torch.stack(entropies).mean()


torch.manual_seed(0)
home_mjx.use_compile_cache()
env = home_mjx.make(
    "PointNav-v0", num_houses=2, sensors=("depth", "goal"), actions="discrete", stop=True, success_distance=0.2,
    episode_length=60, width=32, height=32, impl="kinematic",
)  # fmt: skip
batch = AutoReset(env.core)
step = jax.jit(batch.step)
states = jax.jit(batch.reset)(env.params, jax.random.split(jax.random.key(0), NUM_ENVS))
obs = observe(states)
agent = Agent(obs, env.action_size).to(obs[GOAL].device)
optimizer = torch.optim.Adam(agent.parameters(), lr=RATE, eps=1e-5)
memory, begins = agent.start(NUM_ENVS), torch.ones(NUM_ENVS, device=obs[GOAL].device)

for update in range(1, NUM_UPDATES + 1):
    first, kept, ended, succeeded, spl = memory, [], 0, 0.0, 0.0
    for _ in range(NUM_STEPS):
        with torch.no_grad():
            choice, value, memory = agent.step(obs, memory, begins)
            action = choice.sample()
        states = step(env.params, states, to_jax(action.int()))
        done = np.asarray(states.done)
        now = {**obs, "begins": begins, "action": action, "log_prob": choice.log_prob(action), "value": value}
        begins = torch.tensor(done, dtype=torch.float32, device=value.device)
        kept.append({**now, "reward": to_torch(states.reward), "goes_on": 1.0 - begins})
        obs = observe(states)
        ended += int(done.sum())
        succeeded += float(np.asarray(states.metrics["success"])[done].sum())
        spl += float(np.asarray(states.metrics["spl"])[done].sum())

    data = {name: torch.stack([x[name] for x in kept]) for name in kept[0]}
    with torch.no_grad():
        last = agent.step(obs, memory, begins)[1]
        data["advantage"] = estimate_advantages(data, last)
    data["target"] = data["advantage"] + data["value"]
    for _ in range(EPOCHS):
        for envs in torch.randperm(NUM_ENVS, device=begins.device).chunk(MINIBATCHES):  # whole sequences of some
            part = {name: x[:, envs] for name, x in data.items()}
            loss = compute_loss(agent, part, (first[0][envs], first[1][envs]))
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), MAX_NORM)
            optimizer.step()
    episodes = max(ended, 1)
    print(
        f"{update * NUM_ENVS * NUM_STEPS:6d} steps, reward {data['reward'].mean():+.3f} a step, "
        f"loss {loss.item():+.3f}, "
        f"{ended} episodes: success {succeeded / episodes:.2f}, SPL {spl / episodes:.2f}"
    )
