"""One file of arrays and notes: written whole or not at all, checked when read, without pickle.

A zip file with two members: `notes.json`, and `data`, the bytes of all arrays in a row. An npz file, with a member and
a header per array, takes ten times as long to read, since houses have eighty small arrays.
"""

import json
import zipfile
import zlib
from pathlib import Path

import numpy as np

from home_mjx.core.files import write_whole
from home_mjx.scene_compile.cache.flatten import Arrays, Notes

BROKEN = (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error, RuntimeError)
SUFFIX = ".zip"
NOTES, DATA = "notes.json", "data"
ALIGN = 64  # [bytes]


def write_entry(path: Path, arrays: Arrays, notes: Notes) -> None:
    """Writes an entry whole or not at all, see `write_whole`.

    Args:
        path: The file; its folder is made if need be.
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
    members = {NOTES: json.dumps({"arrays": table, "notes": notes}).encode(), DATA: b"".join(chunks)}
    with write_whole(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # without the time of day: equal content, equal bytes


def read_entry(path: Path) -> tuple[Arrays, Notes]:
    """The arrays and the notes of an entry.

    Raises:
        FileNotFoundError: There is no such entry.
        OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile, RuntimeError: It is broken; see `BROKEN`.
    """
    with zipfile.ZipFile(path) as archive:
        head, data = json.loads(archive.read(NOTES)), np.frombuffer(bytearray(archive.read(DATA)), np.uint8)
    arrays = {name: _view(data, *place) for name, place in head["arrays"].items()}
    return arrays, head["notes"]


def read_notes(path: Path) -> Notes:
    """The notes alone; errors as of `read_entry`."""
    with zipfile.ZipFile(path) as archive:
        return json.loads(archive.read(NOTES))["notes"]


def _view(data: np.ndarray, dtype: str, shape: list[int], at: int) -> np.ndarray:
    kind = np.dtype(dtype)
    size = kind.itemsize * int(np.prod(shape, dtype=np.int64))
    return data[at : at + size].view(kind).reshape(shape)
