"""Compiled houses that a distribution ships: one read-only archive of cache entries, a level below the user's cache.

The archive is a zip file with LZMA. Its members are the entries of houses, of those models that cannot be decoded from
the source's own library, and of bakes, by their paths in the cache. The member `index.json` has the version of the
compiler, a digest of the inputs, and for each house its models, textures and bakes. An archive of another compiler or
of other inputs holds nothing. Damage costs time only: the house is then compiled.
"""

import functools
import json
import logging
import zipfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from home_mjx.core.array_store import READ_ERRORS, Arrays, JsonFields, parse_entry
from home_mjx.core.files import write_atomically
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import ShippedSource
from home_mjx.houses.version import version
from home_mjx.schema.compiled import Model

INDEX_MEMBER = "index.json"
MAX_MEMBER_BYTES = 1 << 28  # [bytes], maximum size of an unpacked member
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
                index = json.loads(archive.read(INDEX_MEMBER))
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

    def read(self, member: str) -> tuple[bytes, Arrays, JsonFields]:
        """Return the bytes of an entry, its arrays and its notes.

        Raises:
            Exception: The archive is damaged; one of `READ_ERRORS`.
        """
        assert self._source is not None
        with zipfile.ZipFile(self._source.path) as archive:
            if archive.getinfo(member).file_size > MAX_MEMBER_BYTES:
                raise ValueError(f"{member} has {archive.getinfo(member).file_size} bytes")
            content = archive.read(member)
        return content, *parse_entry(np.frombuffer(content, np.uint8), Path(member).stem)

    def has(self, member: str) -> bool:
        """Return whether the archive has a member."""
        return member in self._members

    def write_textures(self, paths: Iterable[str], progress: bool = False) -> None:
        """Write the textures that are missing in the dataset's folder, see `ShippedSource`."""
        assert self._source is not None
        self._source.write_textures(tuple(dict.fromkeys(paths)), progress)

    def library_model(self, key: str) -> Model | None:
        """Return the model with a key, built from the source's own library; None if it does not have this model."""
        assert self._source is not None
        return self._source.library_model(key)

    def unpack_bakes(self, house: ShippedHouse) -> None:
        """Copy the bakes of a house into the cache, unless they are there."""
        for member in house.bakes:
            path = cache_folder() / member
            if not path.is_file():
                with write_atomically(path) as file:
                    file.write(self.read(member)[0])


@functools.lru_cache(maxsize=8)
def _opened(source: ShippedSource, stamp: tuple[int, int]) -> ShippedHouses:
    return ShippedHouses(source)


def open_shipped(source: ShippedSource | None) -> ShippedHouses:
    """Return the shipped houses of a source, opened once per process unless the file changes; empty for None."""
    stamp = (0, 0)
    if source is not None:
        with suppress(OSError):
            status = source.path.stat()
            stamp = status.st_size, status.st_mtime_ns
    return ShippedHouses() if source is None else _opened(source, stamp)


def write_archive(
    path: Path, source: ShippedSource, houses: Mapping[str, ShippedHouse], members: Mapping[str, bytes]
) -> None:
    """Write an archive for `ShippedHouses`.

    Args:
        path: The file.
        source: Inputs of the houses.
        houses: Row of each house by the name of its entry.
        members: Entries by member.

    Raises:
        OSError: The file cannot be written.
    """
    rows = {key: asdict(house) for key, house in sorted(houses.items())}
    index = {"compiler": version(), "inputs": source.digest().hex(), "houses": rows}
    content = {INDEX_MEMBER: json.dumps(index, sort_keys=True).encode(), **dict(sorted(members.items()))}
    with write_atomically(path) as file, zipfile.ZipFile(file, "w", zipfile.ZIP_LZMA) as archive:
        for name, data in content.items():
            info = zipfile.ZipInfo(name, STAMP)
            info.compress_type = zipfile.ZIP_LZMA
            archive.writestr(info, data)
