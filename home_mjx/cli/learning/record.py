"""Write a data set of whole episodes of an expert, a trained agent or chance, in Minari's format."""

import argparse
import sys
import time
from pathlib import Path

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.learning.named import (
    CHECKPOINT_HELP,
    TASK_HELP,
    add_episode_option,
    add_import_option,
    checkpoint_of,
    checkpoint_path,
    import_modules,
)
from home_mjx.cli.learning.play import EXPERT, TRAINED, env_spec
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import file_path, house_count, positive_int, seed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx record`."""
    parser.add_argument("task", nargs="?", metavar="TASK", help=f"{TASK_HELP} (default: the checkpoint's)")
    parser.add_argument("--agent", choices=(EXPERT, "random", TRAINED), default=EXPERT, help="default: expert")
    parser.add_argument("--checkpoint", type=checkpoint_path, help=f"of the agent `trained`: {CHECKPOINT_HELP}")
    parser.add_argument("--greedy", action="store_true", help="a trained agent does what is likeliest")
    parser.add_argument("--sensors", metavar="A,B", help="what is kept (default: rgb,state,instruction)")
    parser.add_argument("--frames", type=positive_int, default=10_000, help="at least so many steps (default: 10000)")
    parser.add_argument("--num-envs", type=positive_int, default=64, help="environments at once (default: 64)")
    parser.add_argument("--only-success", action="store_true", help="leave out episodes without success")
    parser.add_argument("--resume", action="store_true", help="go on with what the folder holds")
    parser.add_argument("--out", type=file_path, help="folder (default: data/TASK)")
    parser.add_argument("--seed", type=seed, default=0, help="of episodes and actions (default: 0)")
    parser.add_argument("--houses", type=house_count, default=32, help="how many (default: 32)")
    parser.add_argument(
        "--split", choices=("train", "val", "test"), default="train", help="part of the dataset (default: train)"
    )
    add_episode_option(parser)
    add_dataset_option(parser)
    add_import_option(parser)
    parser.add_argument(
        "--env", action="append", default=[], metavar="NAME=VALUE", help="an option of the environment, as of make"
    )


def run(args: argparse.Namespace) -> int:
    """Records, and says where to look."""
    from home_mjx.tasks import with_expert
    from home_mjx.training.trajectories import Trajectories, record
    from home_mjx.viewer.episodes.policies import check_agent, policy_of

    import_modules(args.modules)
    path = args.checkpoint and checkpoint_of(args.checkpoint)
    check_agent(args.agent, path)
    sensors = tuple((args.sensors or "rgb,state,instruction").split(","))
    spec = env_spec(args, path, sensors if path is None or args.sensors else None)
    out = make_folder(args.out or Path("data") / spec.id)
    env = spec.make()
    env = with_expert(env) if args.agent == EXPERT else env
    policy = None if args.agent == EXPERT else policy_of(env, args.agent, path, args.greedy)
    begun = time.perf_counter()
    steps = record(
        env, out, policy, frames=args.frames, num_envs=args.num_envs, seed=args.seed, agent=args.agent,
        only_success=args.only_success, resume=args.resume,
    )  # fmt: skip
    took = f"{time.perf_counter() - begun:.0f} s, compiling included"
    sys.stdout.write(f"{steps} steps of {len(Trajectories(out))} episodes in {out / 'data'}; {took}\n")
    return 0
