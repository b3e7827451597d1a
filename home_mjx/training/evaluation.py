"""Evaluation of policies over whole episodes that are spread evenly over houses, and a random baseline."""

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt32

from home_mjx.core.checks import check_number
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.notebook_html import format_table
from home_mjx.core.pytree import Pytree
from home_mjx.registry import EnvSpec
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.base.task import path_scores
from home_mjx.tasks.env.autoreset import select_envs
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.episodes import sample_episodes
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.expert_observation import EXPERT
from home_mjx.training.rollout import Policy, split_keys, to_envs, to_rows

MAX_EPISODES = 1_000_000  # maximum episodes of one evaluation; their rows are sampled in advance, all at once
MAX_PARALLEL_EPISODES = 256  # maximum number of episodes that run in parallel


class Results(dict[str, np.ndarray]):
    """Metrics of episodes: one number per episode by name."""

    def _repr_html_(self) -> str:
        """Return the mean of each metric with its standard error, for notebooks."""
        known = {name: values[np.isfinite(values)] for name, values in self.items()}
        figures = summarize({name: values for name, values in known.items() if len(values)})
        rows = {name: f"{x['mean']:.3f} ± {x['stderr']:.3f}" for name, x in figures.items()}
        rows |= dict.fromkeys(self.keys() - rows.keys(), "unknown")
        return format_table(f"Results of {max(map(len, self.values()), default=0)} episodes", rows)


TRAINING_ONLY = ("terminate_on_failure", "episodes")  # options that ease learning, and the training episodes


def evaluation_spec(
    spec: EnvSpec, split: str | None = "val", num_houses: int = 16, *, episode_file: str | Path | None = None,
    dataset: str | Path | None = None,
) -> EnvSpec:  # fmt: skip
    """Return the evaluation spec: held-out houses, training-only options removed.

    Args:
        spec: Spec that the agent was trained on.
        split: Split of the dataset; None: the houses of training, in the episodes of training if there are such.
        num_houses: Number of houses of the split; without effect if `split` is None, or with `episode_file`.
        episode_file: Episode file that replaces the split; its episodes name their houses.
        dataset: Root of a dataset other than that of training.

    Example:
        >>> options = {"stop": True, "terminate_on_failure": False}
        >>> spec = EnvSpec("ObjectNav-v0", "home_mjx.tasks.suite:ObjectNav", options)
        >>> evaluation_spec(spec).options, evaluation_spec(spec).split
        ({'stop': True}, 'val')
        >>> evaluation_spec(spec, None).options, evaluation_spec(spec, None).num_houses
        ({'stop': True}, 8)
    """
    options = {name: value for name, value in spec.options.items() if name not in TRAINING_ONLY}
    spec = dataclasses.replace(spec, houses=spec.houses if dataset is None else str(dataset))
    if episode_file is not None:
        return dataclasses.replace(spec, options=options | {"episodes": str(episode_file)}, split=None)
    if split is None:  # an episode file may have selected the houses of training
        options |= {name: value for name, value in spec.options.items() if name == "episodes"}
        return dataclasses.replace(spec, options=options)
    return dataclasses.replace(spec, options=options, split=split, num_houses=num_houses)


class EpisodeBatch(Pytree):
    """Loop state of N episodes that run in parallel; rows r are their agents."""

    env: State
    memory: Any
    keys: UInt32[Array, "r 2"]
    is_running: Any  # (N,) bool, not yet ended
    metrics: dict[str, Float[Array, " n"]]  # running values, frozen when the episode ends


def evaluate(
    env: Env[HouseholdEnv],
    make_policy: Callable[[Any], Policy],
    net: Any = None,
    num_episodes: int = 1000,
    seed: int = 0,
    max_batch: int = MAX_PARALLEL_EPISODES,
) -> Results:
    """Run episodes to their end and return their metrics.

    Episodes are the first rows of the environment's episodes or task bank, cyclically. Without such rows they are
    sampled with `sample_episodes`; a task without columns begins each by a reset with its key. The same seed gives the
    same episodes to any policy.

    Args:
        env: Houses and task; use held-out houses, `split="val"`, to measure generalisation.
        make_policy: Function from parameters to a policy, such as `PPO.policy` or `random_policy(core)`.
        net: The parameters.
        num_episodes: Number of episodes, at most `MAX_EPISODES`.
        seed: Seed of episodes and actions.
        max_batch: Maximum number of episodes that run in parallel.

    Returns:
        For each episode: `return`, `episode_steps`, `walked` [m] by the first agent, and the task's metrics at its end.
        A task with `success` and a shortest path `length` also gets `spl` (Anderson et al., arXiv:1807.06757). With
        `distance` it also gets `soft_spl` (Datta et al., arXiv:2009.03231).

    Raises:
        ConfigError: `num_episodes` or `max_batch` is not a whole number, or is out of range; or as `sample_episodes`.

    Example:
        >>> results = evaluate(held_out, ppo.policy, state.net)  # doctest: +SKIP
        >>> results["success"].mean()  # doctest: +SKIP
    """
    check_episodes(num_episodes)
    check_number("max_batch", max_batch, 1, integer=True)
    env = with_episodes(env, num_episodes, seed)
    batch = min(num_episodes, max_batch)
    keys = jax.random.key_data(jax.random.split(jax.random.key(seed), num_episodes + batch))
    play = jax.jit(
        lambda params, net, keys, numbers: _run_batch(env.core, make_policy(net), params, keys, numbers),
        compiler_options=compiler_options(),
    )
    parts = []
    for start in range(0, num_episodes, batch):
        numbers = jnp.arange(start, start + batch, dtype=jnp.int32)
        parts.append(jax.device_get(play(env.params, net, keys[start : start + batch], numbers)))
    return Results({name: np.concatenate([part[name] for part in parts])[:num_episodes] for name in parts[0]})


def check_episodes(num: object) -> None:
    """Raise `ConfigError` unless `num` is a whole number from 1 to `MAX_EPISODES`; call before compiling houses."""
    check_number("num_episodes", num, 1, MAX_EPISODES, integer=True)


def with_episodes(env: Env[HouseholdEnv], num: int, seed: int = 0) -> Env[HouseholdEnv]:
    """Return a copy with `num` sampled episodes; the environment itself if it has some or its task has no columns.

    Episodes are those of `sample_episodes`, with its default path lengths and errors.
    """
    if env.params.tasks is not None or not env.task.columns:
        return env
    return env.with_tasks(sample_episodes(env.bank, num, seed, task=env.task))


def random_policy(core: HouseholdEnv) -> Callable[[Any], Policy]:
    """Return a function from parameters, unused, to a policy with uniform actions in the bounds of the action spec.

    Maxima of integers are included.
    """
    spec = core.action_spec.for_one_agent(core.num_agents)
    low, high = spec.bounds()

    def draw(key: Array) -> Array:
        """Draw one action of one agent, uniformly within the bounds; maxima of integers are included."""
        if spec.dtype == "int32":
            return jax.random.randint(key, spec.shape, low, high + 1)
        return jax.random.uniform(key, spec.shape, minval=low, maxval=high)

    def act(memory: Any, obs: dict[str, Array], begins: Array, keys: Array) -> tuple[Any, Array, dict]:
        """Return the memory, an action per key, and no outputs."""
        return memory, jax.vmap(draw)(keys), {}

    return lambda net: Policy(act)


def expert_policy(net: Any = None) -> Policy:
    """Return a policy that takes the expert's actions, for environments of `add_expert`; `net` is unused.

    Example:
        >>> evaluate(add_expert(env), expert_policy)  # doctest: +SKIP
    """
    return Policy(lambda memory, obs, begins, keys: (memory, obs[EXPERT], {}))


def summarize(results: Mapping[str, np.ndarray]) -> dict[str, dict[str, float]]:
    """Compute mean and standard error (population deviation / sqrt(n)) of every metric over episodes.

    Example:
        >>> summarize({"success": np.array([1.0, 0.0, 1.0, 0.0])})
        {'success': {'mean': 0.5, 'stderr': 0.25}}
    """
    return {
        name: {"mean": float(np.mean(x)), "stderr": float(np.std(x) / np.sqrt(len(x)))} for name, x in results.items()
    }


def _run_batch(
    core: HouseholdEnv, policy: Policy, params: EnvParams, keys: UInt32[Array, "n 2"], numbers: Int[Array, " n"]
) -> dict[str, Float[Array, " n"]]:
    """Run n episodes to their end, row `numbers[i]` with key `keys[i]`; return final metrics, path metrics included.

    Numbers count the rows of `params.tasks` cyclically; without rows, episodes depend on the keys alone.
    """
    num, agents = keys.shape[0], core.num_agents
    reset_keys, row_keys = split_keys(keys)
    rows = jax.vmap(lambda key: jax.random.split(key, agents))(row_keys).reshape(-1, 2)
    known = params.tasks is not None
    env = jax.vmap(core.reset, (None, 0, None, 0 if known else None))(
        params, reset_keys, None, numbers if known else None
    )
    length = _shortest_lengths(params, numbers)
    zero = jnp.zeros(num, jnp.float32)
    figures = {"return": zero, "episode_steps": zero, "walked": zero} | env.metrics

    def step(play: EpisodeBatch) -> EpisodeBatch:
        """Step all episodes; metrics of those that are over stay."""
        following, now = split_keys(play.keys)
        begins = jnp.repeat(play.env.world.step == 0, agents)
        memory, action, _ = policy.act(play.memory, to_rows(play.env.obs, agents), begins, now)
        env = jax.vmap(core.step, (None, 0, 0))(params, play.env, to_envs(policy.clip(action), agents))
        figures = select_envs(play.is_running, _update_metrics(core, params, play, env), play.metrics)
        return EpisodeBatch.build_unchecked(
            env=env, memory=memory, keys=following, is_running=play.is_running & ~env.done, metrics=figures
        )

    begin = EpisodeBatch.build_unchecked(
        env=env, memory=policy.initial_memory(num * agents), keys=rows, is_running=jnp.ones(num, bool), metrics=figures
    )
    end = jax.lax.while_loop(lambda play: jnp.any(play.is_running), step, begin)
    return end.metrics | _path_metrics(end.metrics, length)


def _update_metrics(core: HouseholdEnv, params: EnvParams, play: EpisodeBatch, env: State) -> dict[str, Array]:
    """Return metrics after a step; `return` (mean of agents), `episode_steps`, `walked` [m] (agent 0) accumulate."""
    look = jax.vmap(lambda state: core.snapshot(params, state).pose.pos[0])
    moved = jnp.linalg.norm(look(env) - look(play.env), axis=-1)
    reward = jnp.mean(env.reward.reshape(env.done.shape[0], -1), axis=-1)
    gained = {"return": reward, "episode_steps": jnp.ones_like(reward), "walked": moved}
    return {name: play.metrics[name] + x for name, x in gained.items()} | env.metrics


def _shortest_lengths(params: EnvParams, numbers: Int[Array, " n"]) -> Float[Array, " n"] | None:
    """Return shortest path lengths [m] of episodes `numbers`, cyclically; None if the tasks have no such column."""
    lengths = getattr(params.tasks, "columns", {}).get("length")
    return None if lengths is None else lengths[numbers % lengths.shape[0]]


def _path_metrics(figures: dict[str, Array], length: Array | None) -> dict[str, Array]:
    """Compute `spl`, and `soft_spl` given `distance`, from the figures `success` and `walked` [m], which is required.

    The result is empty without lengths or `success`, or if the task has `spl` itself.
    """
    if length is None or "success" not in figures or "spl" in figures:
        return {}
    found = path_scores(figures["success"], length, figures["walked"], figures.get("distance", length))
    return found if "distance" in figures else {"spl": found["spl"]}
