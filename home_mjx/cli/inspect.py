"""Count what a house holds, as read and as compiled."""

import argparse
import json
import sys

from home_mjx.cli.houses import add_house_arguments, load_house


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx inspect`."""
    add_house_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Prints the counts and everything odd that was tolerated."""
    from home_mjx.scene_compile.compile import compile_house

    house, metadata = load_house(args)
    compiled = compile_house(house, metadata)
    problems = [f"{problem.element}: {problem.message}" for problem in house.problems]
    if args.json:
        record = {"id": house.id, "version": house.version, "path": str(house.path), "problems": problems}
        sys.stdout.write(json.dumps({**record, "counts": dict(compiled.report)}) + "\n")
        return 0
    sys.stdout.write(f"{house.id} (format {house.version})\n{house.path}\n")
    for name, count in compiled.report.items():
        sys.stdout.write(f"{name.replace('_', ' '):<28}{count:>12,}\n")
    for problem in problems:
        sys.stdout.write(f"tolerated: {problem}\n")
    return 0
