"""Executors of a compile job: this process, worker processes, or a Dask cluster."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

from home_mjx.core.workers import worker_pool
from home_mjx.errors import ConfigError, install_hint
from home_mjx.houses.report import FAILED, CompileOutcome, error_record

CONNECT_TIMEOUT = 10  # [s], timeout for connecting to a scheduler

CompileTask = Callable[[str], CompileOutcome]


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

    If a process dies, the pool ends and houses without an outcome remain. The first `workers` of them, in the order of
    `ids`, run one by one, each in a process of its own; the others continue in a new pool. A house whose own process
    dies, for example by lack of memory, has the status `FAILED`. Exceptions of the task come through.
    """
    left = dict.fromkeys(ids)
    while left:
        with worker_pool(min(workers, len(left))) as pool:
            futures = [pool.submit(task, house_id) for house_id in left]
            for future in as_completed(futures):
                if not isinstance(future.exception(), BrokenProcessPool):
                    outcome = future.result()
                    del left[outcome.id]
                    yield outcome
        # Pools process tasks in order, so if the pool broke, one of the first remaining houses caused it.
        for house_id in list(left)[:workers]:
            del left[house_id]
            yield _retry_alone(task, house_id)


def _retry_alone(task: CompileTask, house_id: str) -> CompileOutcome:
    """Run a task in a new process; if that dies, return an outcome with the status `FAILED` and a `MemoryError`."""
    with worker_pool(1) as pool:
        try:
            return pool.submit(task, house_id).result()
        except BrokenProcessPool:
            death = MemoryError("the process that compiled the house died, possibly for lack of memory")
            return CompileOutcome(house_id, FAILED, 0.0, error_record(death))
