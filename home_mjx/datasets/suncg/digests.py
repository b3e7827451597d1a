"""Digests of the files that houses are compiled from."""

import functools
import hashlib
import json
import os
import re
import shutil
import time
from functools import cached_property
from pathlib import Path

from home_mjx.core.files import MAX_BYTES, read_text, resolve_below
from home_mjx.datasets.suncg.digest_index import DigestIndex, FileFacts, Stamp, file_stamp, index_folder
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.statements import library_names, split_statements
from home_mjx.errors import DatasetError

MODEL_ID_PATTERN = re.compile(r'"modelId"\s*:\s*("(?:[^"\\]|\\.)*")')
UNUSED_TABLES = ("joints.csv", "joints.sha256.json")  # tables that the compiler does not read
MTLLIB_PATTERN = re.compile(rb"(?:^|\r)[ \t]*mtllib[ \t]+(\S[^\r\n]*)", re.MULTILINE | re.IGNORECASE)
MIN_SAVE_SECONDS = 1.0  # [s], minimum time between two writes of the shared index


class SuncgDigests:
    """Digests of the input files of a dataset's houses; files shared by houses are read once.

    A file is read only if its size and times are not in the index, see `digest_index`. Textures are separate,
    since only a house that was read determines its textures.

    Args:
        root: Absolute dataset root.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._prefix = os.path.join(root, "")
        self._assets = AssetLibrary(root)
        self._models: dict[str, bytes] = {}
        self._textures: dict[str, str] = {}
        self._folder = index_folder(root)
        self._shared = _shared_index(self._folder / "shared.json")
        self._saved = 0.0

    def house(self, house_id: str) -> bytes:
        """Return the digest of a house's files, its models and the tables; a missing folder counts as empty.

        Textures and `UNUSED_TABLES` are not included. New digests are saved to the index. The id is not checked.
        """
        own = DigestIndex(self._folder / "houses" / f"{house_id}.json")
        digest = hashlib.sha256()
        document = self.root / "house" / house_id
        for folder in (document, self.root / "room" / house_id, self.root / "wall" / house_id):
            digest.update(self._digest(folder, own))
        digest.update(self._tables)
        for name in sorted(self._model_ids(document / "house.json", own)):
            digest.update(self._model(name))
        own.save()
        self.save(MIN_SAVE_SECONDS)
        return digest.digest()

    def texture(self, path: str) -> str:
        """Return the hexadecimal digest of the image at an absolute path; "" if it does not exist.

        The first result for a path is returned by later calls, whatever happens to the file.
        """
        if path not in self._textures:
            found = os.path.isfile(path)
            self._textures[path] = (
                self._facts(path, file_stamp(os.stat(path)), self._shared).digest.hex() if found else ""
            )
        return self._textures[path]

    def has_texture(self, name: str) -> bool:
        """Return whether the image of a texture, named without extension, that a house lacked now exists.

        Each object looks up a name once. False for a name that leads out of the dataset.
        """
        textures = self._assets.textures
        return resolve_below(self.root, textures.folder, name) is not None and textures.find(name) is not None

    def save(self, interval: float = 0.0) -> None:
        """Save new digests of shared files to disk, unless that was done less than `interval` [s] ago."""
        if self._shared.unsaved and time.monotonic() - self._saved >= interval:
            self._shared.save()
            self._saved = time.monotonic()

    @cached_property
    def _tables(self) -> bytes:
        """Digest of all files in `metadata/` except `UNUSED_TABLES`; computed once."""
        return self._digest(self.root / "metadata", self._shared)

    def _model(self, name: str) -> bytes:
        """Return the digest of the folder of a model id, in which its variants are; cached."""
        if name not in self._models:
            self._models[name] = self._digest(self._assets.model_path(name, name).parent, self._shared)
        return self._models[name]

    def _digest(self, folder: Path, index: DigestIndex) -> bytes:
        """Return the digest of a folder's relative path and of its files, with the MTLs elsewhere that OBJs name.

        `UNUSED_TABLES` and files in subfolders are left out; a missing folder is as an empty one.
        """
        digest = hashlib.sha256(folder.relative_to(self.root).as_posix().encode(errors="replace"))
        for name, path, stamp in _files(folder):
            if name in UNUSED_TABLES:
                continue
            facts = self._facts(path, stamp, index)
            digest.update(name.encode(errors="replace") + b"\0" + facts.digest)
            for relative in facts.names if name.endswith(".obj") else ():
                digest.update(self._elsewhere(folder, relative))
        return digest.digest()

    def _elsewhere(self, folder: Path, relative: str) -> bytes:
        """Return the digest of the file at a path from `folder`; b"" if it is missing or outside the dataset."""
        found = resolve_below(self.root, folder, relative)
        return (
            self._facts(str(found), file_stamp(found.stat()), self._shared).digest if found and found.is_file() else b""
        )

    def _model_ids(self, document: Path, index: DigestIndex) -> tuple[str, ...]:
        """Return the `_model_names` of a house.json, from the index if it is unchanged; () if the file is missing."""
        if not document.is_file():
            return ()
        return self._facts(str(document), file_stamp(document.stat()), index).names

    def _facts(self, path: str, stamp: Stamp, index: DigestIndex) -> FileFacts:
        """Return the facts of a file from the index, where its name is the path relative to the root."""
        below = path.removeprefix(self._prefix)
        name = below if below != path else os.path.relpath(path, self.root)
        return index.facts(name, stamp, lambda: _look(path, stamp[0]))


@functools.lru_cache(maxsize=8)
def _shared_index(path: Path) -> DigestIndex:
    """Return the index of files shared by the houses of a dataset, one for all `SuncgDigests` of a process.

    Those of the last eight datasets are kept.
    """
    return DigestIndex(path)


def _look(path: str, size: int) -> FileFacts:
    """Read the facts of a file of `size` bytes; beyond `MAX_BYTES` its size is hashed instead of its content.

    Names are those of `_libraries_elsewhere` for an OBJ, of `_model_names` for a house.json, and none for other files.
    """
    data = Path(path).read_bytes() if size <= MAX_BYTES else str(size).encode()
    names: tuple[str, ...] = ()
    if path.endswith(".obj"):
        names = _libraries_elsewhere(data)
    elif os.path.basename(path) == "house.json":
        names = _model_names(Path(path))
    return FileFacts(hashlib.sha256(data).digest(), names)


def _libraries_elsewhere(data: bytes) -> tuple[str, ...]:
    """Return the paths, with `/`, that the `mtllib` lines of an OBJ may mean; names without a folder are omitted."""
    found = [name.decode(errors="replace").rstrip() for name in MTLLIB_PATTERN.findall(data)]
    if any(text.endswith("\\") for text in found):  # continued on the next line
        statements = split_statements(data.decode(errors="replace"))
        found = [rest.rstrip() for _, keyword, rest in statements if keyword == "mtllib"]
    texts = dict.fromkeys(name.replace("\\", "/") for text in found for name in library_names(text))
    return tuple(text for text in texts if "/" in text)


def _model_names(document: Path) -> tuple[str, ...]:
    """Return the distinct model ids in a house.json that can be names of files, sorted; () if it is unreadable.

    They are the strings behind every `"modelId":` of the text, of hidden nodes too; the text need not be valid JSON.
    Omitted are "", `.` and `..`, ids of 256 characters and more, and those with a slash, backslash or NUL.
    """
    try:
        text = read_text(document)
    except DatasetError:
        return ()  # loading the house reports the error
    names = {_decoded(literal) for literal in MODEL_ID_PATTERN.findall(text)}
    plain = (n for n in names if n not in ("", ".", "..") and len(n) < 256 and not any(c in n for c in "/\\\0"))
    return tuple(sorted(plain))


def _decoded(literal: str) -> str:
    """Return the string of a JSON literal; "" if it is invalid."""
    try:
        return json.loads(literal)
    except ValueError:
        return ""


def _files(folder: Path) -> list[tuple[str, str, Stamp]]:
    """Return name, path and stamp of the files in a folder, sorted by name; [] if there is no folder.

    Links count as the files that they lead to; folders are left out.
    """
    try:
        with os.scandir(folder) as entries:
            return sorted((e.name, e.path, file_stamp(e.stat())) for e in entries if e.is_file())
    except (FileNotFoundError, NotADirectoryError):
        return []


def clear_shared_indices() -> None:
    """Drop the shared indices of this process with their unsaved facts, as in a new process; for measurements."""
    _shared_index.cache_clear()


def delete_digest_indices(root: Path) -> None:
    """Delete the indices of the dataset at an absolute root, so that new `SuncgDigests` read all its files again.

    Errors of deletion are ignored. Existing `SuncgDigests` keep what they know.
    """
    clear_shared_indices()
    shutil.rmtree(index_folder(root), ignore_errors=True)
