"""Train an agent by PPO or an expert's advice; write checkpoints, curves and figures in houses it has not seen."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import positive_int, seed

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec
    from home_mjx.training import PPOConfig, RunConfig


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx train`."""
    parser.add_argument("task", metavar="TASK", help="id of an environment, such as PointNav; its newest version")
    parser.add_argument("--sensors", default="state,goal", metavar="A,B", help="what is observed (default: state,goal)")
    parser.add_argument("--num-envs", type=positive_int, help="environments in the batch")
    parser.add_argument("--steps", type=positive_int, help="environment steps, over all environments")
    parser.add_argument("--seed", type=seed, default=0, help="of everything random (default: 0)")
    parser.add_argument("--out", type=Path, help="folder for the files (default: runs/TASK)")
    parser.add_argument(
        "--algorithm",
        choices=("ppo", "advised", "clone"),
        default="ppo",
        help="clone: learn from an expert's advice; advised: from rewards and advice (default: ppo)",
    )
    parser.add_argument(
        "--clone-steps", type=positive_int, default=0, metavar="N", help="steps of an expert's advice before PPO's own"
    )
    parser.add_argument("--seconds", type=float, help="end after so many seconds, without those of compiling")
    parser.add_argument("--start", type=Path, metavar="CHECKPOINT", help="begin with the network of a checkpoint")
    parser.add_argument("--resume", action="store_true", help="go on from the folder's checkpoint")
    parser.add_argument("--houses", type=positive_int, default=32, help="how many to train in (default: 32)")
    parser.add_argument("--episodes", type=positive_int, default=1000, help="of the evaluation (default: 1000)")
    parser.add_argument("--held-out", type=positive_int, default=16, help="houses to be evaluated in (default: 16)")
    add_dataset_option(parser)
    for name, what in (("--env", "of the environment, as of make"), ("--ppo", "of PPOConfig")):
        parser.add_argument(name, action="append", default=[], metavar="NAME=VALUE", help=f"an option {what}")


def run(args: argparse.Namespace) -> int:
    """Trains, evaluates, and says where to look."""
    config = run_config(args)
    from home_mjx.cli.learning.table import as_table
    from home_mjx.training import evaluate_checkpoint, train
    from home_mjx.training.checkpoint import CHECKPOINT

    out = make_folder(args.out or Path("runs") / config.env.id)
    train(config, out, args.resume)
    report = evaluate_checkpoint(out / CHECKPOINT, num_houses=args.held_out, num_episodes=args.episodes)
    (out / "evaluation.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(as_table(report) + f"Look at {out / 'curves.png'}\n")
    return 0


def run_config(args: argparse.Namespace) -> "RunConfig":
    """What the arguments ask for."""
    from home_mjx.training import RunConfig

    start = None if args.start is None else str(checkpoint_of(args.start))
    return RunConfig(env_spec(args), ppo_config(args), args.seed, args.algorithm, start, args.clone_steps, args.seconds)


def checkpoint_of(path: Path) -> Path:
    """The file itself, or the checkpoint in the folder of a run."""
    from home_mjx.training import CHECKPOINT  # refuses where the extra `train` is not installed

    return path / CHECKPOINT if path.is_dir() else path


def env_spec(args: argparse.Namespace) -> "EnvSpec":
    """Task and houses."""
    import dataclasses

    from home_mjx.registry import find_spec

    options = {"sensors": tuple(args.sensors.split(",")), **assignments(args.env)}
    known = find_spec(newest(args.task))
    houses = None if args.dataset is None else str(args.dataset)
    return dataclasses.replace(
        known, options={**known.options, **options}, houses=houses, num_houses=args.houses, split="train"
    )


def newest(task: str) -> str:
    """The id of a task, of its newest version if it is named without one.

    Example:
        >>> newest("PointNav-v0")
        'PointNav-v0'
    """
    from home_mjx.registry import list_envs

    versions = [env_id for env_id in list_envs() if env_id.rpartition("-v")[0] == task]
    return max(versions, key=lambda env_id: int(env_id.rpartition("-v")[2]), default=task)


def ppo_config(args: argparse.Namespace) -> "PPOConfig":
    """Options of the training: of the machine's kind, then those that were given."""
    import jax

    from home_mjx.tasks.base.options import override
    from home_mjx.training import CPU_CONFIG, PPOConfig

    given = {"num_envs": args.num_envs, "num_timesteps": args.steps}
    options = {name: value for name, value in given.items() if value is not None} | assignments(args.ppo)
    return override({"": CPU_CONFIG if jax.default_backend() == "cpu" else PPOConfig()}, options)[""]


def assignments(texts: list[str]) -> dict[str, Any]:
    """`NAME=VALUE`, values as JSON or else as text.

    Example:
        >>> assignments(["width=32", "actions=discrete"])
        {'width': 32, 'actions': 'discrete'}
    """
    return {name: _value(text) for name, _, text in (text.partition("=") for text in texts)}


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
