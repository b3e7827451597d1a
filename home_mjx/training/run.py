"""A training run from options to files: checkpoints, records, and an evaluation in houses never trained in."""

import dataclasses
import time
from pathlib import Path
from typing import Any

import jax

from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec
from home_mjx.tasks.environment.bound import BoundEnv
from home_mjx.tasks.environment.household import HouseholdEnv
from home_mjx.training.checkpoint import CHECKPOINT, check_same, load_checkpoint, load_net, read_config, save_checkpoint
from home_mjx.training.cloning import Cloning
from home_mjx.training.config import RunConfig
from home_mjx.training.evaluation import evaluate, random_policy, summary
from home_mjx.training.ppo import PPO, TrainState
from home_mjx.training.progress import Clock, Sums, progress_bar
from home_mjx.training.records import Records

LEARNERS: dict[str, type[PPO]] = {"ppo": PPO, "clone": Cloning}
NUM_LINES, NUM_CHECKPOINTS = 200, 20  # of a run
SHOWN = ("success", "return")  # beside the progress bar


def train(config: RunConfig, out: Path, resume: bool = False, progress: bool | None = None) -> PPO:
    """Trains, and writes to a folder.

    `metrics.jsonl` has one line for every two-hundredth of the run, `checkpoint.npz` the latest of twenty checkpoints,
    `curves.png` the figures over steps, `tensorboard/` the same for TensorBoard.

    Args:
        config: Options.
        out: The folder, which exists.
        resume: Go on from its checkpoint if it has one; a run that was killed then gives what it would have given.
        progress: Show a progress bar; None: in a terminal.

    Returns:
        The trainer; its parameters are in the checkpoint.

    Raises:
        ConfigError: The folder holds a run and `resume` is False, or a run of another configuration.
        DatasetError: The network of `config.start` is for other observations, actions or sizes.
    """
    path = out / CHECKPOINT
    if path.exists() and not resume:
        hint = "Add --resume to go on with it, or choose another folder by --out."
        raise ConfigError("the folder holds a training run", file=path, hint=hint)
    if path.exists():
        check_same(read_config(path), config, path)
    env = made(config.env, progress)
    ppo, key = LEARNERS[config.algorithm](env.core, config.ppo), jax.random.key(config.seed)
    params = jax.device_put(env.params, ppo.whole)
    state = ppo.init(params, key)
    if config.start is not None:
        state = ppo.place(state.replace(net=load_net(config.start, state.net)))
    if path.exists():
        state = ppo.place(load_checkpoint(path, state, config))
    _learn(ppo, params, state, config, out, progress)
    return ppo


def _learn(ppo: PPO, params: Any, state: TrainState, config: RunConfig, out: Path, progress: bool | None) -> None:
    """Updates until the last."""
    size, num = config.ppo.batch_size, config.ppo.num_updates
    per_line = max(1, num // NUM_LINES)
    per_checkpoint = per_line * max(1, num // NUM_CHECKPOINTS // per_line)
    done = int(state.updates)
    with Records(out, done * size) as records, progress_bar(done * size, num * size, progress) as bar:
        clock, sums = Clock(records.lines[-1] if records.lines else {}), Sums()
        update = ppo.update.lower(params, state).compile()
        clock.start(done * size)
        for i in range(done + 1, num + 1):
            state, metrics = update(params, state)
            sums.add(metrics)
            bar.update(size)
            if i % per_line == 0 or i == num:
                line = {"steps": i * size, **clock.lap(i * size), **sums.means()}
                records.add(line)
                bar.set_postfix({name: f"{line[name]:.2f}" for name in SHOWN if name in line})
            if i % per_checkpoint == 0 or i == num:
                save_checkpoint(out / CHECKPOINT, state, config)
                records.draw()


def evaluate_checkpoint(
    path: Path, split: str | None = "val", num_houses: int = 16, num_episodes: int = 1000, seed: int = 0,
    greedy: bool = False, progress: bool | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Plays episodes with a checkpoint's agent, and the same ones with an agent that acts at random.

    Args:
        path: The checkpoint.
        split: Houses of which part of the dataset; a run trains in `train`. None: those that it has trained in.
        num_houses: How many.
        num_episodes: How many.
        seed: Of episodes and actions.
        greedy: The agent does what is likeliest, instead of drawing its actions.
        progress: Show a progress bar while houses are compiled.

    Returns:
        `trained` and `random`, each a `summary`, and what was asked for.
    """
    config = read_config(path)
    spec = config.env if split is None else dataclasses.replace(config.env, split=split, num_houses=num_houses)
    env = made(spec, progress)
    ppo = PPO(env.core, config.ppo, jax.devices()[:1])
    net = load_net(path, jax.eval_shape(ppo.agent.init_net, jax.random.key(0)))
    begun = time.perf_counter()
    trained = evaluate(env, lambda net: ppo.policy(net, greedy), net, num_episodes, seed)
    chance = evaluate(env, random_policy(env.core), None, num_episodes, seed)
    return {
        "trained": summary(trained),
        "random": summary(chance),
        "episodes": num_episodes,
        "houses": env.bank.num_houses,
        "split": spec.split,
        "seed": seed,
        "actions": "greedy" if greedy else "sampled",
        "seconds": time.perf_counter() - begun,
        "device": jax.devices()[0].device_kind,
    }


def made(spec: EnvSpec, progress: bool | None = None) -> BoundEnv[HouseholdEnv]:
    """The environment.

    Raises:
        ConfigError: Its houses exist in memory only.
    """
    spec.to_json()
    return spec.make(progress)
