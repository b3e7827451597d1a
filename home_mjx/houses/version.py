"""Version folders of the cache, one per version of the format and the compiler; unused ones are removed."""

import contextlib
import functools
import hashlib
import logging
import os
import re
import shutil
import time
from pathlib import Path

from home_mjx.core.files import read_code, remove_leftovers
from home_mjx.core.paths import cache_folder

FORMAT = 8
PACKAGE_ROOT = Path(__file__).parents[1]
# Code that determines an entry; changing any of it, except comments and docstrings, recompiles all houses.
# A test compares this list with the imports.
COMPILER_PATHS = (
    "core/array_store.py",
    "core/color.py",
    "core/files.py",
    "core/images.py",
    "core/named_enum.py",
    "core/native/numba_cache.py",
    "datasets/base.py",
    "datasets/kept_results.py",
    "datasets/seeds.py",
    "datasets/splits.py",
    "datasets/suncg/dataset.py",
    "datasets/suncg/digests.py",
    "datasets/suncg/digest_index.py",
    "datasets/suncg/formats",
    "datasets/suncg/fallbacks",
    "datasets/suncg/read",
    "geometry",
    "schema",
    *(
        f"scene_compile/{stage}"
        for stage in (
            "architecture",
            "collision",
            "lighting",
            "materials",
            "navigation",
            "objects",
            "pipeline",
            "semantics",
        )
    ),
)
VERSION_FOLDER = re.compile(r"v\d+-[0-9a-f]{12}")
DISCARDED_PREFIX = ".discarded-"
MAX_UNUSED_SECONDS = 30 * 24 * 3600.0  # time until an unused version folder is removed

log = logging.getLogger(__name__)


def version_folder() -> Path:
    """Return the folder, in the cache folder, of the installed compiler's entries, whether or not it exists."""
    return cache_folder() / version()


@functools.cache
def version() -> str:
    """Return the version of the installed compiler, as `version_of`; also the name of its cache folder."""
    return version_of(PACKAGE_ROOT)


def version_of(package: Path) -> str:
    """Return a format number and a hash of the compiler's code in `package`, the folder of `home_mjx`.

    It names the cache's version folder, so that a changed compiler never reads old entries. Comments and docstrings do
    not count, see `read_code`.
    """
    code = hashlib.sha256()
    for path in compiler_files(package):
        code.update(read_code(path).encode() if path.suffix == ".py" else path.read_bytes())
    return f"v{FORMAT}-{code.hexdigest()[:12]}"


def compiler_files(root: Path = PACKAGE_ROOT) -> list[Path]:
    """Return the paths of all code and tables (.py, .csv, .json, .npz) in `COMPILER_PATHS` below `root`, sorted."""
    named = [root / name for name in COMPILER_PATHS]
    found = [path for place in named for path in (place.rglob("*") if place.is_dir() else (place,))]
    files = (path for path in found if path.suffix in (".py", ".csv", ".json", ".npz"))
    return sorted(path for path in files if path.parent.name != "__pycache__")  # Numba writes there


def mark_used(folder: Path) -> None:
    """Update the modification time of a version folder, if it exists, to mark it as used."""
    with contextlib.suppress(OSError):  # the folder does not exist yet, or belongs to another user
        os.utime(folder)


def create_version_folder(folder: Path) -> None:
    """Create a version folder; if it is new, remove discarded folders and versions that were not used for a month.

    A version is used when `mark_used` updates its modification time.
    """
    if folder.is_dir():
        return
    folder.mkdir(parents=True, exist_ok=True)
    for other in folder.parent.iterdir():
        old = VERSION_FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > MAX_UNUSED_SECONDS
        if other.name.startswith(DISCARDED_PREFIX) or old:
            remove_folder(other)


def remove_folder(folder: Path) -> None:
    """Remove a folder of the cache; it is renamed first, so no process sees it half removed. Failures are logged."""
    hidden = folder.with_name(DISCARDED_PREFIX + folder.name.removeprefix(DISCARDED_PREFIX))
    try:
        folder.replace(hidden)
        shutil.rmtree(hidden)
    except OSError as error:  # another process may be removing it
        log.warning("old cache folder %s was not removed: %s", folder, error)


def prepare_folder() -> None:
    """Create the version folder of this compiler, and remove old temporary files of killed writers from it.

    If it is new, other versions' folders that were unused for a month are removed too, see `create_version_folder`.

    Raises:
        OSError: The folder cannot be created or listed. An existing read-only folder raises nothing.
    """
    folder = version_folder()
    create_version_folder(folder)
    for entries in (*folder.iterdir(), *folder.glob("results/*")):
        remove_leftovers(entries)
