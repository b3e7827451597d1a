"""Rules for who sees progress, and lines of text on stderr."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from tqdm import tqdm

from home_mjx.errors import ConfigError

PROGRESS_VARIABLE = "HOME_MJX_PROGRESS"
PYTEST_VARIABLE = "PYTEST_VERSION"  # set by pytest, also for the processes that tests start

_is_command = False
_is_silent: ContextVar[bool] = ContextVar("home_mjx_is_silent", default=False)


@contextmanager
def command_progress() -> Iterator[None]:
    """Show progress within the block, also without a terminal, as commands do; `HOME_MJX_PROGRESS=0` hides it."""
    global _is_command
    before, _is_command = _is_command, True
    try:
        yield
    finally:
        _is_command = before


def is_progress_shown(progress: bool | None = None) -> bool:
    """Return whether progress is shown: the caller's choice, else that of `HOME_MJX_PROGRESS`, else by a rule.

    It is then shown in commands of `home-mjx`, at interactive prompts and on terminals, but not under pytest.

    Raises:
        ConfigError: The environment variable `HOME_MJX_PROGRESS` is neither 0 nor 1.

    Example:
        >>> is_progress_shown(True), is_progress_shown(False)
        (True, False)
    """
    if progress is not None:
        return progress
    chosen = os.environ.get(PROGRESS_VARIABLE, "")
    if chosen not in ("", "0", "1"):
        raise ConfigError(f"{PROGRESS_VARIABLE} must be 0 or 1, got `{chosen:.100}`", hint="Unset it for the default.")
    if chosen:
        return chosen == "1"
    if PYTEST_VARIABLE in os.environ or sys.stderr is None:
        return False
    return _is_command or hasattr(sys, "ps1") or sys.stderr.isatty()


def say(text: str, progress: bool | None = None) -> bool:
    """Write a line to stderr, above any progress bar, if progress is shown; return whether it was written.

    Nothing is written within `silence`.

    Args:
        text: Task that begins, such as "moving 8 houses to the device".
        progress: As for `is_progress_shown`.
    """
    if _is_silent.get() or not is_progress_shown(progress):
        return False
    tqdm.write(f"home_mjx: {text}", file=sys.stderr)
    sys.stderr.flush()
    return True


@contextmanager
def silence() -> Iterator[None]:
    """Hide `say` and new counts and phases within the block, in this thread, even with `progress=True`."""
    token = _is_silent.set(True)
    try:
        yield
    finally:
        _is_silent.reset(token)


def is_silent() -> bool:
    """Return whether the caller is in a block of `silence`."""
    return _is_silent.get()
