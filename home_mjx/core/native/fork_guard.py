"""Fork guard: compiled code uses XLA's threads, which a forked child lacks, so calls would deadlock."""

import functools
import os
from collections.abc import Callable
from typing import Any, TypeVar

from home_mjx.errors import BackendError

T = TypeVar("T")

HINT = "Start workers by multiprocessing's `spawn` or `forkserver` method."

_started_in: list[int] = []  # id of the process that first loaded compiled code


def record_process() -> None:
    """Record this process, unless one is, as the starter of JAX's threads; call it before loading houses or kernels."""
    if not _started_in:
        _started_in.append(os.getpid())


def check_not_forked(action: str) -> None:
    """Raise `BackendError` in a child that was forked after houses or compiled code were loaded.

    `action` is the refused action for the message, such as "cast rays".
    """
    if _started_in and _started_in[0] != os.getpid():
        raise BackendError(
            f"cannot {action} in a forked child of a process that has made houses, cast rays or stepped physics",
            hint=HINT,
        )


def forbid_after_fork(function: Callable[..., T], action: str) -> Callable[..., T]:
    """Wrap a function of positional arguments so that it raises `BackendError` in children that are forked from now on.

    Use it for compiled programs. JAX runs a cached program without calling Python code of this package; a large one
    then waits forever for threads that the child lacks. `action` is named in the message, such as "step".
    """
    made_in = os.getpid()

    @functools.wraps(function)
    def checked(*args: Any) -> T:
        """Call `function` unless this process is a forked child."""
        if os.getpid() != made_in:
            message = f"cannot {action} in a forked child of the process that made the environment"
            raise BackendError(message, hint=HINT)
        return function(*args)

    return checked
