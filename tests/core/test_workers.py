"""Pools of worker processes and threads."""

import threading
import time

import pytest

from home_mjx.core.workers import worker_pool, worker_threads


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
