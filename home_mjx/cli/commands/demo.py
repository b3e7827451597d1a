"""Walk through houses, film a trained agent that finds unheard sounds by ear and eye; write images and a report."""

import argparse
import sys
from pathlib import Path
from typing import Any

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, parse_path, parse_seed, positive_int_type
from home_mjx.core.progress import plural


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `home-mjx demo`; all have defaults.

    `--out` is the path of a folder (`demo`), and `--dataset` is as in `add_dataset_option`. Whole numbers from 1 are
    `--houses` (8), `--envs` (8) and `--steps` (150, of 0.1 s each). `--seed` is from 0 to 2**32 - 1 (12, which shows
    stairs and a search that succeeds).
    """
    parser.add_argument("--out", type=parse_path, default=Path("demo"), help="folder for the files (default: demo)")
    add_dataset_option(parser)
    parser.add_argument("--houses", type=house_count_type, default=8, help="number of houses (default: 8)")
    parser.add_argument("--envs", type=positive_int_type, default=8, help="agents that walk at once (default: 8)")
    parser.add_argument(
        "--steps", type=positive_int_type, default=150, help="steps of the walk, 0.1 s each (default: 150)"
    )
    parser.add_argument("--seed", type=parse_seed, default=12, help="seed of poses and noise (default: 12)")


def run(args: argparse.Namespace) -> int:
    """Run the demo in `--out`, print four lines, and return 0.

    They are speed [environment steps/s], path of the contact sheet, the film's line of `_film_line`, and path of the
    report. Up to three environments are shown. Errors of `run_demo` come through.
    """
    from home_mjx.viewer.demo.run import DemoOptions, run_demo

    options = DemoOptions(
        out=make_folder(args.out),
        suncg=args.dataset,
        num_houses=args.houses,
        num_envs=args.envs,
        num_steps=args.steps,
        num_views=min(3, args.envs),
        seed=args.seed,
    )
    report = run_demo(options)
    lines = [
        f"{report['steps_per_second']:.0f} environment steps/s with all sensors "
        f"({report['num_envs']} environments, {report['num_houses']} houses, {report['device']})",
        f"Look at {args.out / 'contact_sheet.png'}",
        _film_line(args.out, report["search"]),
        f"Figures {args.out / 'report.json'}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _film_line(out: Path, search: list[dict[str, Any]] | str) -> str:
    """Return a line, without newline, with path and successes of the film, or the reason why there is none.

    `search` is a list of results, of which those with `success` above 0 count, or the reason as text.
    """
    if isinstance(search, str):
        return f"No film: {search}"
    found, clips = sum(one["success"] > 0 for one in search), ", ".join(one["clip"] for one in search)
    return (
        f"Watch   {out / 'search.mp4'} (a trained agent finds {found} of {plural(len(search), 'unheard sound')}: "
        f"{clips}; with its binaural sound)"
    )
