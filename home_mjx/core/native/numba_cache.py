"""Verification of Numba's on-disk cache with SHA-256.

Numba does not check integrity, and corrupted machine code crashes the process. If several processes miss the cache,
one compiles; the others wait for it and load its result.
"""

import functools
import gc
import hashlib
import inspect
import json
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

from numba.core.caching import FunctionCache

from home_mjx.core.files import read_bytes, read_text, write_atomically
from home_mjx.errors import DatasetError

T = TypeVar("T")

MAX_CODE_BYTES = 1 << 28  # maximum size of a compiled function
DIGESTS_SUFFIX = "sha256.json"
LOCK_SUFFIX = "lock"
MAX_LOCK_WAIT_SECONDS = 300.0  # [s], maximum wait for another process; no compilation takes that long
POLL_SECONDS = 0.05  # [s]

log = logging.getLogger(__name__)


def verify_cache(build: Callable[..., T]) -> Callable[..., T]:
    """Wrap a function that compiles the functions of its own file, so that it loads only verified cache files.

    Cache files whose digest differs or was never recorded, such as those of a killed process, are deleted first and
    thus recompiled. Digests are recorded afterwards; a lock excludes other processes. `build` takes positional
    arguments and compiles all functions of its file with `cache=True`.
    """

    @functools.wraps(build)
    def checked(*args: Any) -> T:
        """Run `build` with verified cache files, under the lock."""
        folder, stem = _place(build)
        if folder is None:
            return build(*args)
        sums = folder / f"{stem}.{DIGESTS_SUFFIX}"
        with exclusive_lock(folder / f"{stem}.{LOCK_SUFFIX}"):
            delete_unverified(folder, stem, sums)
            with pause_gc():  # an eighth of the time
                made = build(*args)
            _note(folder, stem, sums)
        return made

    return checked


def verify_cache_once(function: Callable[..., T]) -> Callable[..., T]:
    """Apply `verify_cache` until a call succeeds; later calls run `function` directly, whatever their arguments."""
    checked, done = verify_cache(function), []

    @functools.wraps(function)
    def first_checked(*args: Any) -> T:
        """Call `function`, with verified cache files until a call has succeeded."""
        if done:
            return function(*args)
        made = checked(*args)
        done.append(True)
        return made

    return first_checked


@contextmanager
def pause_gc() -> Iterator[None]:
    """Suspend cyclic garbage collection during a `with` block that keeps most of what it allocates.

    The collector would scan all of it repeatedly. Memory of cycles is freed by the first collection afterwards.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def is_recorded(build: Callable[..., Any]) -> bool:
    """Return whether digests of functions that `build` compiles are recorded; also True if there is no cache folder.

    The files may be of other sources: then the functions are compiled anew.
    """
    folder, stem = _place(build)
    return folder is None or (folder / f"{stem}.{DIGESTS_SUFFIX}").exists()


def delete_unverified(folder: Path, stem: str, sums: Path) -> None:
    """Delete files of Numba's cache whose SHA-256 digest is unrecorded or differs from the recorded one.

    Args:
        folder: Folder of the cache.
        stem: Prefix of its file names.
        sums: JSON file of the recorded digests by file name; if it is missing or broken, all are deleted.
    """
    known = _noted(sums)
    for path in _files(folder, stem):
        if known.get(path.name) != _digest(path):
            log.log(logging.WARNING if path.name in known else logging.DEBUG, "cached code %s is recompiled", path)
            with suppress(OSError):  # already deleted by another process
                path.unlink()


@contextmanager
def exclusive_lock(lock: Path) -> Iterator[None]:
    """Hold an exclusive lock on a file during the block; after `MAX_LOCK_WAIT_SECONDS` the block runs without it.

    The operating system releases the lock of a killed process. If files cannot be locked, as on Windows and some
    networks, the block runs at once. The file is created if missing, and never deleted.
    """
    with ExitStack() as stack:
        with suppress(OSError, ImportError):
            import fcntl

            lock.parent.mkdir(parents=True, exist_ok=True)
            file, end = stack.enter_context(lock.open("ab")), time.monotonic() + MAX_LOCK_WAIT_SECONDS
            while not _locked(fcntl, file) and time.monotonic() < end:
                time.sleep(POLL_SECONDS)
        yield


def _locked(fcntl: Any, file: IO[bytes]) -> bool:
    """Try to lock a file without waiting; return False if another process holds the lock. Closing it releases it."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _place(build: Callable[[], Any]) -> tuple[Path | None, str]:
    """Return the folder of Numba's cache, None if there is none, and the stem of the source file of `build`.

    All cache files of the functions in that source file begin with the stem. `build` is not called.
    """
    build = inspect.unwrap(build)  # a type checker may have wrapped it in a function of another file
    stem = Path(build.__code__.co_filename).stem
    try:
        return Path(FunctionCache(build).cache_path), stem
    except RuntimeError:  # no writable cache folder
        return None, stem


def _files(folder: Path, stem: str) -> list[Path]:
    """Return the index and code files of Numba's cache for a source file."""
    return [*folder.glob(f"{stem}.*.nbi"), *folder.glob(f"{stem}.*.nbc")]


def _noted(sums: Path) -> dict[str, str]:
    """Return the recorded digests by file name; empty if their file is missing or broken."""
    with suppress(DatasetError, ValueError, RecursionError):
        known = json.loads(read_text(sums))
        return known if isinstance(known, dict) else {}
    return {}


def _digest(path: Path) -> str | None:
    """Return the SHA-256 of a file in hexadecimal; None if it cannot be read."""
    try:
        return hashlib.sha256(read_bytes(path, max_bytes=MAX_CODE_BYTES)).hexdigest()
    except DatasetError:
        return None


def _note(folder: Path, stem: str, sums: Path) -> None:
    """Record the digests of all cache files; errors of writing are ignored."""
    digests = {path.name: digest for path in _files(folder, stem) if (digest := _digest(path))}
    if digests == _noted(sums):
        return
    with suppress(OSError), write_atomically(sums) as file:
        file.write(json.dumps(digests).encode())
