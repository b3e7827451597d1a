"""On-disk index of file digests, so that later processes do not read unchanged files again.

A file counts as unchanged while its size, modification and change time (mtime, ctime) and inode are the same. A file
that changed less than two seconds before it was read is not indexed: a second change might fall into the same clock
tick, as in Git's index. Changed content with all of these equal is not detected, such as after copying a whole file
system. Then set `HOME_MJX_RECHECK=1` or call `digests.delete_digest_indices`.

Indices are in the cache folder, one per dataset root and part of it. They are written atomically. Processes that
write the same index at the same time may lose each other's entries, which are then only recomputed.
"""

import hashlib
import json
import logging
import os
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from home_mjx.core.files import read_bytes, write_atomically
from home_mjx.core.paths import cache_folder

FORMAT = 1
MAX_INDEX_BYTES = 1 << 28  # maximum size of an index: a million files
RECHECK_VARIABLE = "HOME_MJX_RECHECK"
MIN_AGE_SECONDS = 2.0  # [s], minimum age of an indexed file; the clock of FAT ticks every two seconds

log = logging.getLogger(__name__)

Stamp = tuple[int, int, int, int]  # size, mtime and ctime [ns], inode


@dataclass(frozen=True)
class FileFacts:
    """Digest of a file and names of other files in it.

    Attributes:
        digest: SHA-256 of its content.
        names: Names in the file: material libraries in other folders, or ids of models.
    """

    digest: bytes
    names: tuple[str, ...] = ()


def file_stamp(status: os.stat_result) -> Stamp:
    """Return size, mtime [ns], ctime [ns] and inode, which detect a changed file without reading it."""
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


class DigestIndex:
    """Index of the facts of files, by name and stamp.

    Args:
        path: File of the index; a broken or missing file is an empty index.

    Attributes:
        unsaved: Number of facts that are not on disk yet.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.unsaved = 0
        self._known = {} if os.environ.get(RECHECK_VARIABLE) else _read(path)

    def facts(self, name: str, stamp: Stamp, read: Callable[[], FileFacts]) -> FileFacts:
        """Return the indexed facts of a file; call `read` and add its result if no entry has this name and stamp.

        Facts of a file that changed at most `MIN_AGE_SECONDS` before this call, or in the future, are not added.

        Args:
            name: Name of the file, in a constant form.
            stamp: Stamp of the file, taken before this call.
            read: Reads the file.
        """
        found = self._known.get(name)
        if found is not None and found[0] == stamp:
            return found[1]
        before = time.time()
        facts = read()
        if before - max(stamp[1], stamp[2]) * 1e-9 > MIN_AGE_SECONDS:  # times in the future are not trusted
            self._known[name] = stamp, facts
            self.unsaved += 1
        return facts

    def save(self) -> None:
        """Add all facts of this index to the entries of the file on disk; do nothing without new ones.

        A failed write raises nothing. Its facts are written only by a later call that has further new ones.
        """
        if not self.unsaved:
            return
        self.unsaved = 0
        try:
            with write_atomically(self.path) as file:
                file.write(_encode(_read(self.path) | self._known))
        except OSError as error:
            log.debug("digests are not saved: %s", error)


def _encode(known: dict[str, tuple[Stamp, FileFacts]]) -> bytes:
    """Return the content of an index file: the CRC-32 of a JSON text in hexadecimal, a line feed, and the text."""
    lines = {name: [*stamp, facts.digest.hex(), *facts.names] for name, (stamp, facts) in known.items()}
    text = json.dumps({"format": FORMAT, "files": lines}).encode()
    return b"%08x\n" % zlib.crc32(text) + text


def _read(path: Path) -> dict[str, tuple[Stamp, FileFacts]]:
    """Return the entries of an index file; {} if it is missing, damaged or of another format."""
    try:
        check, _, text = read_bytes(path, max_bytes=MAX_INDEX_BYTES).partition(b"\n")
        if int(check, 16) != zlib.crc32(text):
            return {}
        content: dict[str, Any] = json.loads(text)
        if content["format"] != FORMAT:
            return {}
        lines = content["files"].items()
        return {name: (tuple(line[:4]), FileFacts(bytes.fromhex(line[4]), tuple(line[5:]))) for name, line in lines}
    except (OSError, ValueError, KeyError, TypeError, IndexError, AttributeError):
        return {}


def index_folder(root: Path) -> Path:
    """Return the folder of a dataset root's digest indices, below the cache folder; it may not exist."""
    name = hashlib.sha256(os.fspath(root).encode(errors="surrogateescape")).hexdigest()[:16]
    return cache_folder() / "digests" / name
