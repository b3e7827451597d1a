"""Job that compiles the houses of a dataset into the cache, locally or on a cluster; no house can stop the run."""

import time
from collections.abc import Sequence
from pathlib import Path

from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.core.progress import ProgressCount, is_progress_shown, plural
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.pools import compile_task, run_jobs
from home_mjx.houses.report import (
    CACHED,
    COMPILED,
    FAILED,
    CompileSummary,
    find_done_houses,
    load_report,
    open_journal,
    report_path,
)
from home_mjx.houses.version import prepare_folder
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions


def compile_dataset(
    root: HouseSet | Dataset | str | Path | None,
    ids: Sequence[str] | None = None,
    *,
    split: str | None = None,
    workers: int = 1,
    resume: bool = False,
    report: Path | None = None,
    scheduler: str | None = None,
    options: CompileOptions = DEFAULT_OPTIONS,
    progress: bool | None = None,
) -> CompileSummary:
    """Compile houses into the cache, from which `load_bank` loads them.

    Every house is written atomically and then added to the report, one JSON object per line. A run may be killed at any
    time; with `resume` the next one skips the finished houses.

    Args:
        root: Folder of the dataset, an open one, or a `HouseSet`; None: the dataset that `SUNCG_DATA_DIR` names.
        ids: House ids, each compiled once even if repeated; None: all.
        split: Restrict to one split; None: all.
        workers: Number of processes on this machine; ignored with `scheduler`.
        resume: Skip houses that an earlier report lists as done and that are in the cache, without checking their
            input files again.
        report: File for the outcome of each house; None: a file in the cache folder. Runs over a subset and runs
            with `resume` append to it, others overwrite it.
        scheduler: Address of a Dask scheduler, whose workers are used instead; they must see the same dataset and
            cache folder. Needs the extra `distributed`.
        options: Compile options.
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.

    Returns:
        Counts; the report lists the errors of failed houses.

    Raises:
        DatasetError: There is no dataset, or it does not have one of the houses.
        ConfigError: The cache folder or the report is not writable, or another file has the report's name. `workers` is
            below 1. The scheduler does not answer or its extra is not installed. The `HouseSet` has a `filter`, which
            needs compiled houses, or is combined with another choice. No house is chosen.

    Example:
        >>> compile_dataset("datasets/demo", workers=2).failed  # doctest: +SKIP
        0
    """
    begin = time.perf_counter()
    if workers < 1:
        raise ConfigError(f"expected one worker or more, got {workers}", element="workers")
    houses = HouseSet.coerce(root, ids=ids, split=split, options=options)
    if houses.filter is not None:
        raise ConfigError("`filter` cannot choose houses that are still to be compiled")
    dataset, options = houses.resolved_dataset, houses.options
    chosen = list(dict.fromkeys(houses.house_ids))
    for house_id in chosen:
        dataset.check_known(house_id)
    HouseCache(dataset, options).prepare(chosen, is_progress_shown(progress))
    path = Path(report or report_path(dataset.root, options))
    earlier = load_report(path)
    done = find_done_houses(earlier) if resume else set()
    left = [house_id for house_id in chosen if house_id not in done]
    _prepare()
    task = compile_task(dataset, options)
    counts: dict[str, int] = dict.fromkeys((COMPILED, CACHED, FAILED), 0)
    incomplete = fixed = 0
    with (
        run_jobs(task, left, workers, scheduler) as found,
        # Opened after the scheduler, so that an old report is not truncated if there is none.
        open_journal(path, append=resume or not houses.is_complete) as note,
        ProgressCount(f"loading {plural(len(left), 'house')}", len(left), "house", progress) as bar,
    ):
        for outcome in found:
            note(outcome)
            counts[outcome.status] += 1
            incomplete += bool(outcome.fallbacks)
            fixed += outcome.fixed
            if counts[COMPILED] or counts[FAILED]:
                failures = f", {counts[FAILED]} failed" if counts[FAILED] else ""
                bar.describe(f"compiling {plural(len(left), 'house')}{failures}")
            bar.update()
    compiled, cached, failed = counts.values()
    seconds = time.perf_counter() - begin
    return CompileSummary(compiled, cached, failed, len(chosen) - len(left), seconds, path, incomplete, fixed)


def _prepare() -> None:
    """Create the version folder; raise `ConfigError` if the cache folder is not writable."""
    try:
        prepare_folder()
    except OSError as error:
        message = f"cache folder is not writable: {error.strerror}"
        raise ConfigError(message, file=cache_folder(), hint=f"Set {CACHE_VARIABLE} to a writable folder.") from None
