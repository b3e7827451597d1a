"""Compiled code shares its work with XLA's threads. A forked child lacks them, and would wait for ever."""

import os

from home_mjx.errors import ExecutorError

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
            hint="Start workers by multiprocessing's `spawn` or `forkserver` method.",
        )
