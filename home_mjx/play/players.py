"""Who plays: a policy, or a person at the keyboard."""

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.tasks.base.state import State
from home_mjx.tasks.environment.household import HouseholdEnv
from home_mjx.training.rollout import Policy, split_keys, to_envs, to_rows


@runtime_checkable
class Player(Protocol):
    """Chooses the actions of one environment's agents."""

    def begin(self) -> None:
        """An episode begins."""
        ...

    def act(self, state: State) -> Any:
        """The next action of all agents, as the environment takes it; None ends the game."""
        ...


class PolicyPlayer:
    """Plays as a policy does.

    Args:
        core: The environment.
        policy: How to act.
        seed: Of its actions.
    """

    def __init__(self, core: HouseholdEnv, policy: Policy, seed: int = 0) -> None:
        self.agents, self.policy = core.num_agents, policy
        self.keys = jax.random.key_data(jax.random.split(jax.random.key(seed), self.agents))
        self.memory, self.first = policy.memory(self.agents), True
        self._act: Callable[..., Any] = jax.jit(self._acted)

    def begin(self) -> None:
        """It forgets the last episode."""
        self.memory, self.first = self.policy.memory(self.agents), True

    def act(self, state: State) -> Any:
        """What the policy does."""
        begins = jnp.full(self.agents, self.first)
        self.memory, action, self.keys = self._act(self.memory, state.obs, begins, self.keys)
        self.first = False
        return np.asarray(action)

    def _acted(self, memory: Any, obs: dict[str, Any], begins: Any, keys: Any) -> tuple[Any, Any, Any]:
        rows = to_rows(jax.tree.map(lambda x: x[None], obs), self.agents)
        keys, now = split_keys(keys)
        memory, action, _ = self.policy.act(memory, rows, begins, now)
        return memory, to_envs(self.policy.clip(action), self.agents)[0], keys
