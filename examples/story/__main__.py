"""Film two scripted agents: one opens a door, climbs stairs and carries a lamp to a table, the other watches."""

import argparse
import sys
from pathlib import Path

from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import parse_path, positive_int_type


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `home-mjx story`."""
    parser.add_argument("--out", type=parse_path, default=Path("demo"), help="folder for the files (default: demo)")
    parser.add_argument(
        "--size",
        type=positive_int_type,
        nargs=2,
        default=(320, 240),
        metavar=("W", "H"),
        help="size of each agent's image [pixels] (default: 320 240)",
    )
    parser.add_argument("--samples", type=positive_int_type, default=2, help="rays per pixel (default: 2)")


def run(args: argparse.Namespace) -> int:
    """Film the story and print the paths of its files."""
    from examples.story.run import StoryOptions, run_story

    width, height = args.size
    seconds = run_story(StoryOptions(make_folder(args.out), width, height, args.samples))
    lines = [
        f"The story took {seconds:.1f} s",
        f"Look at {args.out / 'story.png'}",
        f"Watch   {args.out / 'story.mp4'} (with the sound at the carrier's ears)",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0
