"""Which processes a killed program has left, for tests of kills."""

import os
import time
from collections.abc import Callable
from pathlib import Path


def processes_of(folder: Path) -> set[int]:
    """Live processes with a folder in their environment."""
    found = set()
    for path in Path("/proc").glob("[0-9]*/environ"):
        try:
            if str(folder).encode() in path.read_bytes() and int(path.parent.name) != os.getpid():
                found.add(int(path.parent.name))
        except OSError:
            continue
    return found


def wait_for(condition: Callable[[], object], seconds: float = 60) -> None:
    """Returns as soon as the condition holds; fails if it does not for long."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.002)
