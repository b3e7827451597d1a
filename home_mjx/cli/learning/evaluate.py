"""Play episodes with a trained agent in houses it has not seen, beside an agent that acts at random."""

import argparse
import json
import sys
from pathlib import Path

from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import positive_int, seed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx evaluate`."""
    parser.add_argument("checkpoint", type=Path, metavar="CHECKPOINT", help="a checkpoint, or the folder of a run")
    parser.add_argument("--episodes", type=positive_int, default=1000, help="how many (default: 1000)")
    parser.add_argument("--houses", type=positive_int, default=16, help="how many (default: 16)")
    parser.add_argument(
        "--split", choices=("train", "val", "test"), default="val", help="part of the dataset (default: val)"
    )
    parser.add_argument("--greedy", action="store_true", help="do what is likeliest instead of drawing actions")
    parser.add_argument("--seed", type=seed, default=0, help="of episodes and actions (default: 0)")
    parser.add_argument(
        "--films", type=positive_int, default=0, metavar="N", help="film N episodes, beside the checkpoint"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Prints the figures."""
    from home_mjx.cli.learning.table import as_table
    from home_mjx.training import evaluate_checkpoint
    from home_mjx.training.checkpoint import CHECKPOINT

    path = args.checkpoint / CHECKPOINT if args.checkpoint.is_dir() else args.checkpoint
    report = evaluate_checkpoint(path, args.split, args.houses, args.episodes, args.seed, args.greedy)
    if args.films:
        from home_mjx.play import film_checkpoint

        out = make_folder(path.parent / "films")
        film_checkpoint(path, out, args.films, args.split, args.houses, args.seed, args.greedy)
    sys.stdout.write(json.dumps(report) + "\n" if args.json else as_table(report))
    return 0
