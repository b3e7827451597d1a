"""Compile the houses of a dataset into the cache, or export one house as MJCF for MuJoCo's viewer."""

import argparse
import os
import sys
from typing import TYPE_CHECKING

from home_mjx.cli.houses import (
    add_house_arguments,
    add_movable_option,
    add_strict_option,
    is_dataset_name,
    is_dataset_root,
    load_compiled_house,
    selected_houses,
)
from home_mjx.cli.learning.arguments import add_import_option, import_modules
from home_mjx.cli.parsing import MAX_WORKERS, parse_names, parse_path, whole_number_type
from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError
from home_mjx.schema.categories import COLLISIONS

if TYPE_CHECKING:
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.houses.report import CompileSummary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `HOUSE`, an id or the root of a dataset, the other options of `home-mjx compile`, and their defaults.

    `--dataset`, `--strict` and `--max-bodies` are as in `cli.houses`, `--import` as in `add_import_option`.
    `--mjcf OUT` is the path of a folder; None: compile. `--collision`, by default `box`, is a text that `run` checks.

    For whole datasets, `--workers` is from 1 to `MAX_WORKERS`, by default the number of processors. `--resume` is a
    flag. `--report FILE` is a path and `--scheduler ADDRESS` a text; both are None by default. `--bakes A,B` is a tuple
    of names that `run` checks, empty by default.
    """
    add_house_arguments(parser, "id of a house, or root of a dataset to compile all its houses")
    add_strict_option(parser)
    add_movable_option(parser)
    add_import_option(parser)
    parser.add_argument(
        "--mjcf", type=parse_path, metavar="OUT", help="write one house as MJCF into this folder instead"
    )
    parser.add_argument(
        "--collision", default="box", help="with --mjcf: collision geoms of objects, `box` or `exact` (default: box)"
    )
    group = parser.add_argument_group("whole datasets")
    workers = os.cpu_count() or 1
    group.add_argument(
        "--workers",
        type=whole_number_type(MAX_WORKERS),
        default=workers,
        help="number of processes (default: number of processors)",
    )
    group.add_argument("--resume", action="store_true", help="skip houses that an earlier run has compiled")
    group.add_argument(
        "--report", type=parse_path, metavar="FILE", help="file for the status of each house (default: in the cache)"
    )
    group.add_argument("--scheduler", metavar="ADDRESS", help="address of a Dask cluster to run on")
    group.add_argument(
        "--bakes", type=parse_names, default=(), metavar="A,B", help="bakes to compute as well, such as late_reverb"
    )


def run(args: argparse.Namespace) -> int:
    """Compile and print a summary, or write one house as MJCF; return 1 if a house failed, else 0.

    An unknown `--collision` or bake raises `UnknownNameError` before anything is compiled. Bakes are computed last,
    also if some houses failed; they are neither checked nor computed with `--mjcf`.
    """
    import_modules(args.modules)
    check_known("collision", [args.collision], COLLISIONS)
    if args.mjcf is not None:
        return _write_mjcf(args)
    from home_mjx.houses.bakes import find_bake
    from home_mjx.houses.job import compile_dataset

    houses = selected_houses(args)
    for name in args.bakes:
        find_bake(name)  # an unknown one is refused before houses are compiled
    summary = compile_dataset(
        houses,
        workers=args.workers,
        resume=args.resume,
        report=args.report,
        scheduler=args.scheduler,
    )
    _print_summary(summary)
    if args.bakes:
        _bake(houses, args.bakes, summary)
    return int(summary.failed > 0)


def _bake(houses: "HouseSet", bakes: tuple[str, ...], summary: "CompileSummary") -> None:
    """Compute bakes of all houses but those whose last line in the report says `failed`, one at a time.

    One at a time limits memory. Then print one line with the names of the bakes and the number of houses.
    """
    from home_mjx.core.progress import ProgressCount, is_progress_shown, plural
    from home_mjx.houses.load import load_bank
    from home_mjx.houses.report import FAILED, read_report

    status = {line["id"]: line["status"] for line in read_report(summary.report)}
    ids = [house_id for house_id in houses.house_ids if status.get(house_id) != FAILED]
    dataset = houses.resolved_dataset  # opened once
    with ProgressCount(f"baking {plural(len(ids), 'house')}", len(ids), "house", is_progress_shown()) as count:
        for house_id in ids:
            load_bank(dataset, ids=[house_id], options=houses.options, bakes=bakes, progress=False)
            count.update()
    sys.stdout.write(f"{', '.join(bakes)} of {plural(len(ids), 'house')} baked\n")


def _write_mjcf(args: argparse.Namespace) -> int:
    """Write the selected house as MJCF into `--mjcf`; print its path and a command to view it; return 0.

    A line with the number of movable objects that are fixed comes before, if `--max-bodies` leaves out any.

    Raises:
        ConfigError: `HOUSE` is the folder of a dataset; a name such as `procedural:1` selects its first house.
    """
    from home_mjx.scene_compile.mjcf.export import export_mjcf

    if is_dataset_root(args) and not is_dataset_name(args):
        raise ConfigError("--mjcf needs one house, not a dataset", hint="Pass a house, and its dataset with --dataset.")
    house = load_compiled_house(args)
    path = export_mjcf(house, args.mjcf, collision=args.collision)
    if left := house.report["movable_but_too_many"]:
        sys.stdout.write(f"{left} movable objects are fixed, because they exceed --max-bodies\n")
    sys.stdout.write(f"{path}\nView it with: python -m mujoco.viewer --mjcf={path}\n")
    return 0


def _print_summary(summary: "CompileSummary") -> None:
    """Print counts, rate and report file of a compilation.

    The rate is compiled and cached houses per second. Houses with fallbacks and fixed objects have a line each, unless
    their count is 0. If a house failed, the last ten lines `failed` of the report go to stderr. These may be from
    earlier runs, if the report has their lines.
    """
    from home_mjx.houses.report import FAILED, read_report

    done = summary.compiled + summary.cached
    rate = done / max(summary.seconds, 1e-9)
    sys.stdout.write(
        f"{summary.compiled} compiled, {summary.cached} in the cache, {summary.skipped} skipped, "
        f"{summary.failed} failed in {summary.seconds:.1f} s ({rate:.2g} houses/s)\n{summary.report}\n"
    )
    if summary.incomplete:
        sys.stdout.write(
            f"{summary.incomplete} with fallbacks for missing files of the dataset, listed in the report\n"
        )
    if summary.fixed:
        sys.stdout.write(f"{summary.fixed} movable objects are fixed, because they exceed --max-bodies in a house\n")
    if summary.failed:
        failed = [line for line in read_report(summary.report) if line["status"] == FAILED]
        for line in failed[-10:]:
            sys.stderr.write(f"{line['id']}: {line['error']['message']} (in {line['error']['file']})\n")
