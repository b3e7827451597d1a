"""Train an agent with PPO or on an expert's advice; write checkpoints, curves, and metrics in held-out houses."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.learning.arguments import (
    CHECKPOINT_HELP,
    TASK_HELP,
    add_import_option,
    add_observe_option,
    add_sensors_option,
    add_viewer_option,
    find_checkpoint,
    import_modules,
    job_viewers,
    parse_checkpoint_path,
    task_spec,
)
from home_mjx.cli.learning.recipes import changed_options, expand_recipe, find_run, read_recipe
from home_mjx.cli.learning.results import format_card, format_evaluation
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, parse_path, parse_seed, positive_int_type, whole_number_type
from home_mjx.core.jsonable import parse_assignments
from home_mjx.errors import ConfigError

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec
    from home_mjx.training import PPOConfig, RunConfig

MAX_STEPS = 10**15
MAX_HOUSES = 10_000  # maximum number of houses that are played during training
MAX_PROCESS = 99_999  # maximum index of a process
TRAINED_SENSORS = ("state", "goal")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `TASK`, a text for `task_spec`, and the options of `home-mjx train`.

    `--recipe` is a name, a path or None; `expand_arguments` has put the recipe's own arguments in front.

    `--algorithm` is `ppo` (default), `advised` or `clone`. `--start CHECKPOINT` is a path or `demo`, or None. `--out`
    is the path of a folder or None. `--resume` is a flag.

    `--num-envs` and `--steps` are from 1, or None for the defaults of `ppo_config`. `--clone-steps` and `--validate`
    are from 1, 0 by default. `--seconds` is any number or None. `--houses` (32), `--episodes` (1000) and `--held-out`
    (16) are from 1.
    `--seed` is from 0 to 2**32 - 1 (0).

    The repeatable `--env NAME=VALUE` and `--ppo NAME=VALUE` are lists of texts. `--dataset` is as in
    `add_dataset_option`. `--import`, `--observe` and `--sensors` are as in `learning.arguments`.
    """
    parser.add_argument("task", metavar="TASK", help=TASK_HELP)
    parser.add_argument(
        "--recipe", metavar="NAME", help="take the task and all options that are not given from a recipe"
    )
    add_sensors_option(parser, "observed sensors (default: state,goal)")
    parser.add_argument(
        "--num-envs", type=positive_int_type, help="environments in the batch (default: 2048; 64 on CPUs)"
    )
    parser.add_argument(
        "--steps",
        type=whole_number_type(MAX_STEPS),
        help="environment steps, summed over all environments (default: 50 million; 1 million on CPUs)",
    )
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of all random numbers (default: 0)")
    parser.add_argument("--out", type=parse_path, help="folder for the files (default: runs/TASK)")
    parser.add_argument(
        "--algorithm",
        choices=("ppo", "advised", "clone"),
        default="ppo",
        help="clone: learn from an expert's advice; advised: from rewards and advice (default: ppo)",
    )
    parser.add_argument(
        "--clone-steps",
        type=whole_number_type(MAX_STEPS),
        default=0,
        metavar="N",
        help="environment steps of cloning an expert before PPO",
    )
    parser.add_argument("--seconds", type=float, help="time limit of training without compilation [s]")
    parser.add_argument(
        "--start", type=parse_checkpoint_path, metavar="CHECKPOINT", help=f"start with the network of {CHECKPOINT_HELP}"
    )
    parser.add_argument("--resume", action="store_true", help="continue from the folder's checkpoint")
    parser.add_argument("--houses", type=house_count_type, default=32, help="number of training houses (default: 32)")
    parser.add_argument(
        "--episodes", type=positive_int_type, default=1000, help="number of evaluation episodes (default: 1000)"
    )
    parser.add_argument(
        "--held-out", type=house_count_type, default=16, help="number of evaluation houses (default: 16)"
    )
    parser.add_argument(
        "--validate", type=whole_number_type(MAX_HOUSES), default=0, metavar="N",
        help="play in N held-out houses during training: metrics held_out/... (default: none)",
    )  # fmt: skip
    _add_device_options(parser)
    add_dataset_option(parser)
    add_import_option(parser)
    add_viewer_option(parser)
    add_observe_option(parser, "one of your own")
    for name, what in (("--env", "of home_mjx.make"), ("--ppo", "of PPOConfig")):
        parser.add_argument(name, action="append", default=[], metavar="NAME=VALUE", help=f"an option {what}")


def _add_device_options(parser: argparse.ArgumentParser) -> None:
    """Add `--devices`, a number or None for all, and for several hosts `--coordinator`, `--processes` and `--process`.

    The last three are None by default, too.
    """
    parser.add_argument(
        "--devices", type=parse_devices, metavar="N",
        help="number of devices to train on, or all, of all hosts (default: all)",
    )  # fmt: skip
    parser.add_argument(
        "--coordinator", metavar="HOST:PORT",
        help="address of the first of several processes, one per host or device; auto: by the variables of SLURM",
    )  # fmt: skip
    parser.add_argument("--processes", type=positive_int_type, metavar="N", help="number of processes")
    parser.add_argument("--process", type=parse_process, metavar="I", help="index of this process")


def parse_devices(text: str) -> int | None:
    """Return the number of devices of a text; None for "all"."""
    return None if text == "all" else positive_int_type(text)


def parse_process(text: str) -> int:
    """Parse an index from 0 to `MAX_PROCESS`; raise `ArgumentTypeError` for others."""
    return 0 if text == "0" else whole_number_type(MAX_PROCESS)(text)


def expand_arguments(argv: list[str]) -> list[str]:
    """Return the arguments with those of `--recipe` in front; raises as `expand_recipe`."""
    return expand_recipe(argv)


def run(args: argparse.Namespace) -> int:
    """Train, evaluate in held-out houses, write `evaluation.json` and `card.md`, print the results, and return 0.

    The results are the table of `format_evaluation` and the path of `curves.png`. All files are in `--out`, by default
    `runs/TASK`. The numbers of evaluation episodes and houses are checked before training.

    Several processes only train: devices of other hosts would wait for the evaluation. The leader prints its command.
    """
    import_modules(args.modules)
    connect_processes(args)
    config = run_config(args)
    from home_mjx.core.files import write_durably
    from home_mjx.hosts import is_leader, num_processes
    from home_mjx.training import evaluate_checkpoint, train
    from home_mjx.training.evaluation import check_episodes

    check_episodes(args.episodes)
    check_held_out(config.env, args.held_out)
    recipe = None if args.recipe is None else read_recipe(args.recipe)
    if recipe is not None:
        lines = [
            f"changed against the recipe {recipe.name}: {x}\n" for x in changed_options(args, recipe, add_arguments)
        ]
        sys.stdout.write("".join(lines))
    out = make_folder(args.out or (Path("runs") / config.env.id if recipe is None else find_run(recipe)))
    devices = select_devices(args.devices)
    train(config, out, args.resume, observers=[*args.observers, *job_viewers(args)], devices=devices)
    if num_processes() > 1:
        sys.stdout.write(f"Evaluate with: home-mjx evaluate {out}\n" if is_leader() else "")
        return 0
    report = evaluate_checkpoint(find_checkpoint(out), num_houses=args.held_out, num_episodes=args.episodes)
    with write_durably(out / "evaluation.json", "evaluation") as file:
        file.write(json.dumps(report, indent=1).encode() + b"\n")
    with write_durably(out / "card.md", "card") as file:
        file.write(format_card(config, report).encode())
    sys.stdout.write(format_evaluation(report) + f"Look at {out / 'curves.png'}\n")
    return 0


def connect_processes(args: argparse.Namespace) -> None:
    """Connect this process with those of `--coordinator`; nothing without it.

    Raises:
        ConfigError: `--processes` or `--process` is given alone; or as in `hosts.connect`.
    """
    if args.coordinator is None:
        if args.processes is not None or args.process is not None:
            hint = "Add --coordinator HOST:PORT, the address of process 0."
            raise ConfigError("--processes and --process need the address of a coordinator", hint=hint)
        return
    from home_mjx.hosts import connect

    connect(args.coordinator, args.processes, args.process)


def select_devices(num: int | None) -> list[Any]:
    """Return the first `num` of JAX's devices, those of all hosts; None: all.

    Raises:
        ConfigError: There are fewer; or a process of several would have none.
    """
    import jax

    found = jax.devices()
    if num is None or num == len(found):
        return found
    if num > len(found):
        raise ConfigError(f"expected at most {len(found)} devices, got {num}", element="devices")
    if jax.process_count() > 1:
        hint = "Leave --devices out, and start fewer processes."
        raise ConfigError(f"several processes use all of their {len(found)} devices, not {num}", hint=hint)
    return found[:num]


def check_held_out(spec: "EnvSpec", num_houses: int) -> None:
    """Raise `ConfigError`, before training, if the dataset has no house in the evaluation's split.

    `num_houses`: maximum number of houses to evaluate on; fewer suffice. Specs without `houses` pass.
    """
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.training.evaluation import evaluation_spec

    others = evaluation_spec(spec, num_houses=num_houses)
    if others.houses is not None:
        _ = HouseSet.coerce(others.houses, split=others.split, num_houses=others.num_houses).house_ids


def run_config(args: argparse.Namespace) -> "RunConfig":
    """Return the configuration of the training run from the arguments; `--start` of a run's folder is its checkpoint.

    Raises:
        ConfigError: The task or an option is unknown, or a value is invalid.
    """
    from home_mjx.training import RunConfig

    start = None if args.start is None else str(find_checkpoint(args.start))
    schedule = start, args.clone_steps, args.seconds
    return RunConfig(env_spec(args), ppo_config(args), args.seed, args.algorithm, *schedule, args.validate)


def env_spec(args: argparse.Namespace) -> "EnvSpec":
    """Return the named task's spec with `--sensors` (by default `TRAINED_SENSORS`) and `--env`, for split `train`.

    `--env` overrides `--sensors`; both override the spec's own options. `num_houses` is that of `--houses`. `houses` is
    that of `--dataset`; without it None, whatever the spec has.
    """
    import dataclasses

    options = {"sensors": args.sensors or TRAINED_SENSORS, **parse_assignments(args.env)}
    known = task_spec(args.task)
    houses = None if args.dataset is None else str(args.dataset)
    return dataclasses.replace(
        known, options={**known.options, **options}, houses=houses, num_houses=args.houses, split="train"
    )


def ppo_config(args: argparse.Namespace) -> "PPOConfig":
    """Return the training options: defaults of the platform, overridden by `--num-envs` and `--steps`, then `--ppo`.

    The defaults are `CPU_CONFIG` where JAX's default backend is the CPU, else those of `PPOConfig`.
    """
    import jax

    from home_mjx.tasks.base.options import override_options
    from home_mjx.training import CPU_CONFIG, PPOConfig

    given = {"num_envs": args.num_envs, "num_timesteps": args.steps}
    options = {name: value for name, value in given.items() if value is not None} | parse_assignments(args.ppo)
    return override_options({"": CPU_CONFIG if jax.default_backend() == "cpu" else PPOConfig()}, options)[""]
