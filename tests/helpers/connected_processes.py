"""Processes that connect to one another on this host."""

import socket
import subprocess
from collections.abc import Sequence


def free_port() -> int:
    """A port that nobody listened on a moment ago."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def finish(processes: Sequence[subprocess.Popen], seconds: float) -> list[str]:
    """Standard outputs of processes, all of which must succeed; none is left running."""
    try:
        ended = [process.communicate(timeout=seconds) for process in processes]
    finally:
        for process in processes:
            process.kill()
    for process, (_, errors) in zip(processes, ended, strict=True):
        assert process.returncode == 0, errors
    return [out for out, _ in ended]
