"""Compiled code shares its work with XLA's threads. A forked child lacks them, and would wait for ever."""

import functools
import os
from collections.abc import Callable
from typing import Any, TypeVar

from home_mjx.errors import ExecutorError

T = TypeVar("T")

HINT = "Start workers by multiprocessing's `spawn` or `forkserver` method."

_started_in: list[int] = []  # the process that compiled code was first loaded in


def note_start() -> None:
    """To be called where compiled code is loaded."""
    if not _started_in:
        _started_in.append(os.getpid())


def refuse_forked(action: str) -> None:
    """Raises `ExecutorError` in a child that was forked after compiled code was loaded.

    Args:
        action: What cannot be done, for the message: "cast rays".
    """
    if _started_in and _started_in[0] != os.getpid():
        raise ExecutorError(
            f"cannot {action} in a forked child of a process that has cast rays or stepped physics",
            hint=HINT,
        )


def in_this_process(function: Callable[..., T], action: str) -> Callable[..., T]:
    """A function that raises `ExecutorError` in children that are forked from now on.

    For compiled programs: JAX calls one that is there without asking us, and where it is large, waits for ever for
    threads that the child has not.

    Args:
        function: Any.
        action: What cannot be done, for the message: "step".
    """
    made_in = os.getpid()

    @functools.wraps(function)
    def checked(*args: Any) -> T:
        if os.getpid() != made_in:
            message = f"cannot {action} in a forked child of the process that made the environment"
            raise ExecutorError(message, hint=HINT)
        return function(*args)

    return checked
