"""Pools of worker processes and threads."""

import multiprocessing
import subprocess
import sys
import threading
import time

import pytest

from home_mjx.core.workers import max_workers, worker_pool, worker_threads


def test_work_is_done_and_what_has_not_begun_is_dropped():
    with worker_pool(1) as pool:
        assert pool.submit(abs, -3).result() == 3
        waiting = [pool.submit(time.sleep, 0.5) for _ in range(200)]
    assert waiting[-1].cancelled()


def test_an_interrupt_does_not_wait_for_what_workers_are_at():
    def interrupted() -> float:
        with worker_pool(2) as pool:
            pool.submit(abs, -3).result()  # they are there
            work = [pool.submit(time.sleep, 60) for _ in range(2)]
            while not all(job.running() for job in work):
                time.sleep(0.01)
            begin.append(time.monotonic())
            raise KeyboardInterrupt

    begin: list[float] = []
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - begin[0] < 10


def test_an_interrupt_does_not_wait_for_threads_that_compile():
    ends = threading.Event()
    work = []

    def interrupted() -> None:
        with worker_threads(1) as pool:
            work.extend(pool.submit(ends.wait, 60) for _ in range(2))
            raise KeyboardInterrupt

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - begin < 10
    assert work[1].cancelled()
    ends.set()


def test_threads_finish_their_work():
    with worker_threads(1) as pool:
        work = [pool.submit(time.sleep, 0.05) for _ in range(3)]
    assert all(job.done() and not job.cancelled() for job in work)


SCRIPT = """
from home_mjx.core.workers import worker_pool
print("script runs")
with worker_pool(2, imports_main=False) as pool:
    print(sum(pool.map(abs, range(-3, 0))))
"""


def test_a_script_without_a_guard_starts_workers_that_do_not_run_it(tmp_path):
    """A worker that imported the script would start workers of its own, which Python refuses."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.split("\n") == ["script runs", "6", ""]


def test_the_script_is_there_again_after_workers_have_started():
    before = sys.modules["__main__"]
    with worker_pool(1, imports_main=False) as pool:
        assert pool.submit(abs, -3).result() == 3
    assert sys.modules["__main__"] is before


def _count_in_daemon(found) -> None:
    found.send(max_workers(8))


def test_a_daemon_process_starts_no_workers():
    here, there = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_count_in_daemon, args=(there,), daemon=True)
    process.start()
    assert here.recv() == 1
    process.join()
