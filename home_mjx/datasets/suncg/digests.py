"""Which files a house is compiled from, and what is in them."""

import functools
import hashlib
import json
import os
import re
from functools import cached_property
from pathlib import Path

from home_mjx.core.files import MAX_BYTES, below, read_text
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.errors import DatasetError

MODEL_ID = re.compile(r'"modelId"\s*:\s*("(?:[^"\\]|\\.)*")')
LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+(\S.*?)[ \t\r]*$", re.MULTILINE)


class Inputs:
    """Digests of what the houses of a dataset are compiled from; what houses share is looked at once.

    Textures are apart: only who has read a house knows which it shows.

    Args:
        root: Absolute dataset root.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._assets = AssetLibrary(root)
        self._models: dict[str, bytes] = {}
        self._textures: dict[str, str] = {}

    def house(self, house_id: str) -> bytes:
        """Digest of a house's own files, of the models that it names and of the tables; missing files count as such."""
        digest = hashlib.sha256()
        document = self.root / "house" / house_id
        for folder in (document, self.root / "room" / house_id, self.root / "wall" / house_id):
            digest.update(self._folder(folder))
        digest.update(self._tables)
        for name in sorted(_model_ids(document / "house.json")):
            digest.update(self._model(name))
        return digest.digest()

    @cached_property
    def _tables(self) -> bytes:
        return self._folder(self.root / "metadata")

    def _model(self, name: str) -> bytes:
        """Digest of the folder in which a model lies."""
        if name not in self._models:
            self._models[name] = self._folder(self._assets.model_path(name, name).parent)
        return self._models[name]

    def texture(self, path: str) -> str:
        """Digest of an image, "" if there is none."""
        if path not in self._textures:
            self._textures[path] = _facts(path, *_stamp(os.stat(path)))[0].hex() if os.path.isfile(path) else ""
        return self._textures[path]

    def _folder(self, folder: Path) -> bytes:
        digest = hashlib.sha256(folder.relative_to(self.root).as_posix().encode(errors="replace"))
        for name, path, stamp in _files(folder):
            content, libraries = _facts(path, *stamp)
            digest.update(name.encode(errors="replace") + b"\0" + content)
            for relative in libraries:
                digest.update(self._elsewhere(folder, relative))
        return digest.digest()

    def _elsewhere(self, folder: Path, relative: str) -> bytes:
        """Digest of a material library that lies in another folder."""
        found = below(self.root, folder, relative)
        return _facts(str(found), *_stamp(found.stat()))[0] if found and found.is_file() else b""


def _model_ids(document: Path) -> set[str]:
    """Names of models in a house.json, whatever characters they have; those that are no plain names are left out."""
    try:
        text = read_text(document)
    except DatasetError:
        return set()  # loading the house will say what is wrong
    names = {_decoded(literal) for literal in MODEL_ID.findall(text)}
    return {n for n in names if n not in ("", ".", "..") and len(n) < 256 and not any(c in n for c in "/\\\0")}


def _decoded(literal: str) -> str:
    try:
        return json.loads(literal)
    except ValueError:
        return ""


def _files(folder: Path) -> list[tuple[str, str, tuple[int, int]]]:
    """Name, path and stamp of the regular files in a folder, in order."""
    try:
        with os.scandir(folder) as entries:
            return sorted((e.name, e.path, _stamp(e.stat())) for e in entries if e.is_file())
    except (FileNotFoundError, NotADirectoryError):
        return []


def _stamp(status: os.stat_result) -> tuple[int, int]:
    return status.st_size, status.st_mtime_ns


@functools.lru_cache(maxsize=1 << 16)
def _facts(path: str, size: int, changed: int) -> tuple[bytes, tuple[str, ...]]:
    """SHA-256 of a file, and of an OBJ file the material libraries that it names in other folders.

    Of a file that is larger than what is ever read only the size counts. Size and time of change are there to keep a
    process from reading the same file for every house.
    """
    data = Path(path).read_bytes() if size <= MAX_BYTES else str(size).encode()
    names = LIBRARY.findall(data) if path.endswith(".obj") else []
    texts = dict.fromkeys(name.decode(errors="replace").replace("\\", "/") for name in names)
    return hashlib.sha256(data).digest(), tuple(text for text in texts if "/" in text)


def forget_files() -> None:
    """Has every file read again, as a new process would; for measurements."""
    _facts.cache_clear()
