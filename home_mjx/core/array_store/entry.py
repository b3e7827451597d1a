"""One file of arrays and notes: written whole or not at all, checked when read, without pickle.

A zip file with two members: `notes.json`, and `data`, the bytes of all arrays in a row. An npz file, with a member and
a header per array, takes ten times as long to read, since houses have eighty small arrays.

An entry says what it is called, so that one under another name is not believed; its bytes have checksums; and it is
stored as it is, so that reading never takes more memory than the file.
"""

import errno
import json
import math
import os
import struct
import zipfile
import zlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from home_mjx.core.array_store.flatten import Arrays, Notes
from home_mjx.core.files import open_regular, write_whole

# What reading a made-up file can raise: by us, zipfile, JSON and NumPy.
BROKEN = (
    *(OSError, EOFError, ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RuntimeError),
    *(MemoryError, SyntaxError, zipfile.BadZipFile, zlib.error, struct.error),
)
SUFFIX = ".zip"
NOTES, DATA = "notes.json", "data"
ALIGN = 64  # [bytes]
MOST = (1 << 31) - 1  # bytes of a member: the list of a larger one's archive has another form
_MEMBER = struct.Struct("<4s6xH4x3L3H8xL")  # of an archive's list of members, before the name: APPNOTE.TXT, 4.3.12
_END = struct.Struct("<4s18x")  # of the list: 4.3.16
_LOCAL = 30  # [bytes], head of a member, before its name: 4.3.7
KINDS = "biuf"  # of dtypes that arrays may have


def write_entry(path: Path, arrays: Arrays, notes: Notes) -> None:
    """Writes an entry whole or not at all, see `write_whole`.

    Args:
        path: The file, whose name the entry keeps; its folder is made if need be.
        arrays: By name; any dtype but objects.
        notes: What JSON can hold, by name.

    Raises:
        OSError: The folder cannot be written to, or the arrays have more than 2 GiB.
    """
    table, chunks, at = {}, [], 0
    for name, array in arrays.items():
        data = array.tobytes()
        table[name] = (array.dtype.str, array.shape, at)
        padded = -(-len(data) // ALIGN) * ALIGN
        chunks.append(data.ljust(padded, b"\0"))
        at += padded
    if at > MOST:
        raise OSError(errno.EFBIG, f"arrays have {at} bytes, an entry holds {MOST}", str(path))
    head = json.dumps({"name": path.stem, "arrays": table, "notes": notes}).encode()
    head += b" " * (-(2 * _LOCAL + len(NOTES) + len(head) + len(DATA)) % ALIGN)  # so that data begins at a whole one
    members = {NOTES: head, DATA: b"".join(chunks)}
    with write_whole(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # without the time of day: equal content, equal bytes


def read_entry(path: Path) -> tuple[Arrays, Notes]:
    """The arrays and the notes of an entry.

    Raises:
        FileNotFoundError: There is no such entry.
        Exception: It is broken, or is another entry; one of `BROKEN`.
    """
    content = _content(path)
    notes, data = _members(content)
    head, numbers = _head(_sound(content, notes), path), _sound(content, data)
    if data.begin % ALIGN:  # as older versions wrote them
        numbers = numbers.copy()
    arrays = {name: _view(numbers, *place) for name, place in head["arrays"].items()}
    return arrays, head["notes"]


def read_notes(path: Path) -> Notes:
    """The notes alone; errors as of `read_entry`."""
    content = _content(path)
    return _head(_sound(content, _members(content)[0]), path)["notes"]


def _content(path: Path) -> np.ndarray:
    """The whole file, at once: entries are small, and looking about in them takes longer than reading them."""
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > 2 * MOST:
            raise ValueError(f"entry has {size} bytes")
        content = np.empty(size, np.uint8)
        if file.readinto(content.data) != size:
            raise ValueError("entry is being written over")
    return content


class _Member(NamedTuple):
    """Where the bytes of a member begin and end in the file, and their checksum."""

    begin: int
    end: int
    crc: int


def _members(content: np.ndarray) -> list[_Member]:
    """Both members, where `write_entry` has them, not packed.

    The archive's list at the end of the file is read here: `zipfile`, which reads any archive, takes twice as long as
    all the rest.
    """
    found, begin = [], 0
    at = listed = len(content) - _END.size - sum(_MEMBER.size + len(name) for name in (NOTES, DATA))
    if at < 0 or _END.unpack_from(content.data, len(content) - _END.size)[0] != b"PK\5\6":
        raise ValueError("entry is cut off, or no archive of ours")
    for name in (NOTES, DATA):
        mark, method, crc, stored, size, letters, *extra, place = _MEMBER.unpack_from(content.data, at)
        if method != zipfile.ZIP_STORED:
            raise ValueError("entry is packed")
        last = at + _MEMBER.size + len(name)
        known = mark == b"PK\1\2" and letters == len(name) and content[last - letters : last].tobytes() == name.encode()
        if not known or any(extra) or (stored, place) != (size, begin):
            raise ValueError("entry has other members")
        first = begin + _LOCAL + len(name)
        found.append(_Member(first, first + size, crc))
        at, begin = last, first + size
    if begin != listed:
        raise ValueError("entry has more or less than its members")
    return found


def _sound(content: np.ndarray, member: _Member) -> np.ndarray:
    found = content[member.begin : member.end]
    if zlib.crc32(found.data) != member.crc:
        raise ValueError("entry has bytes that were not written")
    return found


def _head(text: np.ndarray, path: Path) -> dict[str, Any]:
    head = json.loads(text.tobytes())
    if head["name"] != path.stem:
        raise ValueError(f"entry is that of {head['name']!s:.80}")
    return head


def _view(data: np.ndarray, dtype: str, shape: list[int], at: int) -> np.ndarray:
    kind = np.dtype(dtype)
    if kind.kind not in KINDS or min(at, *shape, 0) < 0:
        raise ValueError(f"entry has an array of type {dtype!s:.20} and shape {shape!s:.80}")
    size = kind.itemsize * math.prod(shape)
    return data[at : at + size].view(kind).reshape(shape)
