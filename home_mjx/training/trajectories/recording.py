"""Recording of episodes from a batch of environments."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.progress import ProgressCount, show_compile
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import RENEW_TAG, EnvParams, State, fold_key
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.reset import is_sequential
from home_mjx.tasks.experts.expert_observation import EXPERT, ExpertObservationEnv
from home_mjx.tasks.language.phrases import describe_goal
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.training.evaluation import expert_policy
from home_mjx.training.rollout import Policy, split_keys, to_envs, to_rows
from home_mjx.training.trajectories.minari_format import RESET_KEY, ROW
from home_mjx.training.trajectories.writer import TrajectoryWriter


def record(
    env: Env[HouseholdEnv],
    folder: str | Path,
    policy: Policy | None = None,
    *,
    num_steps: int = 100_000,
    num_envs: int = 64,
    seed: int = 0,
    agent: str = "expert",
    only_success: bool = False,
    max_failures: int = 1000,
    resume: bool = False,
    progress: bool | None = None,
) -> int:
    """Record at least `num_steps` steps of complete episodes, in Minari's format.

    Once there are enough steps, no new episode starts and running ones are played to their end. Otherwise short
    episodes would be overrepresented. Each episode's metadata contain its task, instruction, house and metrics, and
    key and row of its reset (-1: sampled). Rewards are means of agents.

    Args:
        env: The environment; its `sensors=` are recorded, including images, sound and tokens.
        folder: Output folder.
        policy: Policy that acts; None: the expert, which needs an environment of `add_expert`. The expert's advice is
            recorded as observation `expert` if another policy acts.
        num_steps: Minimum number of steps, including those of earlier runs.
        num_envs: Number of environments in the batch.
        seed: Seed of episodes and actions.
        agent: Name of the policy, for the metadata.
        only_success: Omit episodes whose metric `success` is 0; episodes without that metric are kept.
        max_failures: Maximum number of omitted episodes per recorded one, so that recording of a policy without success
            ends. With n recorded episodes, (n + 1) `max_failures` may be omitted.
        resume: Continue the dataset in the folder, with other episodes.
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.

    Returns:
        Number of steps in the dataset.

    Raises:
        ConfigError: The folder contains a dataset and `resume` is False, or a dataset of another environment; or it
            cannot be written. Or `num_steps`, `num_envs` or `max_failures` is not a whole number of at least 1. Or more
            episodes failed than `max_failures` allows; those that succeeded are in the folder.
        DatasetError: Metadata of the dataset to resume are broken.

    Example:
        >>> record(add_expert(env), "data/RoomNav", num_steps=1_000_000, num_envs=1024)  # doctest: +SKIP
    """
    check_number("num_steps", num_steps, 1, integer=True)
    check_number("num_envs", num_envs, 1, integer=True)
    check_number("max_failures", max_failures, 1, integer=True)
    without = (EXPERT,) if policy is None and isinstance(env.core, ExpertObservationEnv) else ()
    with (
        TrajectoryWriter(Path(folder), env, agent, without, resume) as writer,
        ProgressCount(f"recording {agent}", num_steps, "steps", progress, min(writer.steps, num_steps)) as count,
    ):
        if writer.steps >= num_steps:
            return writer.steps
        batch = _RecordingBatch(env, policy or expert_policy(), num_envs, seed, first=writer.episodes)
        first, num_failed = writer.episodes, 0
        while batch.running.any():
            expected = 0 if only_success else batch.num_running_steps  # running episodes may still fail
            if writer.steps + expected >= num_steps:
                batch.stop_resets()
            for episode, notes in batch.step():
                if only_success and notes.get("success", 1.0) <= 0:
                    num_failed += 1
                    continue
                seen = {name: x for name, x in episode["observations"].items() if name not in without}
                writer.add({**episode, "observations": seen}, notes)
                count.update(len(episode["rewards"]))
            if writer.steps < num_steps:
                _check_failures(num_failed, writer.episodes - first, max_failures)
    return writer.steps


def _check_failures(num_failed: int, num_recorded: int, max_failures: int) -> None:
    """Raise `ConfigError` if more than `max_failures` * (`num_recorded` + 1) episodes of a policy failed."""
    if num_failed > max_failures * (num_recorded + 1):
        raise ConfigError(
            f"of {num_failed + num_recorded} episodes tried, {num_recorded} succeeded and were recorded; expected at "
            f"least one in {max_failures + 1}",
            hint="Use a policy that succeeds more often, an easier task, `max_failures` (`--max-failures`) above "
            f"{max_failures}, or record without `only_success` (`--only-success`).",
        )


class _RecordingBatch:
    """Batch of environments, and the recorded steps of their running episodes."""

    def __init__(self, env: Env[HouseholdEnv], policy: Policy, num: int, seed: int, first: int) -> None:
        self.env, self.policy, self.agents = env, policy, env.num_agents
        self.batch = AutoReset(env.core, final_obs="all")
        keys = jax.random.split(jax.random.fold_in(jax.random.key(seed), first), num)
        episodes = first + jnp.arange(num, dtype=jnp.int32) if is_sequential(env.params.tasks) else None
        with show_compile("reset", env.core.progress):
            state = jax.jit(self.batch.reset)(env.params, jax.random.key_data(keys), None, episodes)
            jax.block_until_ready(state)
        rows = jax.random.key_data(jax.vmap(lambda key: jax.random.split(key, self.agents))(keys)).reshape(-1, 2)
        self.carry = (
            state.replace(info={}),
            policy.initial_memory(num * self.agents),
            rows,
            jnp.ones(num * self.agents, bool),
        )
        self.running, self.last = np.ones(num, bool), False
        self.open = [_RunningEpisode() for _ in range(num)]
        self._begin_episodes(range(num), self._host(state) | {RESET_KEY: np.asarray(jax.random.key_data(keys))})
        self._step: Callable[..., Any] = jax.jit(self._step_all, compiler_options=compiler_options())
        with show_compile("step", env.core.progress):
            self._step: Callable[..., Any] = jax.jit(self._step_all).lower(env.params, self.carry).compile()

    @property
    def num_running_steps(self) -> int:
        """Number of steps so far in running episodes, summed."""
        return sum(len(episode.rewards) for episode, on in zip(self.open, self.running, strict=True) if on)

    def stop_resets(self) -> None:
        """Record no further episode of an environment once its running one is over."""
        self.last = True

    def step(self) -> list[tuple[dict[str, Any], dict[str, Any]]]:
        """Step all environments; return the recorded episodes that ended, each with its notes; begin new ones."""
        self.carry, taken = self._step(self.env.params, self.carry)
        host, ended = self._host(self.carry[0]) | jax.device_get(taken), []
        for i in np.flatnonzero(self.running).tolist():
            over = bool(host["terminated"][i] | host["truncated"][i])
            seen = host["final_obs"] if over else host["obs"]
            self.open[i].add(host, seen, i)
            if over:
                ended.append(self.open[i].pack({name: float(x[i]) for name, x in host["metrics"].items()}))
        over = host["terminated"] | host["truncated"]
        begun = np.flatnonzero(self.running & over).tolist()
        if self.last:
            self.running &= ~over
        else:
            self._begin_episodes(begun, host)
        return ended

    def _begin_episodes(self, which: Any, host: dict[str, Any]) -> None:
        """Begin an episode record of each environment in `which` with its first observation."""
        ids = self.env.bank.house_ids
        for i in which:
            own = {"house": ids[int(host["house"][i])], RESET_KEY: host[RESET_KEY][i].tolist(), ROW: int(host[ROW][i])}
            self.open[i] = _RunningEpisode(self._describe_task(host, i) | own)
            self.open[i].see(host["obs"], i)

    def _describe_task(self, host: dict[str, Any], i: int) -> dict[str, str]:
        """Return `task` and `instruction` of the episode of environment `i`; empty unless its task is a row task."""
        if "task" not in host:
            return {}
        task = self.env.params.tasks.names[int(host["task"][i])]
        return {"task": task, "instruction": describe_goal(task, host["tokens"][i], host["descriptor"][i])}

    def _host(self, state: State) -> dict[str, Any]:
        """Return observations, houses, rows and, of row tasks, columns for `_describe_task`, as NumPy arrays."""
        own = {"obs": state.obs, "house": state.world.house, ROW: state.world.episode}
        if isinstance(state.task, RowState):
            row = {"task": state.task.task, "tokens": state.task.tokens}
            own |= row | {"descriptor": state.task.program.descriptor}
        return jax.device_get(own)

    def _step_all(self, params: EnvParams, carry: tuple) -> tuple[tuple, dict[str, Any]]:
        """Step all environments (jitted); return the next carry, and the step's arrays that are recorded, by name."""
        state, memory, keys, begins = carry
        keys, now = split_keys(keys)
        memory, action, _ = self.policy.act(memory, to_rows(state.obs, self.agents), begins, now)
        action = to_envs(self.policy.clip(action), self.agents)
        new = self.batch.step(params, state, action)
        num = new.done.shape[0]
        taken = {
            "action": action,
            "reward": jnp.mean(new.reward.reshape(num, -1), axis=-1),
            "terminated": new.terminated,
            "truncated": new.truncated,
            "metrics": new.metrics,
            "final_obs": new.info["final_obs"],
            RESET_KEY: jax.vmap(lambda key: jax.random.key_data(fold_key(key, RENEW_TAG)))(state.world.key),
        }
        return (new.replace(info={}), memory, keys, jnp.repeat(new.done, self.agents)), taken


class _RunningEpisode:
    """One running episode."""

    def __init__(self, notes: dict[str, Any] | None = None) -> None:
        self.notes, self.seen = notes or {}, {}
        self.actions, self.rewards, self.terminated, self.truncated = [], [], [], []

    def see(self, obs: dict[str, np.ndarray], i: int) -> None:
        """Append a copy of row `i` of each observation, by name: the batch's memory is reused."""
        for name, values in obs.items():
            self.seen.setdefault(name, []).append(values[i].copy())

    def add(self, host: dict[str, Any], obs: dict[str, np.ndarray], i: int) -> None:
        """Append the step of environment `i` of a batch on the host, and a copy of its observation after the step."""
        self.actions.append(host["action"][i])
        self.rewards.append(host["reward"][i])
        self.terminated.append(host["terminated"][i])
        self.truncated.append(host["truncated"][i])
        self.see(obs, i)

    def pack(self, metrics: dict[str, float]) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the episode in the form of `TrajectoryWriter.add`, and its notes with the final `metrics`."""
        episode = {
            "observations": {name: np.stack(values) for name, values in self.seen.items()},
            "actions": np.stack(self.actions),
            "rewards": np.array(self.rewards),
            "terminations": np.array(self.terminated),
            "truncations": np.array(self.truncated),
        }
        return episode, {**self.notes, **metrics}
