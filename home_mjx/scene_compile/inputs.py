"""Which files a house is compiled from, and what is in them."""

import functools
import hashlib
import json
import re
from pathlib import Path

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.suncg.assets import Assets
from home_mjx.scene_compile.suncg.files import MAX_BYTES, below, read_text

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
        self._assets = Assets(root)
        self._shared: dict[Path, bytes] = {}

    def house(self, house_id: str) -> bytes:
        """Digest of a house's own files, of the models that it names and of the tables; missing files count as such."""
        digest = hashlib.sha256()
        document = self.root / "house" / house_id
        for folder in (document, self.root / "room" / house_id, self.root / "wall" / house_id):
            digest.update(self._folder(folder))
        shared = {self._assets.model_path(name, name).parent for name in _model_ids(document / "house.json")}
        for folder in (self.root / "metadata", *sorted(shared)):
            if folder not in self._shared:
                self._shared[folder] = self._folder(folder)
            digest.update(self._shared[folder])
        return digest.digest()

    def texture(self, path: str) -> str:
        """Digest of an image, "" if there is none."""
        file = Path(path)
        if file not in self._shared:
            self._shared[file] = file_digest(file) if file.is_file() else b""
        return self._shared[file].hex()

    def _folder(self, folder: Path) -> bytes:
        digest = hashlib.sha256(folder.relative_to(self.root).as_posix().encode(errors="replace"))
        files = sorted(path for path in folder.iterdir() if path.is_file()) if folder.is_dir() else []
        for path in files:
            digest.update(path.name.encode(errors="replace") + b"\0" + file_digest(path))
            if path.suffix == ".obj":
                digest.update(b"".join(map(self._elsewhere, _libraries(path))))
        return digest.digest()

    def _elsewhere(self, path: Path) -> bytes:
        """Digest of a material library that lies in another folder."""
        found = below(self.root, path.parent, path.name)
        return file_digest(found) if found and found.is_file() else b""


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


def file_digest(path: Path) -> bytes:
    """SHA-256 of a file, or of its size if it is larger than what is ever read.

    Size and time of change only keep a process from reading the same file for every house.
    """
    status = path.stat()
    return _digest(path, status.st_size, status.st_mtime_ns)


@functools.lru_cache(maxsize=1 << 16)
def _digest(path: Path, size: int, changed: int) -> bytes:
    return hashlib.sha256(path.read_bytes() if size <= MAX_BYTES else str(size).encode()).digest()


def _libraries(path: Path) -> tuple[Path, ...]:
    status = path.stat()
    return _named_libraries(path, status.st_size, status.st_mtime_ns)


@functools.lru_cache(maxsize=1 << 16)
def _named_libraries(path: Path, size: int, changed: int) -> tuple[Path, ...]:
    """The material libraries in other folders that an OBJ file names."""
    names = LIBRARY.findall(path.read_bytes()) if size <= MAX_BYTES else []
    texts = [name.decode(errors="replace").replace("\\", "/") for name in names]
    return tuple(path.parent / text for text in dict.fromkeys(texts) if "/" in text)
