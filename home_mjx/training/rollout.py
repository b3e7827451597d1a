"""Rollouts of a batch of environments under a policy, and advantage estimation."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, UInt32

from home_mjx.core.pytree import Pytree
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.autoreset import AutoReset

# R rows are the agents of all N environments, in the order of environments.


class RolloutState(Pytree):
    """Carry of a rollout from step to step."""

    env: Any  # `State` of N environments, without `info`
    memory: Any  # memory of the policy, R rows
    is_first: Bool[Array, " r"]  # True if the observation in `env` is an episode's first
    keys: UInt32[Array, "r 2"]  # of each row, so that actions do not depend on the sharding
    totals: dict[str, Float[Array, " n"]]  # of running episodes: `return`; `length` [steps], the key in checkpoints


class Transitions(Pytree):
    """T steps of R rows."""

    obs: dict[str, Array]  # (T, R, ...)
    is_first: Bool[Array, "t r"]
    action: Array  # (T, R, ...), before it is clipped
    outputs: Any  # other outputs of the policy, such as `log_prob` and `value`
    reward: Float[Array, "t r"]
    done: Bool[Array, "t r"]
    truncation_value: Float[Array, "t r"]  # value of the observation after a truncated step; else 0


class Policy(NamedTuple):
    """Policy as functions: PPO's network, an expert, or random actions.

    Attributes:
        act: Function from `(memory, obs, is_first, keys)` to the next memory, actions, and other outputs to store; R
            rows each.
        value: Function from `(memory, obs, outputs)` after a step to the values (R,) of observations after truncated
            steps; None: 0.
        clip: Function from actions to valid actions of the environment.
        initial_memory: Function from a number of rows to their memory before the first step.
    """

    act: Callable[[Any, dict[str, Array], Array, Array], tuple[Any, Array, dict[str, Array]]]
    value: Callable[[Any, dict[str, Array], dict[str, Array]], Array] | None = None
    clip: Callable[[Array], Array] = lambda action: action
    initial_memory: Callable[[int], Any] = lambda num_rows: ()


def to_rows(tree: Any, num_agents: int) -> Any:
    """Reshape arrays (N, A, ...) to (N A, ...), by environment; with one agent, which has no axis, return `tree`."""
    return tree if num_agents == 1 else jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), tree)


def to_envs(tree: Any, num_agents: int) -> Any:
    """Reshape arrays (N A, ...) to (N, A, ...), the inverse of `to_rows`; with one agent return `tree`."""
    return tree if num_agents == 1 else jax.tree.map(lambda x: x.reshape(-1, num_agents, *x.shape[1:]), tree)


def split_keys(keys: UInt32[Array, "r 2"]) -> tuple[UInt32[Array, "r 2"], UInt32[Array, "r 2"]]:
    """Split each raw key in two; return the keys of the next step, then those of this step."""
    pairs = jax.vmap(lambda key: jax.random.split(key, 2))(keys)
    return pairs[:, 0], pairs[:, 1]


def rollout(
    batch: AutoReset,
    params: EnvParams,
    actor: RolloutState,
    policy: Policy,
    num_steps: int,
    num_groups: int | None = None,
) -> tuple[RolloutState, Transitions, dict[str, Float[Array, "*g"]]]:
    """Run T = `num_steps` steps of N environments; each agent is one of the R rows, N times the number of agents.

    With `num_groups` sums are those of each group: environments are in the order of their groups, of equal sizes.

    Returns:
        The carry, the steps (T, R, ...), and sums over the episodes that ended: `episodes`, `return` (mean of agents),
        `episode_steps`, and the task's metrics at the end.
    """
    agents = batch.core.num_agents

    def step(actor: RolloutState, _: None) -> tuple[RolloutState, tuple[Transitions, dict[str, Array]]]:
        """Take one step of all environments; return the carry, the transitions, and sums over episodes that ended."""
        obs, (keys, now) = to_rows(actor.env.obs, agents), split_keys(actor.keys)
        memory, action, outputs = policy.act(actor.memory, obs, actor.is_first, now)
        env = batch.step(params, actor.env, to_envs(policy.clip(action), agents))
        totals, ended = _update_totals(actor.totals, env, num_groups)
        done, late = (jnp.repeat(x, agents) for x in (env.done, env.truncated))
        last = to_rows(env.info.get("final_obs", {}), agents)
        taken = Transitions.build_unchecked(
            obs=obs,
            is_first=actor.is_first,
            action=action,
            outputs=outputs,
            reward=to_rows(env.reward, agents),
            done=done,
            truncation_value=_truncation_values(policy, memory, last, outputs, late),
        )
        after = RolloutState.build_unchecked(
            env=env.replace(info={}), memory=memory, is_first=done, keys=keys, totals=totals
        )
        return after, (taken, ended)

    actor, (steps, ended) = jax.lax.scan(step, actor, length=num_steps)
    return actor, steps, jax.tree.map(lambda x: jnp.sum(x, axis=0), ended)


def _truncation_values(
    policy: Policy, memory: Any, last: dict[str, Array], outputs: dict[str, Array], late: Array
) -> Array:
    """Return the values (r,) of the observations after truncated steps; 0 elsewhere, or if the policy has no values.

    `memory` is that after the step, `last` has the last observations of ended episodes, `late` is True for truncated
    rows. Other rows of `last` do not matter.
    """
    nothing, value = jnp.zeros(late.shape, jnp.float32), policy.value
    if value is None:
        return nothing
    values = jax.lax.cond(jnp.any(late), lambda: value(memory, last, outputs), lambda: nothing)
    return jnp.where(late, values, nothing)


def _update_totals(
    totals: dict[str, Array], env: State, num_groups: int | None = None
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return running totals after a step, and sums over the episodes that it ended; rewards are means of agents.

    The sums are `episodes`, `return`, `episode_steps` and the task's metrics. Totals of ended episodes become 0.
    """
    reward = jnp.mean(env.reward.reshape(env.done.shape[0], -1), axis=-1)
    now = {"return": totals["return"] + reward, "length": totals["length"] + 1}
    own = {"return": now["return"], "episode_steps": now["length"]}
    ended = {"episodes": jnp.ones_like(reward), **own, **env.metrics}
    shape = (-1,) if num_groups is None else (num_groups, -1)
    sums = {name: jnp.sum(jnp.where(env.done, x, 0.0).reshape(shape), axis=-1) for name, x in ended.items()}
    return {name: jnp.where(env.done, 0.0, x) for name, x in now.items()}, sums


def compute_advantages(
    steps: Transitions, bootstrap_value: Float[Array, " r"], discount: float, gae_lambda: float
) -> Float[Array, "t r"]:
    """Compute generalised advantages, Schulman et al., 2016 (arXiv:1506.02438), without normalisation.

    A truncated step is bootstrapped with the value of its last observation (`Transitions.truncation_value`). A step
    at which the task ended the episode counts its reward alone (Pardo et al., "Time Limits in Reinforcement
    Learning", 2018, arXiv:1712.00378). `steps.outputs` contain `value`; `bootstrap_value` is that of the observations
    after the last step.
    """
    value, goes_on = steps.outputs["value"], 1.0 - steps.done.astype(jnp.float32)
    following = jnp.concatenate([value[1:], bootstrap_value[None]])
    error = steps.reward + discount * (following * goes_on + steps.truncation_value) - value

    def back(later: Array, now: tuple[Array, Array]) -> tuple[Array, Array]:
        """Return the advantage of a step from the next one's."""
        advantage = now[0] + discount * gae_lambda * now[1] * later
        return advantage, advantage

    return jax.lax.scan(back, jnp.zeros_like(bootstrap_value), (error, goes_on), reverse=True)[1]
