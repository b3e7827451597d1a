"""Worker processes that terminate with their parent process, and threads."""

import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
_MAIN_LOCK = threading.Lock()  # held while the module `__main__` is replaced
thread_limit = sys.maxsize  # of `map_threads`; a process that shares the cores with others lowers it


def usable_cores() -> int:
    """Return the number of CPU cores available to this process, or of all cores where the affinity is unknown.

    Example:
        >>> usable_cores() >= 1
        True
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def map_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """Return the results of a function on items, in their order, computed by as many threads as there are cores.

    That pays off where the function releases the interpreter's lock, as NumPy, Pillow and compiled code do. The first
    exception in the items' order is raised, after all started calls have ended.

    Example:
        >>> map_threads(abs, [-1, 2])
        [1, 2]
    """
    with ThreadPoolExecutor(min(usable_cores(), thread_limit)) as pool:
        return list(pool.map(function, items))


@contextmanager
def worker_threads(workers: int) -> Iterator[ThreadPoolExecutor]:
    """Create a pool of `workers` threads for the duration of a `with` block.

    At the end, all submitted work finishes. A keyboard interrupt cancels pending work and does not wait for running
    work, such as a compilation of a minute; only the end of the interpreter does.
    """
    pool = ThreadPoolExecutor(workers)
    waits = True
    try:
        yield pool
    except KeyboardInterrupt:
        waits = False
        raise
    finally:
        pool.shutdown(waits, cancel_futures=not waits)


def max_workers(count: int) -> int:
    """Return how many worker processes suit `count` tasks, at least 1: a daemon process cannot start any.

    Example:
        >>> max_workers(1)
        1
    """
    return 1 if multiprocessing.current_process().daemon else max(1, min(usable_cores(), count))


@contextmanager
def worker_pool(workers: int, imports_main: bool = True) -> Iterator[ProcessPoolExecutor]:
    """Create a pool of `workers` spawned processes for the duration of a `with` block.

    At the end, pending work is cancelled and running work finishes; a keyboard interrupt terminates workers instead.

    Args:
        workers: Number of processes.
        imports_main: Workers import the script that runs, which must guard its work by `if __name__ == "__main__":`.
            Only tasks defined in the script need that.
    """
    context = multiprocessing.get_context("spawn") if imports_main else _LibraryContext()
    pool = ProcessPoolExecutor(workers, context, initializer=_leave_with_parent)
    try:
        yield pool
    except KeyboardInterrupt:  # safe, since workers write files atomically
        for process in [*(pool._processes or {}).values()]:
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


class _LibraryWorker(SpawnProcess):
    """A process that does not import the script that started it."""

    def start(self) -> None:
        """Start the process while an empty module stands for the script."""
        with _MAIN_LOCK:
            main = sys.modules["__main__"]
            sys.modules["__main__"] = ModuleType("__main__")
            try:
                super().start()
            finally:
                sys.modules["__main__"] = main


class _LibraryContext(SpawnContext):
    """Starts processes that do not import the script."""

    Process = _LibraryWorker


def _leave_with_parent() -> None:
    """Start a thread that exits this worker when its parent has ended; the pool's own would block forever."""
    parent = multiprocessing.parent_process()

    def wait() -> None:
        """Wait for the parent's end, then exit at once."""
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=wait, daemon=True).start()
