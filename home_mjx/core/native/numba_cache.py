"""Numba's cache on disk, with checksums: it has none, and machine code with a wrong byte ends the process.

Of several processes that find nothing there, one compiles; the others wait for it, and load what it has made.
"""

import functools
import hashlib
import json
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

from numba.core.caching import FunctionCache

from home_mjx.core.files import read_bytes, read_text, write_whole
from home_mjx.errors import DatasetError

T = TypeVar("T")

MAX_BYTES = 1 << 28  # of a compiled function
SUMS = "sha256.json"
LOCK = "lock"
WAIT_SECONDS = 300.0  # that one waits for another process; nothing takes so long to compile
POLL_SECONDS = 0.05

log = logging.getLogger(__name__)


def with_checked_cache(build: Callable[..., T]) -> Callable[..., T]:
    """Lets a function that compiles others of its own file, or loads them from Numba's cache, meet sound files only.

    What is not as it was noted, or was never noted, such as by a killed process, is removed before and so made anew.

    Args:
        build: Compiles functions with `cache=True`, all that its file has.

    Example:
        >>> @with_checked_cache  # doctest: +SKIP
        ... def build_handler(): ...
    """

    @functools.wraps(build)
    def checked(*args: Any) -> T:
        folder, stem = _place(build)
        if folder is None:
            return build(*args)
        sums = folder / f"{stem}.{SUMS}"
        with alone(folder / f"{stem}.{LOCK}"):
            drop_unsound(folder, stem, sums)
            made = build(*args)
            _note(folder, stem, sums)
        return made

    return checked


def with_cache_checked_once(function: Callable[..., T]) -> Callable[..., T]:
    """As `with_checked_cache`, at the first call only: for what is called often, always with the same types."""
    checked, done = with_checked_cache(function), []

    @functools.wraps(function)
    def first_checked(*args: Any) -> T:
        if done:
            return function(*args)
        made = checked(*args)
        done.append(True)
        return made

    return first_checked


def drop_unsound(folder: Path, stem: str, sums: Path) -> None:
    """Removes files of Numba's cache that are not as they were noted.

    Args:
        folder: Of the cache.
        stem: How the names of its files begin.
        sums: Where their digests are noted.
    """
    known = _noted(sums)
    for path in _files(folder, stem):
        if known.get(path.name) != _digest(path):
            log.log(logging.WARNING if path.name in known else logging.DEBUG, "cached code %s is made again", path)
            with suppress(OSError):  # another process was quicker
                path.unlink()


@contextmanager
def alone(lock: Path) -> Iterator[None]:
    """Runs the block while no other process does, or after `WAIT_SECONDS`; a killed one holds nobody up.

    Where files cannot be locked, as on Windows and some networks, it runs at once.

    Args:
        lock: A file that is made for this, and stays.
    """
    with ExitStack() as stack:
        with suppress(OSError, ImportError):
            import fcntl

            lock.parent.mkdir(parents=True, exist_ok=True)
            file, end = stack.enter_context(lock.open("ab")), time.monotonic() + WAIT_SECONDS
            while not _locked(fcntl, file) and time.monotonic() < end:
                time.sleep(POLL_SECONDS)
        yield


def _locked(fcntl: Any, file: IO[bytes]) -> bool:
    """Whether the file is ours now; given back when it is closed."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _place(build: Callable[[], Any]) -> tuple[Path | None, str]:
    """Folder of Numba's cache for a function's file, None if there is none; and how names in it begin."""
    stem = Path(build.__code__.co_filename).stem
    try:
        return Path(FunctionCache(build).cache_path), stem
    except RuntimeError:  # nowhere to write
        return None, stem


def _files(folder: Path, stem: str) -> list[Path]:
    return [*folder.glob(f"{stem}.*.nbi"), *folder.glob(f"{stem}.*.nbc")]


def _noted(sums: Path) -> dict[str, str]:
    with suppress(DatasetError, ValueError, RecursionError):
        known = json.loads(read_text(sums))
        return known if isinstance(known, dict) else {}
    return {}


def _digest(path: Path) -> str | None:
    try:
        return hashlib.sha256(read_bytes(path, most=MAX_BYTES)).hexdigest()
    except DatasetError:
        return None


def _note(folder: Path, stem: str, sums: Path) -> None:
    digests = {path.name: digest for path in _files(folder, stem) if (digest := _digest(path))}
    if digests == _noted(sums):
        return
    with suppress(OSError), write_whole(sums) as file:
        file.write(json.dumps(digests).encode())
