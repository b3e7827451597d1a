"""Players of episodes: policies as players, and the player protocol."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.training.evaluation import expert_policy, random_policy
from home_mjx.training.rollout import Policy, split_keys, to_envs, to_rows

POLICIES = ("expert", "random", "trained")


def check_agent(agent: str, checkpoint: Path | None, known: tuple[str, ...] = POLICIES) -> None:
    """Validate an agent and its checkpoint before any house is compiled.

    Raises:
        ConfigError: The agent is unknown, or `trained` has no checkpoint, or another agent has one.
    """
    check_known("agent", [agent], known)
    if (agent == "trained") != (checkpoint is not None):
        hint = "Use --agent trained --checkpoint runs/RoomNav-v0."
        raise ConfigError("agent `trained` needs a checkpoint, other agents must not have one", hint=hint)


def make_policy(env: Env[HouseholdEnv], agent: str, checkpoint: Path | None = None, greedy: bool = False) -> Policy:
    """Return the policy of an agent in `POLICIES`.

    Args:
        env: The environment; for the expert one of `add_expert`.
        agent: Name of the agent.
        checkpoint: Checkpoint of `trained`.
        greedy: Take the most likely action of `trained`; ignored for others.

    Raises:
        ConfigError: As in `check_agent`; or the checkpoint is for other observations or actions.
    """
    check_agent(agent, checkpoint)
    if checkpoint is None:
        return expert_policy() if agent == "expert" else random_policy(env.core)(None)
    trained, net = load_trained(checkpoint, env.core, greedy)
    return trained(net)


def load_trained(checkpoint: Path, core: HouseholdEnv, greedy: bool = False) -> tuple[Callable[[Any], Policy], Any]:
    """Load the policy of a checkpoint as `training.load_policy` does: a function from parameters, and the parameters.

    Raises:
        ConfigError: The extra `train` is not installed; or as in `load_policy`, as are others.
    """
    from home_mjx.training import load_policy  # needs the extra `train`

    return load_policy(checkpoint, core, greedy)


@runtime_checkable
class Player(Protocol):
    """Interface that chooses the actions of one environment's agents."""

    def reset(self) -> None:
        """Prepare for a new episode; called once before its first `act`."""
        ...

    def act(self, state: State) -> Any:
        """Return the next action of all agents, stacked if there are several; None ends the episode."""
        ...


class PolicyPlayer:
    """Player that samples actions from a policy.

    Args:
        core: The environment.
        policy: The policy.
        seed: Seed of its actions.
        make: Function from parameters to a policy, which replaces `policy` in each step; None: `policy` itself.
        net: The parameters.

    Attributes:
        net: The parameters; others of the same shapes may replace them without a compilation.
        outputs: Other outputs of the policy at the last action, a row for each agent, such as `value`.
    """

    def __init__(
        self,
        core: HouseholdEnv,
        policy: Policy,
        seed: int = 0,
        make: Callable[[Any], Policy] | None = None,
        net: Any = None,
    ) -> None:
        self.agents, self.policy, self._make, self.net = core.num_agents, policy, make, net
        self.keys = jax.random.key_data(jax.random.split(jax.random.key(seed), self.agents))
        self.memory, self.is_first = policy.initial_memory(self.agents), True
        self.outputs: dict[str, Any] = {}
        self._act: Callable[..., Any] = jax.jit(self._acted)

    def copy(self, seed: int) -> "PolicyPlayer":
        """Return a player of the same policy with its own memory and random keys; its program is compiled once."""
        other = copy.copy(self)
        other.keys = jax.random.key_data(jax.random.split(jax.random.key(seed), self.agents))
        other.reset()
        return other

    def reset(self) -> None:
        """Reset the policy's memory at the start of an episode; its random keys go on."""
        self.memory, self.is_first = self.policy.initial_memory(self.agents), True

    def act(self, state: State) -> Any:
        """Return all agents' actions, stacked if there are several; update the policy's memory and the random keys."""
        begins = jnp.full(self.agents, self.is_first)
        self.memory, action, self.keys, self.outputs = self._act(self.net, self.memory, state.obs, begins, self.keys)
        self.is_first = False
        return np.asarray(action)

    def _acted(
        self, net: Any, memory: Any, obs: dict[str, Any], begins: Any, keys: Any
    ) -> tuple[Any, Any, Any, dict[str, Any]]:
        """Return new memory, actions in the environment's shape, new keys, and other outputs; to be jitted."""
        rows = to_rows(jax.tree.map(lambda x: x[None], obs), self.agents)
        keys, now = split_keys(keys)
        policy = self.policy if self._make is None else self._make(net)
        memory, action, outputs = policy.act(memory, rows, begins, now)
        return memory, to_envs(policy.clip(action), self.agents)[0], keys, outputs
