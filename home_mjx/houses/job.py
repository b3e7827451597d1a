"""Compiles the houses of a whole dataset into the cache, on this machine or on many; no house can stop the run."""

import os
import time
from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

from tqdm import tqdm

from home_mjx.core.files import unwritable
from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.pools import outcomes
from home_mjx.houses.report import (
    CACHED,
    COMPILED,
    FAILED,
    FREE,
    CompileOutcome,
    CompileSummary,
    described,
    done_houses,
    earlier_lines,
    journal,
    report_path,
)
from home_mjx.houses.version import prepare_folder
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions

MODELS_KEPT = 1000  # in the memory of a worker


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
    progress: bool = False,
) -> CompileSummary:
    """Compiles houses into the cache, where `load_bank` finds them.

    Every house is written whole or not at all and is then noted in the report, one JSON object a line. So a run may be
    killed at any moment: the next one goes on where it ended.

    Args:
        root: Folder of the dataset, an open one, or a `HouseSet`; None: the dataset that `SUNCG_DATA_DIR` names.
        ids: Which houses; all by default.
        split: Only houses of this split.
        workers: Processes on this machine.
        resume: Skip houses that an earlier run has noted as done and that are in the cache, without looking at their
            files again.
        report: Where to note what became of each house; by default in the cache folder. A run of some
            houses adds to it.
        scheduler: Address of a Dask scheduler, whose workers are used instead; they must see the same dataset and
            cache folder. Needs the extra `distributed`.
        options: How to compile.
        progress: Show a progress bar.

    Returns:
        Counts; houses that failed are told of in the report.

    Raises:
        DatasetError: There is no dataset, or it has no such house.
        ConfigError: The cache folder or the report cannot be written to, something else than a report is in its place,
            there are no workers, a scheduler was given and it does not answer or the extra is not installed, or houses
            are to be chosen by what is in them, which is only known once they are compiled.

    Example:
        >>> compile_dataset("datasets/demo", workers=2).failed  # doctest: +SKIP
        0
    """
    begin = time.perf_counter()
    if workers < 1:
        raise ConfigError(f"expected one worker or more, got {workers}", element="workers")
    houses = HouseSet.of(root, ids=ids, split=split, options=options)
    if houses.where is not None:
        raise ConfigError("`where` cannot choose houses that are still to be compiled")
    dataset, options = houses.opened, houses.options
    chosen = list(dict.fromkeys(houses.house_ids))
    for house_id in chosen:
        dataset.check_known(house_id)
    dataset.prepare(chosen, progress)
    path = Path(report or report_path(dataset.root, options))
    earlier = earlier_lines(path)
    done = done_houses(earlier) if resume else set()
    left = [house_id for house_id in chosen if house_id not in done]
    _prepare()
    task = partial(compile_one, dataset, options, f"{os.getpid()} {time.time_ns()}")
    counts: dict[str, int] = dict.fromkeys((COMPILED, CACHED, FAILED), 0)
    incomplete = fixed = 0
    with (
        outcomes(task, left, workers, scheduler) as found,
        # After the scheduler: nothing is lost from an old report if there is none.
        journal(path, append=resume or not houses.is_whole) as note,
        tqdm(total=len(left), desc="compile", unit="house", disable=not progress) as bar,
    ):
        for outcome in found:
            note(outcome)
            counts[outcome.status] += 1
            incomplete += bool(outcome.stand_ins)
            fixed += outcome.fixed
            bar.set_postfix(failed=counts[FAILED], refresh=False)
            bar.update()
    compiled, cached, failed = counts.values()
    seconds = time.perf_counter() - begin
    return CompileSummary(compiled, cached, failed, len(chosen) - len(left), seconds, path, incomplete, fixed)


def _prepare() -> None:
    try:
        prepare_folder()
    except OSError as error:
        message = f"cache folder cannot be written to: {error.strerror}"
        raise ConfigError(message, file=cache_folder(), hint=f"Set {CACHE_VARIABLE} to a folder of yours.") from None


def compile_one(dataset: Dataset, options: CompileOptions, run: str, house_id: str) -> CompileOutcome:
    """Sees to it that a house is in the cache; whatever goes wrong is part of the outcome.

    Args:
        dataset: The dataset.
        options: How to compile.
        run: Name of the run, in which what houses share is looked at once per process.
        house_id: The house.
    """
    begin = time.perf_counter()
    status, error, entry, stand_ins, fixed = FAILED, None, None, [], 0
    try:
        houses = _houses(dataset, options, run)
        before = houses.compiled
        fixed = int(houses.load(house_id).report["movable_but_too_many"])
        stand_ins = [str(item) for item in houses.stand_ins.get(house_id, ())]
        status = COMPILED if houses.compiled > before else CACHED
        if len(houses.library) > MODELS_KEPT:
            _houses.cache_clear()
        path = houses.entry(house_id)
        if not path.is_file():
            raise unwritable("compiled house", path, houses.unwritten or OSError("it is gone"), FREE)
        entry = str(path.relative_to(cache_folder()))
    except Exception as problem:  # one house of 45,000 must not stop the run, whatever is wrong with it
        status, error = FAILED, described(problem)
    return CompileOutcome(house_id, status, round(time.perf_counter() - begin, 4), error, entry, stand_ins, fixed)


@lru_cache(maxsize=1)
def _houses(dataset: Dataset, options: CompileOptions, run: str) -> HouseCache:
    return HouseCache(dataset, options)
