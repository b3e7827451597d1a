"""Task of compiling a house, and its executors: this process, worker processes, or a Dask cluster."""

import os
import pickle
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import lru_cache, partial
from typing import Any

from home_mjx.core.files import write_error
from home_mjx.core.paths import cache_folder
from home_mjx.core.progress import ProgressCount, plural
from home_mjx.core.workers import max_workers, worker_pool
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError, install_hint
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.report import CACHED, COMPILED, DISK_FULL_HINT, FAILED, CompileOutcome, error_record
from home_mjx.scene_compile.pipeline.compile import CompileOptions

CONNECT_TIMEOUT = 10  # [s], timeout for connecting to a scheduler

MAX_CACHED_MODELS = 1000  # maximum number of models in the memory of a worker
MIN_POOL_HOUSES = 8  # fewer houses are compiled faster than worker processes start

CompileTask = Callable[[str], CompileOutcome]


def compile_missing(cache: HouseCache, ids: Sequence[str], progress: bool | None = None) -> None:
    """Compile those houses that are not cached in worker processes, if they are many.

    Houses that fail stay missing, so that loading them raises the error. Datasets that workers cannot open, such as
    those of classes that a script defines, are left to the caller as well.

    Args:
        cache: Cache of the dataset; `prepare` was called.
        ids: The houses.
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.
    """
    task = compile_task(cache.dataset, cache.options)
    if len(ids) < MIN_POOL_HOUSES or max_workers(len(ids)) < 2 or not _is_importable(task):
        return
    missing = cache.missing(ids)
    if len(missing) < MIN_POOL_HOUSES:
        return
    text = f"compiling {plural(len(missing), 'house')}"
    with ProgressCount(f"{text} (once, then cached)", len(missing), "house", progress) as bar:
        for _ in _in_processes(task, missing, max_workers(len(missing))):
            bar.update()


def compile_task(dataset: Dataset, options: CompileOptions) -> CompileTask:
    """Return `compile_one` for the houses of a dataset, under the name of a new job."""
    return partial(compile_one, dataset, options, f"{os.getpid()} {time.time_ns()}")


def _is_importable(task: CompileTask) -> bool:
    """Return whether a task can be sent to a process that does not import the script."""
    try:
        return b"__main__" not in pickle.dumps(task)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False


@contextmanager
def run_jobs(
    task: CompileTask, ids: Sequence[str], workers: int, scheduler_address: str | None
) -> Iterator[Iterator[CompileOutcome]]:
    """Yield an iterator over the outcomes of houses, in order of completion; read it within the block.

    In this process a house is compiled only when its outcome is read.

    Args:
        task: Compiles the house with an id; it never raises.
        ids: The houses.
        workers: Number of processes on this machine; with 1, or a single house, the task runs in this process.
        scheduler_address: Address of a Dask scheduler whose workers are used instead; `workers` is then ignored.

    Raises:
        ConfigError: The scheduler does not answer, or the extra is not installed.
    """
    if scheduler_address is not None:
        with _dask(scheduler_address) as executor:
            yield _completed(executor, task, ids)
    elif workers == 1 or len(ids) < 2:
        yield map(task, ids)
    else:
        yield _in_processes(task, ids, workers)


def _completed(executor: Any, task: CompileTask, ids: Sequence[str]) -> Iterator[CompileOutcome]:
    """Yield outcomes in order of completion; a task that raises, or whose worker dies, has the status `FAILED`."""
    futures = {executor.submit(task, house_id): house_id for house_id in ids}
    for future in as_completed(futures):
        try:
            yield future.result()
        except Exception as problem:  # the worker died, or the cluster lost the task
            yield CompileOutcome(futures[future], FAILED, 0.0, error_record(problem))


@contextmanager
def _dask(scheduler: str) -> Iterator[Any]:
    """Yield an executor on a Dask cluster.

    Raises:
        ConfigError: The scheduler does not answer, or the extra is not installed.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise ConfigError("a scheduler needs the package `distributed`", hint=install_hint("distributed")) from None
    try:
        client = Client(scheduler, timeout=CONNECT_TIMEOUT)
    except (OSError, ValueError) as error:
        hint = "Start one with `dask scheduler` and workers with `dask worker ADDRESS`."
        raise ConfigError(f"no Dask scheduler answers at `{scheduler}`: {error}", hint=hint) from error
    with client, client.get_executor(pure=False) as executor:
        yield executor


def _in_processes(task: CompileTask, ids: Sequence[str], workers: int) -> Iterator[CompileOutcome]:
    """Yield outcomes from worker processes in order of completion; repeated ids run once.

    The processes import the running script only if the task is defined there.

    If a process dies, the pool ends and houses without an outcome remain. The first `workers` of them, in the order of
    `ids`, run one by one, each in a process of its own; the others continue in a new pool. A house whose own process
    dies, for example by lack of memory, has the status `FAILED`. Exceptions of the task come through.
    """
    left, imports_main = dict.fromkeys(ids), not _is_importable(task)
    while left:
        with worker_pool(min(workers, len(left)), imports_main) as pool:
            futures = [pool.submit(task, house_id) for house_id in left]
            for future in as_completed(futures):
                if not isinstance(future.exception(), BrokenProcessPool):
                    outcome = future.result()
                    del left[outcome.id]
                    yield outcome
        # Pools process tasks in order, so if the pool broke, one of the first remaining houses caused it.
        for house_id in list(left)[:workers]:
            del left[house_id]
            yield _retry_alone(task, house_id, imports_main)


def _retry_alone(task: CompileTask, house_id: str, imports_main: bool) -> CompileOutcome:
    """Run a task in a new process; if that dies, return an outcome with the status `FAILED` and a `MemoryError`."""
    with worker_pool(1, imports_main) as pool:
        try:
            return pool.submit(task, house_id).result()
        except BrokenProcessPool:
            death = MemoryError("the process that compiled the house died, possibly for lack of memory")
            return CompileOutcome(house_id, FAILED, 0.0, error_record(death))


def compile_one(dataset: Dataset, options: CompileOptions, run: str, house_id: str) -> CompileOutcome:
    """Compile a house unless it is in the cache; never raise, but return the outcome with any error.

    A house that was compiled, but could not be written to the cache, has the status `FAILED`.
    Each process checks inputs that houses share once per `run`, the name of the compile job.
    """
    begin = time.perf_counter()
    status, error, entry, fallbacks, fixed = FAILED, None, None, [], 0
    try:
        houses = _houses(dataset, options, run)
        before = houses.num_compiled
        fixed = int(houses.load(house_id).report["movable_but_too_many"])
        fallbacks = [str(item) for item in houses.fallbacks.get(house_id, ())]
        status = COMPILED if houses.num_compiled > before else CACHED
        if len(houses.library) > MAX_CACHED_MODELS:
            _houses.cache_clear()
        path = houses.entry_path(house_id)
        if not path.is_file():
            cause = houses.write_error or OSError("file has been removed")
            raise write_error("compiled house", path, cause, DISK_FULL_HINT)
        entry = str(path.relative_to(cache_folder()))
    except Exception as problem:  # one broken house of 45,000 must not stop the run
        status, error = FAILED, error_record(problem)
    return CompileOutcome(house_id, status, round(time.perf_counter() - begin, 4), error, entry, fallbacks, fixed)


@lru_cache(maxsize=1)
def _houses(dataset: Dataset, options: CompileOptions, run: str) -> HouseCache:
    """Return this process's cache of a run; only the last one is kept."""
    return HouseCache(dataset, options)
