"""Progress in words on stderr, while houses are made and programs compile.

It is shown by the commands of `home-mjx`, in a terminal and at an interactive prompt (IPython and notebooks as well).
Scripts whose stderr is a file or a pipe, and tests under pytest, are silent. An argument `progress=` of True or False,
or the environment variable `HOME_MJX_PROGRESS` of 1 or 0, overrides this.
"""

from home_mjx.core.progress.counts import ProgressCount, ProgressPhase, plural, show_compile, track
from home_mjx.core.progress.visibility import (
    PROGRESS_VARIABLE,
    PYTEST_VARIABLE,
    command_progress,
    is_progress_shown,
    say,
    silence,
)

__all__ = [
    "PROGRESS_VARIABLE",
    "PYTEST_VARIABLE",
    "ProgressCount",
    "ProgressPhase",
    "command_progress",
    "is_progress_shown",
    "plural",
    "say",
    "show_compile",
    "silence",
    "track",
]
