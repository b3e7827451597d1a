"""Results that follow from the content of their inputs alone, kept on disk for later houses and processes.

The cache of compiled houses selects the folder, one per version of the compiler. Without a folder nothing is kept.
Entries are named by a digest of their inputs, written atomically and verified by their CRCs. A damaged entry is
computed and written again; a folder that cannot be written to only costs time.
"""

import hashlib
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from home_mjx.core.array_store import ENTRY_SUFFIX, READ_ERRORS, flatten, read_entry, rebuild, write_entry
from home_mjx.schema.compiled import Model

T = TypeVar("T")

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ResultStore:
    """Place of kept results.

    Attributes:
        folder: Folder of the entries, one subfolder per kind.
        find_model: Returns the compiled model with a key; None if it is not kept.
    """

    folder: Path
    find_model: Callable[[str], Model | None]


_STORE: ContextVar[ResultStore | None] = ContextVar("store of kept results", default=None)


@contextmanager
def keep_results(store: ResultStore) -> Iterator[None]:
    """Make `kept_result` and `find_model` use a store during the block, in this thread; then restore the former one."""
    token = _STORE.set(store)
    try:
        yield
    finally:
        _STORE.reset(token)


def find_model(key: str) -> Model | None:
    """Return the kept model with a key of `geometry.meshes.make_model`; None without it or without a store."""
    store = _STORE.get()
    return None if store is None else store.find_model(key)


def kept_result(kind: type[T], inputs: bytes, compute: Callable[[], T]) -> T:
    """Return the result kept in the store of `keep_results`, or compute and keep it; compute only if there is no store.

    A broken entry is computed again, with a warning. A result that cannot be written is still returned.

    Args:
        kind: Dataclass of the result, of arrays and JSON values; see `core.array_store.flatten`.
        inputs: Everything that determines the result, apart from the compiler's code.
        compute: Computes the result.

    Example:
        >>> kept_result(BoxSet, b"a chair", lambda: make_boxes([0.0, 0, 0.5], 0.5)).top.tolist()  # doctest: +SKIP
        [1.0]
    """
    store = _STORE.get()
    if store is None:
        return compute()
    path = store.folder / kind.__name__ / f"{hashlib.sha256(inputs).hexdigest()}{ENTRY_SUFFIX}"
    try:
        return rebuild(kind, *read_entry(path))
    except FileNotFoundError:
        pass
    except READ_ERRORS as error:
        log.warning("broken cache entry %s is computed again: %s", path, error)
    result = compute()
    try:
        write_entry(path, *flatten(result))
    except OSError as error:
        log.debug("result is not kept: %s", error)
    return result
