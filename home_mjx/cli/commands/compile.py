"""Compile the houses of a dataset into the cache, or write one house as MJCF to open in MuJoCo's viewer."""

import argparse
import os
import sys
from typing import TYPE_CHECKING

from home_mjx.cli.houses import (
    add_house_arguments,
    add_movable_option,
    add_strict_option,
    load_compiled_house,
    named_houses,
    names_root,
)
from home_mjx.cli.parsing import MOST_WORKERS, file_path, whole
from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError
from home_mjx.schema.choices import COLLISIONS

if TYPE_CHECKING:
    from home_mjx.houses.report import CompileSummary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx compile`."""
    add_house_arguments(parser, "id of a house, or root of a dataset: then all its houses are compiled")
    add_strict_option(parser)
    add_movable_option(parser)
    parser.add_argument(
        "--mjcf", type=file_path, metavar="OUT", help="write one house as MJCF into this folder instead"
    )
    parser.add_argument("--collision", default="box", help="with --mjcf: objects collide by `box` or `exact` pieces")
    group = parser.add_argument_group("whole datasets")
    workers = os.cpu_count() or 1
    group.add_argument("--workers", type=whole(MOST_WORKERS), default=workers, help="processes (default: all)")
    group.add_argument("--resume", action="store_true", help="skip houses that an earlier run has done")
    group.add_argument(
        "--report", type=file_path, metavar="FILE", help="what became of each house (default: in the cache)"
    )
    group.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the work")


def run(args: argparse.Namespace) -> int:
    """Compiles, and says what came of it; 1 if a house failed."""
    check_known("collision", [args.collision], COLLISIONS)
    if args.mjcf is not None:
        return _write_mjcf(args)
    from home_mjx.houses.job import compile_dataset

    summary = compile_dataset(
        named_houses(args),
        workers=args.workers,
        resume=args.resume,
        report=args.report,
        scheduler=args.scheduler,
        progress=True,
    )
    _tell(summary)
    return int(summary.failed > 0)


def _write_mjcf(args: argparse.Namespace) -> int:
    from home_mjx.scene_compile.mjcf.export import export_mjcf

    if names_root(args):
        raise ConfigError("--mjcf takes one house, not a dataset", hint="Name a house, and its dataset by --dataset.")
    house = load_compiled_house(args)
    path = export_mjcf(house, args.mjcf, collision=args.collision)
    if left := house.report["movable_but_too_many"]:
        sys.stdout.write(f"{left} objects that could move are fixed: more than --max-bodies\n")
    sys.stdout.write(f"{path}\nLook at it: python -m mujoco.viewer --mjcf={path}\n")
    return 0


def _tell(summary: "CompileSummary") -> None:
    from home_mjx.houses.report import FAILED, read_report

    done = summary.compiled + summary.cached
    rate = done / max(summary.seconds, 1e-9)
    sys.stdout.write(
        f"{summary.compiled} compiled, {summary.cached} in the cache, {summary.skipped} skipped, "
        f"{summary.failed} failed in {summary.seconds:.1f} s ({rate:.2g} houses/s)\n{summary.report}\n"
    )
    if summary.incomplete:
        sys.stdout.write(f"{summary.incomplete} with stand-ins for what the dataset lacks: the report lists them\n")
    if summary.fixed:
        sys.stdout.write(f"{summary.fixed} objects that could move are fixed: more than --max-bodies in a house\n")
    if summary.failed:
        failed = [line for line in read_report(summary.report) if line["status"] == FAILED]
        for line in failed[-10:]:
            sys.stderr.write(f"{line['id']}: {line['error']['message']} (in {line['error']['file']})\n")
