"""Training runs from options to files: checkpoints, records, and evaluation in held-out houses."""

import dataclasses
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.stages import Compiled

from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.progress import ProgressPhase, show_compile, silence
from home_mjx.core.workers import usable_cores, worker_threads
from home_mjx.env_factory import make, make_core
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.hosts import agree, check_same, is_leader, local_part
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import Observer, ObserverGroup, RunStart, resolve_observers
from home_mjx.tasks.language.instruction_kinds import failures_by_kind
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.training.checkpoint import (
    AGENT_FILE,
    CHECKPOINT_FILE,
    CLONED_FILE,
    DIVERGED_HINT,
    check_same_config,
    is_finite,
    load_checkpoint,
    load_net,
    load_policy,
    read_config,
    read_updates,
    save_checkpoint,
    save_net,
)
from home_mjx.training.config import RunConfig
from home_mjx.training.early_warnings import EarlyWarnings
from home_mjx.training.evaluation import check_episodes, evaluate, evaluation_spec, random_policy, summarize
from home_mjx.training.held_out import HeldOutRollout
from home_mjx.training.imitation import AdvisedPPO, BehaviorCloning
from home_mjx.training.metrics_log import CurvesPlot, MetricsLog, TensorBoardLog
from home_mjx.training.ppo import PPO, TrainState
from home_mjx.training.progress import MetricMeans, ProgressBar, RunClock

LEARNERS: dict[str, type[PPO]] = {"ppo": PPO, "advised": AdvisedPPO, "clone": BehaviorCloning}
MIN_LINES_PER_STAGE = 200  # minimum number of metrics lines per stage; shorter stages have one per update
MIN_CHECKPOINT_INTERVAL = 20.0  # [s] minimum time between checkpoints
MAX_VALIDATION_ENVS = 128  # maximum number of environments in held-out houses during training
DEFAULT_EPISODES = 1000  # default number of episodes of an evaluation
SHARED_HINT = "Pass a folder with --out that all hosts share."


def train(
    config: RunConfig, out: Path, resume: bool = False, progress: bool | None = None,
    device_lock: AbstractContextManager[Any] | None = None, observers: Iterable[Observer | str] = (),
    devices: Sequence[Any] | None = None,
) -> PPO:  # fmt: skip
    """Train and write the results to a folder.

    All programs are compiled first. `metrics.jsonl` has at least 200 lines per stage or one per update.
    `checkpoint.npz` is the latest checkpoint, `curves.png` shows the metrics over steps, and `tensorboard/` has the
    same for TensorBoard. `agent.npz` is the network alone at the end of the run; `cloned.npz` is the network after
    cloning.

    With several processes, see `hosts.connect`, every one calls it with the same arguments. The leader alone writes
    files, tells observers and reads the clock.

    Args:
        config: Options.
        out: The folder, which exists; with several processes all hosts share it.
        resume: Continue from the folder's checkpoint if there is one; the result equals that of an uninterrupted run.
        progress: Show what happens; None: by the rule of `home_mjx.core.progress`.
        device_lock: Context entered after compilation and left at the end, such as a lock of the device, so that
            measured training time excludes other processes that compile.
        observers: Further observers of the run, or their names.
        devices: Devices to train on; all of JAX's by default, of all hosts.

    Returns:
        The trainer; its parameters are in the checkpoint.

    Raises:
        ConfigError: The folder contains a run and `resume` is False, or a run of another configuration.
        DatasetError: The network of `config.start` is for other observations, actions or sizes; or a file of the run is
            broken. Nothing has been written in this case.
        ConfigError: Files cannot be written, such as on a full disk, or the training has diverged; earlier files stay.
        UnknownNameError: A name in `observers` is unknown.
    """
    path, size = out / CHECKPOINT_FILE, config.ppo.batch_size
    devices = list(devices or jax.devices())
    done = _updates_done(path, config, resume, len(devices))
    own, clock = _own_observers(out, done * size, progress)
    more = resolve_observers(observers) if is_leader() else ()
    env = make_env(config.env, progress)
    with show_compile("the training update", progress):
        stages = _compile_stages(config, env, done, path, devices)
        held_out = _make_held_out(config, stages[-1], progress)
    with ObserverGroup((*own, *more)) as group, device_lock or nullcontext():
        group.on_run_start(RunStart(config.algorithm, env, "steps", stages[-1].last * size, done * size))
        clock.start(done * size)
        run, net = _Run(config, path, group, clock, held_out), None
        for stage in stages:
            net = run.learn(stage, net)
            if stage is not stages[-1]:
                save_net(out / CLONED_FILE, net, config)
    save_net(out / AGENT_FILE, net, config)
    agree(np.int32(0))  # the others wait for the leader's last file
    return stages[-1].ppo


def _own_observers(out: Path, steps: int, progress: bool | None) -> tuple[tuple[Observer, ...], RunClock]:
    """Return the observers of every run, which write to a folder, and its clock; a process beside the leader has none.

    Metrics of the folder after `steps` environment steps are dropped.
    """
    if not is_leader():
        return (), RunClock({})
    log = MetricsLog(out, steps)
    others = TensorBoardLog(out / "tensorboard", steps), CurvesPlot(log), ProgressBar(progress), EarlyWarnings()
    return (log, *others), RunClock(log.lines[-1] if log.lines else {})


def _updates_done(path: Path, config: RunConfig, resume: bool, num_devices: int) -> int:
    """Return the number of updates in the run's checkpoint, 0 if there is none; validate before houses are compiled.

    Raises:
        ConfigError: There is a checkpoint but `resume` is False, or its configuration differs; or as in
            `PPOConfig.check_devices`, even without a checkpoint.
        DatasetError: The checkpoint is broken, or has more updates than the run; or there is none, and `config.start`
            is missing or broken.
        ConfigError: Only some of several processes find the checkpoint.
    """
    core = make_core(config.env)
    for _, options in config.stages:
        if core is not None:
            options.check_devices(num_devices, core.num_agents)
    check_same(path.exists(), "files in the run's folder (1: a checkpoint, 0: none)", SHARED_HINT)
    if not path.exists():
        if config.start is not None:
            read_config(config.start)
        return 0
    if not resume:
        hint = "Add --resume to continue it, or choose another folder with --out."
        raise ConfigError("the folder contains a training run", file=path, hint=hint)
    check_same_config(read_config(path), config, path)
    done, whole = read_updates(path), sum(options.num_updates for _, options in config.stages)
    if done > whole:
        hint = "The file was changed, or written by another version; train into another folder with --out."
        raise DatasetError(f"checkpoint has {done} updates, the run only {whole}", file=path, hint=hint)
    return done


@dataclass
class _Stage:
    """Updates of one algorithm, compiled and ready to run.

    Attributes:
        number: Place among the stages of the configuration.
        ppo: The learner.
        params: Houses and tasks, on the learner's devices.
        update: The compiled update.
        first: Updates of the run before this stage.
        last: Updates of the run after it.
        state: Initial state; with fresh parameters if an earlier stage runs first.
    """

    number: int
    ppo: PPO
    params: Any
    update: Any
    first: int
    last: int
    state: Any = None


def _compile_stages(
    config: RunConfig, env: Env[HouseholdEnv], done: int, path: Path, devices: Sequence[Any]
) -> list[_Stage]:
    """Compile in parallel, and return in order, the stages not complete after `done` updates; at least the last.

    `path` is the run's checkpoint file.
    """
    found, last = [], 0
    with worker_threads(usable_cores()) as pool:
        for number, (algorithm, options) in enumerate(config.stages):
            first, last = last, last + options.num_updates
            if done >= last and number < len(config.stages) - 1:
                continue
            ppo = LEARNERS[algorithm](env.core, options, devices)
            ppo.first_update = first
            params = ppo.sharding.put_params(env.params)
            reset, update = (pool.submit(program.compile, compiler_options()) for program in ppo.lower(params))
            found.append((_Stage(number, ppo, params, update, first, last), reset))
        for stage, reset in found:
            stage.state = _initial_state(config, stage, reset.result(), done, path)
            stage.update = stage.update.result()
    return [stage for stage, _ in found]


def _initial_state(config: RunConfig, stage: _Stage, reset: Compiled, done: int, path: Path) -> TrainState:
    """Return the state of a stage before its next update, with the compiled `reset` of its environments.

    A stage in progress has its state of the checkpoint `path`. A new first stage begins with the network of
    `config.start`, if any. A stage that begins just after the checkpoint has the network of that. Others have fresh
    parameters, which `_Run.learn` replaces by those of the stage before.
    """
    ppo, key = stage.ppo, jax.random.key(config.seed)
    state = ppo.init(stage.params, jax.random.fold_in(key, stage.number) if stage.number else key, reset)
    before = config.start if stage.number == 0 else path if done == stage.first else None
    if before is not None:
        state = state.replace(net=load_net(before, state.net))
    new = done <= stage.first
    state = state.replace(updates=jnp.int32(stage.first)) if new else load_checkpoint(path, state, config)
    return ppo.to_devices(state)


def _make_held_out(config: RunConfig, stage: _Stage, progress: bool | None) -> HeldOutRollout | None:
    """Compile the held-out evaluation of a run with the network of its last stage; None without `validation_houses`."""
    if not config.validation_houses:
        return None
    env = make_env(evaluation_spec(config.env, num_houses=config.validation_houses), progress)
    num_envs = min(MAX_VALIDATION_ENVS, config.ppo.num_envs)
    return HeldOutRollout(env, stage.ppo.policy, stage.state.net, num_envs, config.ppo.unroll_length, config.seed)


@dataclass
class _Run:
    """Checkpoint file, observers, clock and held-out evaluation of a run."""

    config: RunConfig
    path: Path
    observers: Observer
    clock: RunClock
    held_out: HeldOutRollout | None = None

    def learn(self, stage: _Stage, net: Any) -> Any:
        """Run a stage to its end or the time limit from `net` (None: its own); log, save checkpoints; return net.

        Checkpoints are at least `MIN_CHECKPOINT_INTERVAL` apart, except the last one. Beyond the time limit no update
        is made but the first of the whole run. Raises `ConfigError` before a checkpoint if parameters are not finite.
        """
        size, num, sums = stage.ppo.config.batch_size, stage.last - stage.first, MetricMeans()
        per_line = max(1, num // MIN_LINES_PER_STAGE)
        saved = -MIN_CHECKPOINT_INTERVAL
        state = stage.state if net is None else stage.ppo.to_devices(stage.state.replace(net=net))
        over = self.decide(saved)[0] and bool(state.updates)  # a run makes at least one update
        for i in range(int(state.updates) + 1, stage.last + 1):
            if over:
                break
            state, metrics = stage.update(stage.params, state)
            if self.held_out is not None:
                self.held_out.advance(state.net)
            sums.add(metrics)
            self.observers.on_update(size)
            self.observers.on_states(local_part(state.actor.env))
            over, is_due = self.decide(saved)
            ends = i == stage.last or over
            if (i - stage.first) % per_line == 0 or ends:
                # Written before the checkpoint, because a resumed run drops the lines after it.
                others = {} if self.held_out is None else self.held_out.means()
                self.observers.on_log({"steps": i * size, **self.clock.lap(i * size), **sums.means(), **others})
            if ends or is_due:
                if not is_finite(state.net):
                    hint = f"{DIVERGED_HINT} The last checkpoint, if there is one, is from before it diverged."
                    message = f"after {i * size} steps the network has numbers that are not finite"
                    raise ConfigError(message, hint=hint)
                save_checkpoint(self.path, state, self.config)
                self.observers.on_checkpoint(self.path, i * size)
                saved = self.clock.elapsed()
        return state.net

    def decide(self, saved: float) -> tuple[bool, bool]:
        """Return whether the time limit `max_seconds` is reached, and whether a checkpoint is due.

        The leader's clock counts. `saved` is when the last checkpoint was written [s]. Without a limit the first is
        False.
        """
        now, limit = self.clock.elapsed(), self.config.max_seconds
        over, is_due = limit is not None and now >= limit, now >= saved + MIN_CHECKPOINT_INTERVAL
        told = agree(np.array([over, is_due], np.int32))
        return bool(told[0]), bool(told[1])


def evaluate_checkpoint(
    path: Path, split: str | None = "val", num_houses: int = 16, num_episodes: int | None = None, seed: int = 0,
    greedy: bool = False, progress: bool | None = None, *, episode_file: str | Path | None = None,
    dataset: str | Path | None = None, options: Mapping[str, Any] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Evaluate a checkpoint's agent, and a random agent on the same episodes.

    Args:
        path: The checkpoint.
        split: Split of the dataset that houses are from; training uses `train`. None: the houses of training. Options
            that only ease training are removed in either case.
        num_houses: Number of houses.
        num_episodes: Number of episodes; None: 1000, or all of `episode_file`.
        seed: Seed of episodes and actions.
        greedy: Take the most likely action instead of sampling.
        progress: Show what happens; None: by the rule of `home_mjx.core.progress`.
        episode_file: Episodes, in the houses that they name; `split` and `num_houses` have no effect then.
        dataset: Root of a dataset other than that of training.
        options: Options of the environment that differ from those of training, such as held-out sounds.

    Returns:
        `trained` and `random`, each a `summarize`, and the settings of the evaluation. With instructions also `kinds`,
        see `failures_by_kind`.

    Raises:
        ConfigError: As in `load_policy`, `evaluate` and `home_mjx.make`.
        DatasetError: As in `load_policy`; or the houses or `episode_file` cannot be read.
    """
    check_episodes(DEFAULT_EPISODES if num_episodes is None else num_episodes)
    spec = evaluation_spec(read_config(path).env, split, num_houses, episode_file=episode_file, dataset=dataset)
    spec = dataclasses.replace(spec, options={**spec.options, **(options or {})})
    env = make_env(spec, progress)
    if num_episodes is None:
        num_episodes = DEFAULT_EPISODES if episode_file is None else len(env.params.tasks)
    policy = load_policy(path, env.core, greedy)
    begun = time.perf_counter()
    with ProgressPhase(f"compiling and playing {num_episodes} episodes with the trained agent", progress), silence():
        trained = evaluate(env, *policy, num_episodes, seed)
    with ProgressPhase(f"compiling and playing {num_episodes} episodes with a random agent", progress), silence():
        chance = evaluate(env, random_policy(env.core), None, num_episodes, seed)
    return {
        "trained": summarize(trained),
        "random": summarize(chance),
        "episodes": num_episodes,
        "houses": env.bank.num_houses,
        "split": spec.split if episode_file is None else str(episode_file),
        "seed": seed,
        "actions": "greedy" if greedy else "sampled",
        "seconds": time.perf_counter() - begun,
        "device": jax.devices()[0].device_kind,
        **_kinds(env, trained),
    }


def _kinds(env: Env[HouseholdEnv], results: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Return `kinds`, the ends of episodes by kind of instruction; nothing for tasks without instructions."""
    tasks = env.params.tasks
    has_kinds = isinstance(tasks, TaskBank) and "stage" in results
    tokens = tasks.rows.columns["tokens"] if has_kinds else np.zeros((0, 0))
    return {"kinds": failures_by_kind(results, np.asarray(tokens))} if np.any(tokens) else {}


def make_env(spec: EnvSpec, progress: bool | None = None) -> Env[HouseholdEnv]:
    """Build the environment of a spec; raise `ConfigError` if its houses exist in memory only."""
    spec.to_json()
    return make(spec, progress=progress)
