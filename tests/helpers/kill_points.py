"""A counting file system: kills its process at the n-th change that Python asks of the disk.

No sleep and hope: every file that is opened for writing, every write, fsync, rename, new folder and removal is counted,
so that a test can die at each of them. What libraries write without Python (Arrow, ffmpeg, XLA) is not seen.

Three ways to die: before an operation; with half of a write done; and with the power, when everything is lost that
nobody has forced to the disk (the harshest case of POSIX: names are kept, contents are not).
"""

import builtins
import contextlib
import io
import os
import resource
import signal
import stat
import threading
import time
from collections.abc import Callable
from typing import Any

BEFORE, TORN, POWER = "before", "torn", "power"
CHANGES = ("rename", "replace", "mkdir", "rmdir", "unlink", "remove", "chmod", "truncate", "link", "symlink")


class Disk:
    """What this process asks of the disk from `install` on.

    Args:
        at: Number of the operation that is not survived, from 1; 0: all are, and counted.
        how: `BEFORE`, `TORN` or `POWER`.

    Attributes:
        operations: Names of those so far.
    """

    def __init__(self, at: int = 0, how: str = BEFORE) -> None:
        self.at, self.how = at, how
        self.operations: list[str] = []
        self._lock = threading.RLock()
        self._forced: dict[int, tuple[int, int]] = {}  # by inode: a handle of its own, bytes that are on the disk

    def install(self) -> None:
        """For good: the process is one that is to die."""
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))  # a handle is kept of every file
        for name in CHANGES:
            setattr(os, name, self._counted(name, getattr(os, name)))
        sync = os.fsync
        os.fsync = lambda handle: self._sync(sync, handle)  # type: ignore[assignment]
        io.open = builtins.open = self._open(io.open)  # type: ignore[assignment]

    def reach(self, name: str, tear: Callable[[], Any] | None = None) -> None:
        """Counts an operation, or dies at it."""
        with self._lock:
            self.operations.append(name)
            if len(self.operations) != self.at:
                return
            if self.how == TORN and tear is not None:
                tear()
            if self.how == POWER:
                for handle, size in self._forced.values():
                    os.ftruncate(handle, min(size, os.fstat(handle).st_size))
            os.kill(os.getpid(), signal.SIGKILL)
            time.sleep(60)  # it is not at once that a thread is gone

    def meet(self, file: int, forced: int) -> None:
        """Notes how much of a file is on the disk."""
        status = os.fstat(file)
        if self.how == POWER and stat.S_ISREG(status.st_mode):
            inode = status.st_ino
            with self._lock:
                handle = self._forced[inode][0] if inode in self._forced else os.dup(file)
                self._forced[inode] = handle, forced

    def forced(self, file: int) -> int:
        """How much of a file is on the disk: of one from before, all."""
        status = os.fstat(file)
        return self._forced[status.st_ino][1] if status.st_ino in self._forced else status.st_size

    def _counted(self, name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def changed(*args: Any, **options: Any) -> Any:
            self.reach(name)
            return real(*args, **options)

        return changed

    def _sync(self, real: Callable[[Any], None], file: Any) -> None:
        self.reach("fsync")
        real(file)
        handle = file if isinstance(file, int) else file.fileno()
        if os.fstat(handle).st_ino in self._forced:
            self.meet(handle, os.fstat(handle).st_size)

    def _open(self, real: Callable[..., Any]) -> Callable[..., Any]:
        def opened(
            file: Any, mode: str = "r", buffering: int = -1, encoding: Any = None, errors: Any = None,
            newline: Any = None, closefd: bool = True, opener: Any = None,
        ) -> Any:  # fmt: skip
            if not set(mode) & set("wax+") or isinstance(file, int):
                return real(file, mode, buffering, encoding, errors, newline, closefd, opener)
            self.reach("open")
            raw = _File(self, file, "".join(c for c in mode if c not in "bt"), opener)
            if buffering == 0:
                return raw
            buffered = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
            if "b" in mode:
                return buffered
            text = io.TextIOWrapper(buffered, encoding, errors, newline, line_buffering=buffering == 1)
            text.mode = mode  # type: ignore[misc]
            return text

        return opened


class _File(io.FileIO):
    """A file whose writes are counted."""

    def __init__(self, disk: Disk, path: Any, mode: str, opener: Any) -> None:
        super().__init__(path, mode, opener=opener)
        self._disk = disk
        disk.meet(self.fileno(), 0 if mode[0] in "wx" else disk.forced(self.fileno()))

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        self._disk.reach("write", lambda: super(_File, self).write(view[: len(view) // 2]))
        return super().write(view)

    def truncate(self, size: int | None = None) -> int:
        self._disk.reach("truncate")
        return super().truncate(size)


def in_child(work: Callable[[], Any], seconds: float = 120.0) -> int:
    """The exit status of a forked child that does some work: 0, 1 with a traceback, or minus a signal.

    Only from a process without threads. What the child has started dies with it.
    """
    child = os.fork()
    if child == 0:
        os.setsid()
        signal.alarm(int(seconds))
        status = 1
        try:
            work()
            status = 0
        except BaseException:
            import traceback

            traceback.print_exc()
        finally:
            os._exit(status)
    _, status = os.waitpid(child, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(status)
