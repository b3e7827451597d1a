"""Compiled houses on disk, addressed by what they were compiled from.

Below the cache folder lies one folder per version of the format and the compiler; in it `houses/` and `models/`, since
houses share most models. Entries are npz files without pickle, written whole or not at all, and checked by their CRCs.
"""

import functools
import hashlib
import json
import logging
import os
import re
import tempfile
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.scene_compile.compile import DEFAULT_OPTIONS, CompileOptions, compile_house
from home_mjx.scene_compile.compiled import CompiledHouse, Model
from home_mjx.scene_compile.records import Arrays, Notes, flatten, rebuild
from home_mjx.scene_compile.suncg import Dataset

FORMAT = 1
VARIABLE = "HOME_MJX_CACHE"
NOTES = "notes"  # member of an npz file that holds JSON
BROKEN = (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error)

log = logging.getLogger(__name__)


def cache_folder() -> Path:
    """Where compiled houses are kept: `$HOME_MJX_CACHE`, else `home_mjx` in the user's cache folder."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "home_mjx"


def load_compiled(
    dataset: Dataset,
    house_id: str,
    options: CompileOptions = DEFAULT_OPTIONS,
    library: dict[str, Model] | None = None,
) -> CompiledHouse:
    """A compiled house, from the cache if nothing it depends on has changed.

    A broken entry is compiled and written again; a folder that cannot be written to only costs time.

    Args:
        dataset: An open dataset.
        house_id: Which house.
        options: How to compile it.
        library: Models by key that other houses have brought; new ones are added, so that houses share them.

    Raises:
        DatasetError: The house is unknown or broken.
    """
    library = {} if library is None else library
    folder = cache_folder() / _version()
    entry = folder / "houses" / f"{_key(dataset.root, house_id, options)}.npz"
    broken = False
    try:
        return _read_house(entry, folder / "models", dataset.root, library)
    except FileNotFoundError:
        pass
    except BROKEN as error:
        broken = True
        log.warning("broken cache entry %s is made again: %s", entry, error)
    house = compile_house(dataset.load_house(house_id), dataset.metadata, options)
    try:
        _write_house(house, entry, folder / "models", dataset.root, broken)
    except OSError as error:
        log.warning("compiled house is not cached: %s", error)
    return replace(house, models={key: library.setdefault(key, model) for key, model in house.models.items()})


@functools.cache
def _version() -> str:
    """Name of the format and of the code that compiles, so that a changed compiler never meets old entries."""
    code = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*")):
        if path.suffix in (".py", ".csv", ".json", ".npz"):
            code.update(path.read_bytes())
    return f"v{FORMAT}-{code.hexdigest()[:12]}"


def _key(root: Path, house_id: str, options: CompileOptions) -> str:
    """Digest of the options and of every file that the house is read from."""
    digest = hashlib.sha256(repr((house_id, options)).encode())
    for path in _inputs(root, house_id):
        digest.update(str(path.relative_to(root)).encode() + _digest_of(path))
    return digest.hexdigest()


def _inputs(root: Path, house_id: str) -> list[Path]:
    document = root / "house" / house_id / "house.json"
    text = document.read_text(encoding="utf-8", errors="replace") if document.is_file() else ""
    models = set(re.findall(r'"modelId"\s*:\s*"([\w.-]+)"', text))
    folders = [root / "house" / house_id, root / "room" / house_id, root / "metadata"]
    folders += [root / "object" / model for model in models]
    files = [path for folder in folders if folder.is_dir() for path in folder.iterdir() if path.is_file()]
    return sorted(files)


def _digest_of(path: Path) -> bytes:
    status = path.stat()
    return _digest(path, status.st_size, status.st_mtime_ns)


@functools.lru_cache(maxsize=1 << 14)
def _digest(path: Path, size: int, changed: int) -> bytes:
    """Digest of a file; size and time of change only keep a process from reading the same file for every house."""
    return hashlib.sha256(path.read_bytes()).digest()


def _write_house(house: CompiledHouse, entry: Path, models: Path, root: Path, mend: bool) -> None:
    """Writes the house and those of its models that are not there yet, or all of them to mend what is broken."""
    for key, model in house.models.items():
        path = _model_path(models, key)
        if mend or not path.is_file():
            _write(path, *flatten(model))
    arrays, notes = flatten(house, skip=frozenset(("models",)))
    notes["materials.texture"] = [_relative(path, root) for path in house.materials.texture]
    _write(entry, arrays, notes)


def _read_house(entry: Path, models: Path, root: Path, library: dict[str, Model]) -> CompiledHouse:
    arrays, notes = _read(entry)
    keys = dict.fromkeys(notes["instances.model"])
    for key in keys:
        if key not in library:
            library[key] = rebuild(Model, *_read(_model_path(models, key)))
    house = rebuild(CompiledHouse, arrays, notes, models={key: library[key] for key in keys})
    texture = tuple(_absolute(path, root) for path in house.materials.texture)
    return replace(house, materials=replace(house.materials, texture=texture))


def _relative(path: str, root: Path) -> str:
    """A texture's path as it is kept: datasets may move."""
    return str(Path(path).relative_to(root)) if path and Path(path).is_relative_to(root) else path


def _absolute(path: str, root: Path) -> str:
    return str(root / path) if path else ""


def _model_path(models: Path, key: str) -> Path:
    return models / f"{hashlib.sha256(key.encode()).hexdigest()}.npz"


def _write(path: Path, arrays: Arrays, notes: Notes) -> None:
    """Writes to a file beside the target and then renames it, so that no reader ever meets half an entry."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            members: Mapping[str, Any] = {**arrays, NOTES: np.frombuffer(json.dumps(notes).encode(), np.uint8)}
            np.savez(file, **members)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _read(path: Path) -> tuple[Arrays, Notes]:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as members:
        arrays = {name: members[name] for name in members.files}
    return arrays, json.loads(arrays.pop(NOTES).tobytes())
