"""Which files a house is compiled from, and what is in them."""

import functools
import hashlib
import json
import os
import re
import shutil
import time
from functools import cached_property
from pathlib import Path

from home_mjx.core.files import MAX_BYTES, below, read_text
from home_mjx.datasets.suncg.digest_index import DigestIndex, Facts, Stamp, index_folder, stamp_of
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.errors import DatasetError

MODEL_ID = re.compile(r'"modelId"\s*:\s*("(?:[^"\\]|\\.)*")')
UNUSED = ("joints.csv", "joints.sha256.json")  # tables that nothing is compiled from
LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+(\S.*?)[ \t\r]*$", re.MULTILINE)
SAVE_SECONDS = 1.0  # least time between two writings of the index of what houses share


class Inputs:
    """Digests of what the houses of a dataset are compiled from; what houses share is looked at once.

    A file is read only if it is not known from its size and times, see `digest_index`. Textures are apart: only who
    has read a house knows which it shows.

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
        """Digest of a house's own files, of the models that it names and of the tables; missing files count as such."""
        own = DigestIndex(self._folder / "houses" / f"{house_id}.json")
        digest = hashlib.sha256()
        document = self.root / "house" / house_id
        for folder in (document, self.root / "room" / house_id, self.root / "wall" / house_id):
            digest.update(self._digest(folder, own))
        digest.update(self._tables)
        for name in sorted(self._model_ids(document / "house.json", own)):
            digest.update(self._model(name))
        own.save()
        self.save(SAVE_SECONDS)
        return digest.digest()

    def texture(self, path: str) -> str:
        """Digest of an image, "" if there is none."""
        if path not in self._textures:
            found = os.path.isfile(path)
            self._textures[path] = (
                self._facts(path, stamp_of(os.stat(path)), self._shared).digest.hex() if found else ""
            )
        return self._textures[path]

    def has_texture(self, name: str) -> bool:
        """Whether there is an image of a texture that a house lacked."""
        textures = self._assets.textures
        return below(self.root, textures.folder, name) is not None and textures.find(name) is not None

    def save(self, interval: float = 0.0) -> None:
        """Keeps on disk what was read, unless that was done less than `interval` seconds ago."""
        if self._shared.unsaved and time.monotonic() - self._saved >= interval:
            self._shared.save()
            self._saved = time.monotonic()

    @cached_property
    def _tables(self) -> bytes:
        return self._digest(self.root / "metadata", self._shared)

    def _model(self, name: str) -> bytes:
        """Digest of the folder in which a model lies."""
        if name not in self._models:
            self._models[name] = self._digest(self._assets.model_path(name, name).parent, self._shared)
        return self._models[name]

    def _digest(self, folder: Path, index: DigestIndex) -> bytes:
        digest = hashlib.sha256(folder.relative_to(self.root).as_posix().encode(errors="replace"))
        for name, path, stamp in _files(folder):
            if name in UNUSED:
                continue
            facts = self._facts(path, stamp, index)
            digest.update(name.encode(errors="replace") + b"\0" + facts.digest)
            for relative in facts.names if name.endswith(".obj") else ():
                digest.update(self._elsewhere(folder, relative))
        return digest.digest()

    def _elsewhere(self, folder: Path, relative: str) -> bytes:
        """Digest of a material library that lies in another folder."""
        found = below(self.root, folder, relative)
        return (
            self._facts(str(found), stamp_of(found.stat()), self._shared).digest if found and found.is_file() else b""
        )

    def _model_ids(self, document: Path, index: DigestIndex) -> tuple[str, ...]:
        """Names of models in a house.json; those that are no plain names are left out."""
        if not document.is_file():
            return ()
        return self._facts(str(document), stamp_of(document.stat()), index).names

    def _facts(self, path: str, stamp: Stamp, index: DigestIndex) -> Facts:
        below = path.removeprefix(self._prefix)
        name = below if below != path else os.path.relpath(path, self.root)
        return index.facts(name, stamp, lambda: _look(path, stamp[0]))


@functools.lru_cache(maxsize=8)
def _shared_index(path: Path) -> DigestIndex:
    """What the houses of a dataset share; one for all `Inputs` of a process."""
    return DigestIndex(path)


def _look(path: str, size: int) -> Facts:
    """What is in a file; of one that is larger than what is ever read only the size counts."""
    data = Path(path).read_bytes() if size <= MAX_BYTES else str(size).encode()
    names: tuple[str, ...] = ()
    if path.endswith(".obj"):
        names = _libraries_elsewhere(data)
    elif os.path.basename(path) == "house.json":
        names = _model_names(Path(path))
    return Facts(hashlib.sha256(data).digest(), names)


def _libraries_elsewhere(data: bytes) -> tuple[str, ...]:
    """Material libraries in other folders that an OBJ file names."""
    texts = dict.fromkeys(name.decode(errors="replace").replace("\\", "/") for name in LIBRARY.findall(data))
    return tuple(text for text in texts if "/" in text)


def _model_names(document: Path) -> tuple[str, ...]:
    """Names of models in a house.json, whatever characters they have; those that are no plain names are left out."""
    try:
        text = read_text(document)
    except DatasetError:
        return ()  # loading the house will say what is wrong
    names = {_decoded(literal) for literal in MODEL_ID.findall(text)}
    plain = (n for n in names if n not in ("", ".", "..") and len(n) < 256 and not any(c in n for c in "/\\\0"))
    return tuple(sorted(plain))


def _decoded(literal: str) -> str:
    try:
        return json.loads(literal)
    except ValueError:
        return ""


def _files(folder: Path) -> list[tuple[str, str, Stamp]]:
    """Name, path and stamp of the regular files in a folder, in order."""
    try:
        with os.scandir(folder) as entries:
            return sorted((e.name, e.path, stamp_of(e.stat())) for e in entries if e.is_file())
    except (FileNotFoundError, NotADirectoryError):
        return []


def forget_files() -> None:
    """Has this process look at every file again, as a new one would; for measurements."""
    _shared_index.cache_clear()


def forget_digests(root: Path) -> None:
    """Has all files of a dataset read again, by this process and by those that start from now on.

    Args:
        root: Absolute dataset root.
    """
    forget_files()
    shutil.rmtree(index_folder(root), ignore_errors=True)
