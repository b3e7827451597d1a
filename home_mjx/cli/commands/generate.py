"""Generate seeded houses in SUNCG's on-disk format."""

import argparse
import sys

from home_mjx.cli.parsing import parse_path, parse_seed_range
from home_mjx.core.progress import is_progress_shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `OUT`, the path of the new dataset, and the options of `home-mjx generate`.

    `--seeds A:B` is a range of seeds, by default 0 to 7; see `parse_seed_range`. `--preset` (`home`) and `--detail`
    (empty: that of the preset) are texts that `run` checks.
    """
    parser.add_argument("out", type=parse_path, metavar="OUT", help="folder of the new dataset")
    parser.add_argument(
        "--seeds",
        type=parse_seed_range,
        default=range(8),
        metavar="A:B",
        help="seeds of the houses: from A to B, B excluded, or a single one (default: 0:8)",
    )
    parser.add_argument(
        "--preset",
        default="home",
        help="home, of one to three storeys; or flat, of one storey with 3 to 6 rooms (default: home)",
    )
    parser.add_argument(
        "--detail", default="", help="level of detail of the models: full or low (default: full; low in flats)"
    )


def run(args: argparse.Namespace) -> int:
    """Write a house per seed, rewriting only files that differ, and return 0.

    Print a line with the number of houses, folder, first and last id, and a line with a command that uses them. Errors
    of `generate_dataset` come through.
    """
    from home_procgen.generate import generate_dataset

    ids = generate_dataset(args.out, args.seeds, is_progress_shown(), args.preset, args.detail)
    sys.stdout.write(f"{len(ids)} houses in {args.out}: {ids[0]} .. {ids[-1]}\n")
    sys.stdout.write(f"Use them with: home-mjx demo --dataset {args.out}\n")
    return 0
