"""Held-out evaluation during training: some environments in other houses go on beside each update."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, UInt32

from home_mjx.core.compile_cache import compiler_options
from home_mjx.hosts import local_part
from home_mjx.tasks.base.state import EnvParams
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.reset import is_sequential
from home_mjx.training.progress import MetricMeans
from home_mjx.training.rollout import Policy, RolloutState, rollout

PREFIX = "held_out/"  # of the names of metrics


class HeldOutRollout:
    """Environments in held-out houses that take as many steps as those of training, with the latest network.

    Training never waits for a whole episode. An episode may thus begin with one network and end with another, and
    short episodes are counted first: the final evaluation is `evaluate`. Training does not depend on it, but
    its time counts towards a time limit.

    Args:
        env: The environment in held-out houses, with the observations of training.
        make_policy: Function from parameters to a policy, such as `PPO.policy`.
        net: Parameters, of which only shapes and types are used.
        num_envs: Number of environments.
        num_steps: Steps of each `advance`.
        seed: Seed of episodes and actions.
    """

    def __init__(
        self,
        env: Env[HouseholdEnv],
        make_policy: Callable[[Any], Policy],
        net: Any,
        num_envs: int,
        num_steps: int,
        seed: int = 0,
    ) -> None:
        self._batch, self._make_policy, self._num_steps = AutoReset(env.core, final_obs="none"), make_policy, num_steps
        self._device = jax.local_devices()[0]
        self._params: EnvParams = jax.device_put(env.params, self._device)
        keys = jax.random.key_data(jax.random.split(jax.random.key(seed), 2 * num_envs))
        options = compiler_options()
        self._actor: RolloutState = jax.jit(self._begin, compiler_options=options)(
            self._params, keys.reshape(num_envs, 2, 2)
        )
        shapes = jax.eval_shape(lambda x: x, net)
        run = jax.jit(self._advance, compiler_options=options)
        self._run = run.lower(self._params, shapes, self._actor).compile()
        self._means = MetricMeans()
        self._pending: list[dict[str, Array]] = []

    def advance(self, net: Any) -> None:
        """Take steps with parameters `net`; returns before they are computed."""
        self._actor, metrics = self._run(self._params, jax.device_put(local_part(net), self._device), self._actor)
        self._pending.append(metrics)

    def means(self) -> dict[str, float]:
        """Return means over the episodes that ended since the last call, as `held_out/...`; none: only their number."""
        for metrics in self._pending:
            self._means.add(metrics)
        found = self._means.means() if self._pending else {}
        self._pending.clear()
        return {f"{PREFIX}{name}": value for name, value in found.items()}

    def _begin(self, params: EnvParams, keys: UInt32[Array, "n 2 2"]) -> RolloutState:
        """Reset the environments, at the first rows of the tasks if these have no weights."""
        num, agents = len(keys), self._batch.num_agents
        episodes = jnp.arange(num, dtype=jnp.int32) if is_sequential(params.tasks) else None
        env = self._batch.reset(params, keys[:, 0], None, episodes)
        rows = jax.vmap(lambda key: jax.random.split(key, agents))(keys[:, 1]).reshape(-1, 2)
        zero = jnp.zeros(num, jnp.float32)
        return RolloutState.build_unchecked(
            env=env.replace(info={}),
            memory=self._make_policy(None).initial_memory(num * agents),
            is_first=jnp.ones(num * agents, bool),
            keys=rows,
            totals={"return": zero, "length": zero},
        )

    def _advance(self, params: EnvParams, net: Any, actor: RolloutState) -> tuple[RolloutState, dict[str, Array]]:
        """Return the state after `num_steps` steps, and sums over the episodes that ended."""
        policy = self._make_policy(net)._replace(value=None)  # no returns are computed
        actor, _, episodes = rollout(self._batch, params, actor, policy, self._num_steps)
        return actor, {f"episode/{name}": value for name, value in episodes.items()}
