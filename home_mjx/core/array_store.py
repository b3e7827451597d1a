"""One file of arrays and notes: written atomically, verified on reading, without pickle.

A zip file with two members: `notes.json`, and `data`, the concatenated bytes of all arrays. An npz file has one member
and one header per array. It takes ten times as long to read, since a house has about eighty small arrays.

An entry stores its own name, so that a file renamed to another entry's name is rejected. Its members have checksums.
They are stored uncompressed, so reading never takes more memory than the size of the file.
"""

import dataclasses
import errno
import functools
import io
import json
import math
import os
import struct
import typing
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from home_mjx.core.files import open_regular, write_atomically

# Exceptions that a corrupted or crafted file can raise here, in zipfile, JSON and NumPy.
READ_ERRORS = (
    *(OSError, EOFError, ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RuntimeError),
    *(MemoryError, SyntaxError, zipfile.BadZipFile, zlib.error, struct.error),
)
ENTRY_SUFFIX = ".zip"
NOTES_MEMBER, DATA_MEMBER = "notes.json", "data"
ALIGNMENT = 64  # [bytes], alignment of arrays
MAX_MEMBER_BYTES = (1 << 31) - 1  # [bytes], maximum size of a member; a larger one would need the ZIP64 format
_MEMBER = struct.Struct("<4s6xH4x3L3H8xL")  # central directory header, before the name: APPNOTE.TXT, 4.3.12
_END = struct.Struct("<4s18x")  # end of central directory record: 4.3.16
_LOCAL = 30  # [bytes], local file header of a member, before its name: 4.3.7
DTYPE_KINDS = "biuf"  # allowed kinds of array dtypes
T = TypeVar("T")
Arrays = dict[str, np.ndarray]
JsonFields = dict[str, Any]  # JSON-serializable values


def flatten(record: Any, skip: frozenset[str] = frozenset(), prefix: str = "") -> tuple[Arrays, JsonFields]:
    """Flatten a dataclass and nested ones to arrays and JSON values, by dotted name.

    A tuple of arrays becomes the arrays `name.0`, `name.1`, ... and its length a JSON value; an array is not copied.

    Args:
        record: A dataclass of arrays, strings, numbers, tuples of arrays or of strings, and such dataclasses.
        skip: Dotted names of fields to omit, with the prefix.
        prefix: Prefix of the names, which ends with a dot.
    """
    arrays: Arrays = {}
    notes: JsonFields = {}
    for field in dataclasses.fields(record):
        name, value = prefix + field.name, getattr(record, field.name)
        if name in skip:
            continue
        if dataclasses.is_dataclass(value):
            inner_arrays, inner_notes = flatten(value, skip, f"{name}.")
            arrays |= inner_arrays
            notes |= inner_notes
        elif isinstance(value, np.ndarray):
            arrays[name] = value
        elif isinstance(value, tuple) and value and isinstance(value[0], np.ndarray):
            arrays |= {f"{name}.{i}": item for i, item in enumerate(value)}
            notes[name] = len(value)
        else:
            notes[name] = dict(value) if isinstance(value, Mapping) else value
    return arrays, notes


def rebuild(cls: type[T], arrays: Mapping[str, np.ndarray], notes: JsonFields, prefix: str = "", **given: Any) -> T:
    """Rebuild a record from the output of `flatten`, with arrays and notes by dotted name.

    Args:
        cls: Class of the record.
        arrays: Arrays by dotted name.
        notes: JSON values by dotted name.
        prefix: Prefix of the names, which ends with a dot.
        given: Values by field name of the outermost record's skipped fields; not validated.

    Other entries of `arrays` and `notes` are ignored, and types of JSON values are not checked.

    Raises:
        KeyError: A field is missing.
        ValueError: An array's dtype or shape differs from the hint, or axes of one name differ within the record.
    """
    hints = _hints(cls)
    values = dict(given)
    lengths = _numbered(cls).copy()
    for field in dataclasses.fields(typing.cast(Any, cls)):
        name = prefix + field.name
        if field.name in given:
            continue
        if dataclasses.is_dataclass(hints[field.name]):
            values[field.name] = rebuild(hints[field.name], arrays, notes, f"{name}.")
        elif name in arrays:
            values[field.name] = _checked(arrays[name], hints[field.name], name, lengths)
        else:
            values[field.name] = _from_note(name, notes[name], hints[field.name], arrays)
    return cls(**values)


@functools.cache
def _numbered(cls: type) -> dict[str, int]:
    """Return the numeric axis lengths of a record class's array fields, see `_numbers`."""
    return _numbers(hint for hint in _hints(cls).values() if hasattr(hint, "dim_str"))


def _numbers(hints: Iterable[Any]) -> dict[str, int]:
    """Return the axis lengths that are numeric in jaxtyping hints, by axis name, such as {"3": 3} for "n 3"."""
    return {axis: int(axis) for hint in hints for axis in _axes(hint) if axis.isdigit()}


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    """Return the resolved type hints of a class, cached."""
    return typing.get_type_hints(cls)


def _from_note(name: str, note: Any, hint: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    """Restore a field that is no single array: a JSON value, a tuple, or a tuple of arrays (`note` is its length)."""
    if typing.get_origin(hint) is not tuple:
        return note
    if isinstance(note, list):
        return tuple(note)
    each = typing.get_args(hint)[0]
    return tuple(_checked(arrays[f"{name}.{i}"], each, name, _numbers((each,))) for i in range(note))


def _checked(array: np.ndarray, hint: Any, name: str, lengths: dict[str, int]) -> np.ndarray:
    """Return the array; raise `ValueError` if its dtype or axes differ from the hint, or an axis from `lengths`.

    Axes without an entry in `lengths` are added to it.
    """
    axes, shape = _axes(hint), array.shape
    fits = len(axes) == len(shape) and _fits(array.dtype, hint)
    for axis, n in zip(axes, shape, strict=False):
        fits = fits and lengths.setdefault(axis, n) == n
    if not fits:
        raise ValueError(f"`{name}` is {array.dtype} {shape}, expected {axes}")
    return array


@functools.cache
def _axes(hint: Any) -> tuple[str, ...]:
    """Return the axis names of a jaxtyping hint, such as ("n", "3")."""
    return tuple(hint.dim_str.split())


@functools.cache
def _fits(dtype: np.dtype, hint: Any) -> bool:
    """Return whether a jaxtyping hint allows the dtype."""
    return dtype.name in hint.dtypes


def write_entry(path: Path, arrays: Arrays, notes: JsonFields) -> None:
    """Write an entry atomically, see `write_atomically`. Equal content gives equal bytes.

    Args:
        path: The file, whose stem is stored in the entry; its folder is created if necessary.
        arrays: Boolean, integer or float arrays by name; `read_entry` rejects other dtypes.
        notes: JSON-serializable values by name.

    Raises:
        OSError: The folder is not writable, or the arrays have more than 2 GiB.
    """
    content = pack_entry(path, arrays, notes)
    with write_atomically(path) as file:
        file.write(content)


def pack_entry(path: Path, arrays: Arrays, notes: JsonFields) -> bytes:
    """Return the bytes that `write_entry` writes; arguments and errors as there."""
    table, chunks, at = {}, [], 0
    for name, array in arrays.items():
        data = array.tobytes()
        table[name] = (array.dtype.str, array.shape, at)
        padded = -(-len(data) // ALIGNMENT) * ALIGNMENT
        chunks.append(data.ljust(padded, b"\0"))
        at += padded
    if at > MAX_MEMBER_BYTES:
        raise OSError(errno.EFBIG, f"arrays have {at} bytes, an entry holds at most {MAX_MEMBER_BYTES}", str(path))
    head = json.dumps({"name": path.stem, "arrays": table, "notes": notes}).encode()
    before = 2 * _LOCAL + len(NOTES_MEMBER) + len(head) + len(DATA_MEMBER)
    head += b" " * (-before % ALIGNMENT)  # aligns the data member
    members = {NOTES_MEMBER: head, DATA_MEMBER: b"".join(chunks)}
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # no timestamp: equal content, equal bytes
    return file.getvalue()


def read_entry(path: Path) -> tuple[Arrays, JsonFields]:
    """Return the arrays by name and the notes of an entry; arrays are writable views of one buffer.

    Raises:
        FileNotFoundError: There is no such entry.
        Exception: The file is corrupted, or was renamed from another entry; one of `READ_ERRORS`.
    """
    return parse_entry(_content(path), path.stem)


def parse_entry(content: np.ndarray, name: str) -> tuple[Arrays, JsonFields]:
    """Return the arrays and the notes of an entry's bytes, both verified by their checksums.

    Arrays are views of `content`, so they are writable if it is. Entries of older versions are not aligned; theirs are
    views of a copy.

    Args:
        content: All bytes of the file, as `uint8`.
        name: Name of the entry, which must be the one stored in it.

    Raises:
        Exception: The bytes are corrupted, or belong to another entry; one of `READ_ERRORS`.
    """
    notes, data = _members(content)
    head, numbers = _head(_sound(content, notes), name), _sound(content, data)
    if data.begin % ALIGNMENT:  # entries of older versions are not aligned
        numbers = numbers.copy()
    arrays = {name: _view(numbers, *place) for name, place in head["arrays"].items()}
    return arrays, head["notes"]


def read_notes(path: Path) -> JsonFields:
    """Return only the notes of an entry, without verifying its arrays; errors as of `read_entry`."""
    content = _content(path)
    return _head(_sound(content, _members(content)[0]), path.stem)["notes"]


def _content(path: Path) -> np.ndarray:
    """Return all bytes of a regular file as a 1-D uint8 array.

    Raises:
        OSError: The file is missing (`FileNotFoundError`), not a regular file, or cannot be read.
        ValueError: It has more than twice `MAX_MEMBER_BYTES`, or has become shorter since it was opened.
    """
    # Entries are small, and seeking takes longer than reading them.
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > 2 * MAX_MEMBER_BYTES:
            raise ValueError(f"entry has {size} bytes")
        content = np.empty(size, np.uint8)
        if file.readinto(content.data) != size:
            raise ValueError("entry was overwritten while it was read")
    return content


class _Member(NamedTuple):
    """Byte range and checksum of a member in the file."""

    begin: int
    end: int
    crc: int


def _members(content: np.ndarray) -> list[_Member]:
    """Return the members notes and data, in this order; raise `ValueError` for archives not written by `write_entry`.

    Only the central directory at the end of the file is parsed. `zipfile`, which reads any archive, takes twice as long
    as everything else.
    """
    found, begin = [], 0
    at = listed = len(content) - _END.size - sum(_MEMBER.size + len(name) for name in (NOTES_MEMBER, DATA_MEMBER))
    if at < 0 or _END.unpack_from(content.data, len(content) - _END.size)[0] != b"PK\5\6":
        raise ValueError("entry is truncated, or not written by home_mjx")
    for name in (NOTES_MEMBER, DATA_MEMBER):
        mark, method, crc, stored, size, letters, *extra, place = _MEMBER.unpack_from(content.data, at)
        if method != zipfile.ZIP_STORED:
            raise ValueError("entry is packed (compressed), expected stored members")
        last = at + _MEMBER.size + len(name)
        known = mark == b"PK\1\2" and letters == len(name) and content[last - letters : last].tobytes() == name.encode()
        if not known or any(extra) or (stored, place) != (size, begin):
            raise ValueError("entry has unexpected members")
        first = begin + _LOCAL + len(name)
        found.append(_Member(first, first + size, crc))
        at, begin = last, first + size
    if begin != listed:
        raise ValueError("entry has bytes outside its members, or overlapping members")
    return found


def _sound(content: np.ndarray, member: _Member) -> np.ndarray:
    """Return a member's bytes, a view; raise `ValueError` if its CRC-32 differs."""
    found = content[member.begin : member.end]
    if zlib.crc32(found.data) != member.crc:
        raise ValueError("entry has a wrong checksum")
    return found


def _head(text: np.ndarray, name: str) -> dict[str, Any]:
    """Parse the notes member; raise `ValueError` if its stored name is another."""
    head = json.loads(text.tobytes())
    if head["name"] != name:
        raise ValueError(f"entry belongs to {head['name']!s:.80}")
    return head


def _view(data: np.ndarray, dtype: str, shape: list[int], at: int) -> np.ndarray:
    """Return the array at byte `at` of the data member, uncopied; `ValueError` for other dtypes or negative sizes."""
    kind = np.dtype(dtype)
    if kind.kind not in DTYPE_KINDS or min(at, *shape, 0) < 0:
        raise ValueError(f"entry has an array of type {dtype!s:.20} and shape {shape!s:.80}")
    size = kind.itemsize * math.prod(shape)
    return data[at : at + size].view(kind).reshape(shape)
