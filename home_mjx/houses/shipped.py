"""Compiled houses that a distribution ships: one read-only archive of cache entries, a level below the user's cache.

The archive is a zip file with LZMA. Its members are the entries of houses, of those models that cannot be decoded from
the source's own library, and of bakes, by their paths in the cache. The member `index.json` has the version of the
compiler, a digest of the inputs, and for each house its models, textures and bakes. An archive of another compiler or
of other inputs holds nothing. Damage costs time only: the house is then compiled.
"""

import functools
import json
import logging
import lzma
import zipfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from home_mjx.core.array_store import READ_ERRORS, Arrays, JsonFields, pack_entry, parse_entry, write_entry
from home_mjx.core.files import write_atomically
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import ShippedSource
from home_mjx.houses.version import version
from home_mjx.schema.compiled import Model

INDEX_MEMBER = "index.json"
MAX_MEMBER_BYTES = 1 << 28  # [bytes], maximum size of an unpacked member
CODED = "coded"  # note with the names of coded arrays
STAMP = (1980, 1, 1, 0, 0, 0)  # of all members: equal content, equal bytes

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ShippedHouse:
    """Row of the index.

    Attributes:
        id: Id of the house.
        models: Keys of its models.
        textures: Paths of its textures relative to the dataset.
        bakes: Members that are bakes of the house.
    """

    id: str
    models: tuple[str, ...]
    textures: tuple[str, ...]
    bakes: tuple[str, ...]


class ShippedHouses:
    """Houses of an archive by the name of their cache entry; empty if it does not fit the installed code.

    Args:
        source: Place and inputs of the archive; None for no archive.
    """

    def __init__(self, source: ShippedSource | None = None) -> None:
        self.inputs = b"" if source is None else source.digest()
        self.houses: dict[str, ShippedHouse] = {}
        self._source = source
        self._members: frozenset[str] = frozenset()
        if source is None:
            return
        try:
            with zipfile.ZipFile(source.path) as archive:
                index = json.loads(_read_member(archive, INDEX_MEMBER))
                self._members = frozenset(archive.namelist())
            if (index["compiler"], index["inputs"]) != (version(), self.inputs.hex()):
                log.info("shipped houses are of other code, they are not used: %s", source.path)
                return
            self.houses = {
                key: ShippedHouse(row["id"], *(tuple(row[name]) for name in ("models", "textures", "bakes")))
                for key, row in index["houses"].items()
            }
        except FileNotFoundError:
            log.info("there are no shipped houses: %s", source.path)
        except READ_ERRORS as error:
            log.warning("shipped houses are damaged, houses are compiled instead: %s: %s", source.path, error)

    def read(self, member: str) -> tuple[Arrays, JsonFields]:
        """Return the arrays and the notes of an entry.

        Raises:
            Exception: The archive is damaged; one of `READ_ERRORS`.
        """
        assert self._source is not None
        with zipfile.ZipFile(self._source.path) as archive:
            content = _read_member(archive, member)
        return decode_arrays(*parse_entry(np.frombuffer(content, np.uint8), Path(member).stem))

    def has(self, member: str) -> bool:
        """Return whether the archive has a member, even if it does not fit the installed code."""
        return member in self._members

    def write_textures(self, paths: Iterable[str], progress: bool = False) -> None:
        """Write those textures of `paths` that are missing in the dataset's folder, each once, see `ShippedSource`."""
        assert self._source is not None
        self._source.write_textures(tuple(dict.fromkeys(paths)), progress)

    def library_model(self, key: str) -> Model | None:
        """Return the model with a key, built from the source's own library; None if it does not have this model."""
        assert self._source is not None
        return self._source.library_model(key)

    def unpack_bakes(self, house: ShippedHouse) -> None:
        """Copy the bakes of a house into the cache, except those that are there.

        Raises:
            Exception: The archive is damaged, or the cache is not writable; one of `READ_ERRORS`.
        """
        for member in house.bakes:
            path = cache_folder() / member
            if not path.is_file():
                write_entry(path, *self.read(member))


@functools.lru_cache(maxsize=8)
def _open_cached(source: ShippedSource, stamp: tuple[int, int]) -> ShippedHouses:
    """Return the shipped houses of a source; `stamp`, size and time of its file, is only a part of the cache's key."""
    return ShippedHouses(source)


def open_shipped(source: ShippedSource | None) -> ShippedHouses:
    """Return the shipped houses of a source, opened once per process unless the file's size or time changes.

    They are empty for None, for a missing or damaged file, and for one of other code.
    """
    stamp = (0, 0)
    if source is not None:
        with suppress(OSError):
            status = source.path.stat()
            stamp = status.st_size, status.st_mtime_ns
    return ShippedHouses() if source is None else _open_cached(source, stamp)


def write_archive(
    path: Path,
    source: ShippedSource,
    houses: Mapping[str, ShippedHouse],
    members: Mapping[str, tuple[Arrays, JsonFields]],
) -> None:
    """Write an archive for `ShippedHouses`.

    Args:
        path: The file.
        source: Inputs of the houses.
        houses: Row of each house by the name of its entry.
        members: Arrays and notes of the entries by member.

    Raises:
        OSError: The file cannot be written; an earlier one then stays.
    """
    rows = {key: asdict(house) for key, house in sorted(houses.items())}
    index = {"compiler": version(), "inputs": source.digest().hex(), "houses": rows}
    content = {INDEX_MEMBER: json.dumps(index, sort_keys=True).encode()}
    content |= {name: pack_entry(Path(name), *encode_arrays(*members[name])) for name in sorted(members)}
    with write_atomically(path) as file, zipfile.ZipFile(file, "w", zipfile.ZIP_LZMA) as archive:
        for name, data in content.items():
            info = zipfile.ZipInfo(name, STAMP)
            info.compress_type = zipfile.ZIP_LZMA
            archive.writestr(info, data)


def _read_member(archive: zipfile.ZipFile, member: str) -> bytes:
    """Return the bytes of a member; one of `READ_ERRORS` if it is missing, too large or damaged."""
    size = archive.getinfo(member).file_size
    if size > MAX_MEMBER_BYTES:
        raise ValueError(f"{member} has {size} bytes")
    try:
        return archive.read(member)
    except lzma.LZMAError as error:
        raise ValueError(f"{member} is damaged: {error}") from None


def encode_arrays(arrays: Arrays, notes: JsonFields) -> tuple[Arrays, JsonFields]:
    """Return an entry with arrays that LZMA packs better, exactly: differences of rows, and planes of bytes.

    Distance fields, of type uint16, become differences modulo 2**16; they need a sixth of the bytes. Arrays of type
    float16 become their low bytes and then their high bytes. Other arrays, and those with one axis, are unchanged. A
    note has the types of the coded arrays by name.
    """
    coded = {name: array.dtype.str for name, array in arrays.items() if _is_coded(array)}
    packed = {name: _encode(array) if name in coded else array for name, array in arrays.items()}
    return packed, {**notes, CODED: coded}


def decode_arrays(arrays: Arrays, notes: JsonFields) -> tuple[Arrays, JsonFields]:
    """Return the entry that `encode_arrays` coded; `KeyError` for an entry that it did not code."""
    coded = notes[CODED]
    plain = {name: _decode(array, coded[name]) if name in coded else array for name, array in arrays.items()}
    return plain, {name: note for name, note in notes.items() if name != CODED}


def _is_coded(array: np.ndarray) -> bool:
    """Return whether an array is coded: little-endian float16 or uint16, two or more axes, and not empty."""
    return array.dtype.str in ("<f2", "<u2") and array.ndim > 1 and array.size > 0


def _encode(array: np.ndarray) -> np.ndarray:
    """Return a coded array: uint16 as differences along the first axis, float16 as bytes with a new first axis of 2."""
    if array.dtype.kind == "u":
        return np.diff(array, axis=0, prepend=np.zeros_like(array[:1]))
    return np.ascontiguousarray(np.moveaxis(np.ascontiguousarray(array)[..., None].view(np.uint8), -1, 0))


def _decode(array: np.ndarray, dtype: str) -> np.ndarray:
    """Return the array of type `dtype` that `_encode` coded."""
    if np.dtype(dtype).kind == "u":
        return np.cumsum(array, axis=0, dtype=dtype)
    return np.ascontiguousarray(np.moveaxis(array, 0, -1)).view(dtype)[..., 0]
