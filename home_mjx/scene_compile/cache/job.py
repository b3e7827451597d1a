"""Compiles the houses of a whole dataset into the cache, on this machine or on many; no house can stop the run."""

import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

from tqdm import tqdm

from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.core.workers import worker_pool
from home_mjx.datasets.suncg.dataset import Dataset, open_dataset
from home_mjx.errors import ConfigError, HomeMjxError, install_hint
from home_mjx.scene_compile.cache.house_cache import HouseCache, prepare_folder, report_path
from home_mjx.scene_compile.cache.house_set import HouseSet
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions

COMPILED, CACHED, FAILED = "compiled", "cached", "failed"
MODELS_KEPT = 1000  # in the memory of a worker
CONNECT_SECONDS = 10  # that a scheduler has to answer

Task = Callable[[str], "Outcome"]


@dataclass(frozen=True)
class Outcome:
    """What became of one house; a line of the report.

    Attributes:
        id: The house.
        status: `compiled`, `cached` (it was there already) or `failed`.
        seconds: How long it took.
        error: Of a failed house: kind, message, file, element and hint.
        entry: Where it is, below the cache folder; None if it failed.
    """

    id: str
    status: str
    seconds: float
    error: dict[str, str | None] | None = None
    entry: str | None = None


@dataclass(frozen=True)
class Summary:
    """What became of a dataset: counts of houses, and where the report is."""

    compiled: int
    cached: int
    failed: int
    skipped: int  # done in an earlier run
    seconds: float
    report: Path


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
) -> Summary:
    """Compiles houses into the cache, where `HouseBank.from_dataset` finds them.

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
    path = Path(report or report_path(dataset.root, options))
    earlier = _earlier_lines(path)
    done = _done(earlier) if resume else set()
    left = [house_id for house_id in chosen if house_id not in done]
    _prepare()
    task = partial(compile_one, dataset.root, options, f"{os.getpid()} {time.time_ns()}")
    counts: dict[str, int] = dict.fromkeys((COMPILED, CACHED, FAILED), 0)
    with (
        _outcomes(task, left, workers, scheduler) as outcomes,
        # After the scheduler: nothing is lost from an old report if there is none.
        _journal(path, append=resume or not houses.is_whole) as note,
        tqdm(total=len(left), desc="compile", unit="house", disable=not progress) as bar,
    ):
        for outcome in outcomes:
            note(outcome)
            counts[outcome.status] += 1
            bar.set_postfix(failed=counts[FAILED], refresh=False)
            bar.update()
    compiled, cached, failed = counts.values()
    return Summary(compiled, cached, failed, len(chosen) - len(left), time.perf_counter() - begin, path)


def _prepare() -> None:
    try:
        prepare_folder()
    except OSError as error:
        message = f"cache folder cannot be written to: {error.strerror}"
        raise ConfigError(message, file=cache_folder(), hint=f"Set {CACHE_VARIABLE} to a folder of yours.") from None


def compile_one(root: Path, options: CompileOptions, run: str, house_id: str) -> Outcome:
    """Sees to it that a house is in the cache; whatever goes wrong is part of the outcome.

    Args:
        root: The dataset.
        options: How to compile.
        run: Name of the run, in which what houses share is looked at once per process.
        house_id: The house.
    """
    begin = time.perf_counter()
    status, error, entry = FAILED, None, None
    try:
        houses = _houses(root, options, run)
        before = houses.compiled
        houses.load(house_id)
        status = COMPILED if houses.compiled > before else CACHED
        if len(houses.library) > MODELS_KEPT:
            _houses.cache_clear()
        path = houses.entry(house_id)
        if not path.is_file():
            raise OSError("the cache folder cannot be written to")
        entry = str(path.relative_to(cache_folder()))
    except Exception as problem:  # one house of 45,000 must not stop the run, whatever is wrong with it
        status, error = FAILED, _described(problem)
    return Outcome(house_id, status, round(time.perf_counter() - begin, 4), error, entry)


@lru_cache(maxsize=1)
def _houses(root: Path, options: CompileOptions, run: str) -> HouseCache:
    return HouseCache(open_dataset(root), options)


def _described(problem: Exception) -> dict[str, str | None]:
    if isinstance(problem, HomeMjxError):
        where = {"file": problem.file, "element": problem.element, "hint": problem.hint}
        return {"type": type(problem).__name__, "message": problem.message, **where}
    return {"type": type(problem).__name__, "message": str(problem), "file": None, "element": None, "hint": None}


def _done(lines: list[dict[str, Any]]) -> set[str]:
    """Houses that the lines of a report say are in the cache, and that are."""
    entries = {line["id"]: line.get("entry") for line in lines if line["status"] != FAILED}
    # The end of an entry's archive is looked at: one that was cut off has lost it.
    return {house_id for house_id, entry in entries.items() if entry and is_zipfile(cache_folder() / entry)}


def _earlier_lines(path: Path) -> list[dict[str, Any]]:
    """What an earlier run has noted; a file that is no report is refused, lest it is written over."""
    try:
        lines = read_report(path)
        is_other = not lines and path.is_file() and path.read_bytes().strip()
    except OSError as error:
        raise ConfigError(f"report cannot be read: {error.strerror}", file=path, hint="Name a new file.") from None
    if is_other:
        raise ConfigError("there is a file that is no report", file=path, hint="Name a new file.")
    return lines


def read_report(path: Path) -> list[dict[str, Any]]:
    """The lines of a report; what else is there, such as a line that a killed run left half written, is passed over."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.is_file() else []
    found = []
    for line in lines:
        try:
            entry = json.loads(line)
        except ValueError:
            continue
        if isinstance(entry, dict) and {"id", "status"} <= entry.keys():
            found.append(entry)
    return found


@contextmanager
def _journal(path: Path, append: bool) -> Iterator[Callable[[Outcome], None]]:
    """Notes outcomes in a report; each is one write, so that a kill cuts at most the last line."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        report = path.open("ab" if append else "wb", buffering=0)
    except OSError as error:
        raise ConfigError(f"report cannot be written: {error.strerror}", file=path, hint="Name a new file.") from None
    with report as file:
        if append and path.stat().st_size:
            file.write(b"\n")  # the last line may be cut

        def note(outcome: Outcome) -> None:
            file.write((json.dumps(asdict(outcome)) + "\n").encode())

        yield note


@contextmanager
def _outcomes(task: Task, ids: Sequence[str], workers: int, scheduler: str | None) -> Iterator[Iterator[Outcome]]:
    if scheduler is not None:
        with _dask(scheduler) as executor:
            yield _as_they_come(executor, task, ids)
    elif workers == 1 or len(ids) < 2:
        yield map(task, ids)
    else:
        yield _in_processes(task, ids, workers)


def _as_they_come(executor: Any, task: Task, ids: Sequence[str]) -> Iterator[Outcome]:
    futures = {executor.submit(task, house_id): house_id for house_id in ids}
    for future in as_completed(futures):
        try:
            yield future.result()
        except Exception as problem:  # its worker died, or the cluster lost it
            yield Outcome(futures[future], FAILED, 0.0, _described(problem))


@contextmanager
def _dask(scheduler: str) -> Iterator[Any]:
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise ConfigError("a scheduler needs the package `distributed`", hint=install_hint("distributed")) from None
    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS)
    except (OSError, ValueError) as error:
        hint = "Start one with `dask scheduler` and workers with `dask worker ADDRESS`."
        raise ConfigError(f"no Dask scheduler answers at `{scheduler}`: {error}", hint=hint) from error
    with client, client.get_executor(pure=False) as executor:
        yield executor


def _in_processes(task: Task, ids: Sequence[str], workers: int) -> Iterator[Outcome]:
    """Outcomes from worker processes; a house that kills its worker, as one that needs too much memory, has failed."""
    left = dict.fromkeys(ids)
    while left:
        with worker_pool(min(workers, len(left))) as pool:
            futures = [pool.submit(task, house_id) for house_id in left]
            for future in as_completed(futures):
                if not isinstance(future.exception(), BrokenProcessPool):
                    outcome = future.result()
                    del left[outcome.id]
                    yield outcome
        # If the pool broke, one of the first that are left did it: pools work in order.
        for house_id in list(left)[:workers]:
            del left[house_id]
            yield _alone(task, house_id)


def _alone(task: Task, house_id: str) -> Outcome:
    with worker_pool(1) as pool:
        try:
            return pool.submit(task, house_id).result()
        except BrokenProcessPool:
            death = MemoryError("the process that compiled the house died, as for lack of memory")
            return Outcome(house_id, FAILED, 0.0, _described(death))
