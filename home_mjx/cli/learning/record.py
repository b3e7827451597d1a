"""Record a dataset of whole episodes of an expert, a trained agent or a random one, in Minari's format."""

import argparse
import sys
import time
from pathlib import Path

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.learning.arguments import (
    CHECKPOINT_HELP,
    TASK_HELP,
    add_episode_option,
    add_import_option,
    add_sensors_option,
    find_checkpoint,
    import_modules,
    parse_checkpoint_path,
)
from home_mjx.cli.learning.play import EXPERT, TRAINED, env_spec
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, parse_path, parse_seed, positive_int_type

RECORDED_SENSORS = ("rgb", "state", "instruction")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the optional `TASK`, a text for `task_spec`, and the options of `home-mjx record`.

    `--agent` is `expert` (default), `random` or `trained`. `--checkpoint` is a path or `demo`. `--greedy`,
    `--only-success` and `--resume` are flags, and `--out` is the path of a folder or None.

    `--frames` (10000), `--num-envs` (64), `--max-failures` (1000) and `--houses` (32) are from 1. `--seed` is from 0 to
    2**32 - 1 (0). `--split` is `train` (default), `val` or `test`.

    The repeatable `--env NAME=VALUE` is a list of texts. `--dataset` is as in `add_dataset_option`. `--episode-file`,
    `--import` and `--sensors` are as in `learning.arguments`.
    """
    parser.add_argument("task", nargs="?", metavar="TASK", help=f"{TASK_HELP} (default: the checkpoint's)")
    parser.add_argument(
        "--agent", choices=(EXPERT, "random", TRAINED), default=EXPERT, help="agent that acts (default: expert)"
    )
    parser.add_argument("--checkpoint", type=parse_checkpoint_path, help=f"for the agent `trained`: {CHECKPOINT_HELP}")
    parser.add_argument("--greedy", action="store_true", help="take a trained agent's most likely action")
    add_sensors_option(parser, "recorded sensors (default: rgb,state,instruction)")
    parser.add_argument(
        "--frames", type=positive_int_type, default=10_000, help="minimum number of steps (default: 10000)"
    )
    parser.add_argument(
        "--num-envs", type=positive_int_type, default=64, help="environments in the batch (default: 64)"
    )
    parser.add_argument("--only-success", action="store_true", help="omit episodes without success")
    parser.add_argument(
        "--max-failures",
        type=positive_int_type,
        default=1000,
        help="with --only-success: maximum number of omitted episodes per recorded one (default: 1000)",
    )
    parser.add_argument("--resume", action="store_true", help="continue the dataset in the folder")
    parser.add_argument("--out", type=parse_path, help="folder of the dataset (default: data/TASK)")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of episodes and actions (default: 0)")
    parser.add_argument("--houses", type=house_count_type, default=32, help="number of houses (default: 32)")
    parser.add_argument(
        "--split", choices=("train", "val", "test"), default="train", help="split of the dataset (default: train)"
    )
    add_episode_option(parser)
    add_dataset_option(parser)
    add_import_option(parser)
    parser.add_argument("--env", action="append", default=[], metavar="NAME=VALUE", help="an option of home_mjx.make")


def run(args: argparse.Namespace) -> int:
    """Record whole episodes until they have at least `--frames` steps in all; print one line, and return 0.

    It has steps, number of episodes in the dataset, folder and seconds. Without `--sensors`, those of the checkpoint
    are recorded, or `RECORDED_SENSORS` if there is none. The folder is by default `data/TASK`.
    """
    from home_mjx.env_factory import make
    from home_mjx.tasks import add_expert
    from home_mjx.training.trajectories import Trajectories, record
    from home_mjx.viewer.episodes.policies import check_agent, make_policy

    import_modules(args.modules)
    path = args.checkpoint and find_checkpoint(args.checkpoint)
    check_agent(args.agent, path)
    spec = env_spec(args, path, args.sensors or (RECORDED_SENSORS if path is None else None))
    out = make_folder(args.out or Path("data") / spec.id)
    env = make(spec)
    env = add_expert(env) if args.agent == EXPERT else env
    policy = None if args.agent == EXPERT else make_policy(env, args.agent, path, args.greedy)
    begun = time.perf_counter()
    steps = record(
        env, out, policy, num_steps=args.frames, num_envs=args.num_envs, seed=args.seed, agent=args.agent,
        only_success=args.only_success, max_failures=args.max_failures, resume=args.resume,
    )  # fmt: skip
    took = f"{time.perf_counter() - begun:.0f} s, including compilation"
    sys.stdout.write(f"{steps} steps of {len(Trajectories(out))} episodes in {out / 'data'}; {took}\n")
    return 0
