"""Digests of files, kept on disk, so that a later process need not read what has not changed.

A file counts as unchanged while its size, times of change (mtime and ctime) and inode are as they were. What was
changed less than two seconds before it was read is not kept: a second change might fall into the same tick of the
clock, as in Git's index. What this cannot see is a file whose content changed while all of these were kept, as by a
copy of a whole file system with other content; then set `HOME_MJX_RECHECK=1` or call `digests.forget_digests`.

Indices lie in the cache folder, one per dataset root and part of it. They are written whole or not at all. Processes
that write the same one at the same time may lose each other's lines, which are then only found again.
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

from home_mjx.core.files import read_bytes, write_whole
from home_mjx.core.paths import cache_folder

FORMAT = 1
MAX_BYTES = 1 << 28  # of an index: a million files
RECHECK_VARIABLE = "HOME_MJX_RECHECK"
YOUNG_SECONDS = 2.0  # the coarsest clock of a file system in use (FAT) ticks every two seconds

log = logging.getLogger(__name__)

Stamp = tuple[int, int, int, int]  # size, mtime and ctime [ns], inode


@dataclass(frozen=True)
class Facts:
    """What is in a file.

    Attributes:
        digest: SHA-256 of its content.
        names: What else it names: material libraries in other folders, or ids of models.
    """

    digest: bytes
    names: tuple[str, ...] = ()


def stamp_of(status: os.stat_result) -> Stamp:
    """By what a change of a file is seen without reading it."""
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


class DigestIndex:
    """Facts of files by name and stamp.

    Args:
        path: Where they are kept; a broken or missing file is an empty index.

    Attributes:
        unsaved: Facts that are not on disk yet.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.unsaved = 0
        self._known = {} if os.environ.get(RECHECK_VARIABLE) else _read(path)

    def facts(self, name: str, stamp: Stamp, look: Callable[[], Facts]) -> Facts:
        """The facts of a file; `look` reads them if the file is not known as it is now.

        Args:
            name: Of the file, any that is always the same.
            stamp: Taken before.
            look: Reads the file.
        """
        found = self._known.get(name)
        if found is not None and found[0] == stamp:
            return found[1]
        before = time.time()
        facts = look()
        if before - max(stamp[1], stamp[2]) * 1e-9 > YOUNG_SECONDS:  # nor is a time in the future believed
            self._known[name] = stamp, facts
            self.unsaved += 1
        return facts

    def save(self) -> None:
        """Adds what is new to the file; one that cannot be written only costs time."""
        if not self.unsaved:
            return
        self.unsaved = 0
        try:
            with write_whole(self.path) as file:
                file.write(_encode(_read(self.path) | self._known))
        except OSError as error:
            log.debug("digests are not kept: %s", error)


def _encode(known: dict[str, tuple[Stamp, Facts]]) -> bytes:
    lines = {name: [*stamp, facts.digest.hex(), *facts.names] for name, (stamp, facts) in known.items()}
    text = json.dumps({"format": FORMAT, "files": lines}).encode()
    return b"%08x\n" % zlib.crc32(text) + text


def _read(path: Path) -> dict[str, tuple[Stamp, Facts]]:
    try:
        check, _, text = read_bytes(path, most=MAX_BYTES).partition(b"\n")
        if int(check, 16) != zlib.crc32(text):
            return {}
        content: dict[str, Any] = json.loads(text)
        if content["format"] != FORMAT:
            return {}
        lines = content["files"].items()
        return {name: (tuple(line[:4]), Facts(bytes.fromhex(line[4]), tuple(line[5:]))) for name, line in lines}
    except (OSError, ValueError, KeyError, TypeError, IndexError, AttributeError):
        return {}


def index_folder(root: Path) -> Path:
    """Where the indices of a dataset root lie."""
    name = hashlib.sha256(os.fspath(root).encode(errors="surrogateescape")).hexdigest()[:16]
    return cache_folder() / "digests" / name
