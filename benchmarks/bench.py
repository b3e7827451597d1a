"""Measure speed. CASE is `all`, a case such as `rays`, or a single measurement such as `rays/primary-depth`."""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from benchmarks.cases import CASE_NAMES, measure
from benchmarks.cases.record import BenchSettings, Measurement
from home_mjx.core.paths import dataset_root


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `home-mjx bench`."""
    parser.add_argument("case", metavar="CASE", help=f"all, {', '.join(CASE_NAMES)}, or one measurement of a case")
    parser.add_argument("--json", action="store_true", help="print one JSON object per line")
    parser.add_argument("--houses", type=int, default=8, help="number of houses (default: 8)")
    parser.add_argument("--envs", type=int, default=64, help="environments in the batch (default: 64)")
    parser.add_argument("--seconds", type=int, default=2, help="time per measurement [s] (default: 2)")
    parser.add_argument(
        "--dataset", type=Path, default=dataset_root(), metavar="ROOT",
        help="folder of a dataset, or its name such as procedural:16 (default: $SUNCG_DATA_DIR, or generated houses)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Print each measurement as soon as it is complete."""
    settings = BenchSettings(args.dataset, args.houses, args.envs, float(args.seconds))
    for record in measure(args.case, settings):
        sys.stdout.write((json.dumps(asdict(record)) if args.json else format_record(record)) + "\n")
        sys.stdout.flush()
    return 0


def format_record(record: Measurement) -> str:
    """Format a record as one line of text and one of notes."""
    text = f"{record.case:<24}{record.value:>14,.4g} {record.unit:<12}"
    if record.compile_seconds is not None:
        text += f" compiled in {record.compile_seconds:.1f} s"
    if record.ratio is not None:
        text += f"; {record.ratio:.3g} x {record.peer}"
    return f"{text}\n{'':<24}{record.note}, {record.device}"
