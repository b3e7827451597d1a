"""One file of arrays and notes: written whole or not at all, checked when read, without pickle.

A zip file with two members: `notes.json`, and `data`, the bytes of all arrays in a row. An npz file, with a member and
a header per array, takes ten times as long to read, since houses have eighty small arrays.

An entry says what it is called, so that one under another name is not believed; its bytes have checksums; and it is
stored as it is, so that reading never takes more memory than the file.
"""

import json
import math
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.core.files import open_regular, write_whole
from home_mjx.scene_compile.cache.flatten import Arrays, Notes

# What reading a made-up file can raise: by us, zipfile, JSON and NumPy.
BROKEN = (
    *(OSError, EOFError, ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RuntimeError),
    *(MemoryError, SyntaxError, zipfile.BadZipFile, zlib.error, struct.error),
)
SUFFIX = ".zip"
NOTES, DATA = "notes.json", "data"
ALIGN = 64  # [bytes]
KINDS = "biuf"  # of dtypes that arrays may have


def write_entry(path: Path, arrays: Arrays, notes: Notes) -> None:
    """Writes an entry whole or not at all, see `write_whole`.

    Args:
        path: The file, whose name the entry keeps; its folder is made if need be.
        arrays: By name; any dtype but objects.
        notes: What JSON can hold, by name.

    Raises:
        OSError: The folder cannot be written to.
    """
    table, chunks, at = {}, [], 0
    for name, array in arrays.items():
        data = array.tobytes()
        table[name] = (array.dtype.str, array.shape, at)
        padded = -(-len(data) // ALIGN) * ALIGN
        chunks.append(data.ljust(padded, b"\0"))
        at += padded
    members = {NOTES: json.dumps({"name": path.stem, "arrays": table, "notes": notes}).encode(), DATA: b"".join(chunks)}
    with write_whole(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # without the time of day: equal content, equal bytes


def read_entry(path: Path) -> tuple[Arrays, Notes]:
    """The arrays and the notes of an entry.

    Raises:
        FileNotFoundError: There is no such entry.
        Exception: It is broken, or is another entry; one of `BROKEN`.
    """
    with _opened(path) as archive:
        head, data = _head(archive, path), np.frombuffer(bytearray(archive.read(DATA)), np.uint8)
    arrays = {name: _view(data, *place) for name, place in head["arrays"].items()}
    return arrays, head["notes"]


def read_notes(path: Path) -> Notes:
    """The notes alone; errors as of `read_entry`."""
    with _opened(path) as archive:
        return _head(archive, path)["notes"]


@contextmanager
def _opened(path: Path) -> Iterator[zipfile.ZipFile]:
    """Raises `ValueError` for what would unpack to more than there is, and `OSError` for what is no regular file."""
    with open_regular(path) as file, zipfile.ZipFile(file) as archive:
        if any(info.compress_type != zipfile.ZIP_STORED for info in archive.infolist()):
            raise ValueError("entry is packed")
        if sum(info.file_size for info in archive.infolist()) > path.stat().st_size:
            raise ValueError("entry says that it is larger than its file")
        yield archive


def _head(archive: zipfile.ZipFile, path: Path) -> dict[str, Any]:
    head = json.loads(archive.read(NOTES))
    if head["name"] != path.stem:
        raise ValueError(f"entry is that of {head['name']!s:.80}")
    return head


def _view(data: np.ndarray, dtype: str, shape: list[int], at: int) -> np.ndarray:
    kind = np.dtype(dtype)
    if kind.kind not in KINDS or min(at, *shape, 0) < 0:
        raise ValueError(f"entry has an array of type {dtype!s:.20} and shape {shape!s:.80}")
    size = kind.itemsize * math.prod(shape)
    return data[at : at + size].view(kind).reshape(shape)
