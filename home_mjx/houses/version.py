"""The cache's folders: one for each version of the format and of the compiler; old ones go."""

import contextlib
import functools
import hashlib
import logging
import os
import re
import shutil
import time
from pathlib import Path

from home_mjx.core.files import sweep
from home_mjx.core.paths import cache_folder

FORMAT = 8
PACKAGE = Path(__file__).parents[1]
# What makes an entry: a change of any of these makes all houses anew. A test holds it against the imports.
COMPILER = (
    "core/array_store/flatten.py",
    "core/color.py",
    "core/files.py",
    "core/images.py",
    "core/native/numba_cache.py",
    "datasets/base.py",
    "datasets/joints.py",
    "datasets/options.py",
    "datasets/seeds.py",
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
DISCARDED = ".discarded-"
KEEP_SECONDS = 30 * 24 * 3600.0  # that an unused version's folder is kept

log = logging.getLogger(__name__)


def version_folder() -> Path:
    """Where entries of this version lie."""
    return cache_folder() / version()


@functools.cache
def version() -> str:
    """Name of this version."""
    return version_of(PACKAGE)


def version_of(package: Path) -> str:
    """Name of the format and of the code that makes entries, so that a changed compiler never meets old ones.

    Args:
        package: Folder of `home_mjx`.
    """
    code = hashlib.sha256()
    for path in compiler_files(package):
        code.update(path.read_bytes())
    return f"v{FORMAT}-{code.hexdigest()[:12]}"


def compiler_files(root: Path = PACKAGE) -> list[Path]:
    """Code and tables of `COMPILER`, in order."""
    named = [root / name for name in COMPILER]
    found = [path for place in named for path in (place.rglob("*") if place.is_dir() else (place,))]
    return sorted(path for path in found if path.suffix in (".py", ".csv", ".json", ".npz"))


def mark_used(folder: Path) -> None:
    """Notes on a version's folder, if there is one, that it is in use."""
    with contextlib.suppress(OSError):  # not there yet, or someone else's
        os.utime(folder)


def claim(folder: Path) -> None:
    """Makes a version's folder; with a new version, those that were not used for a month go."""
    if folder.is_dir():
        return
    folder.mkdir(parents=True, exist_ok=True)
    for other in folder.parent.iterdir():
        old = VERSION_FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > KEEP_SECONDS
        if other.name.startswith(DISCARDED) or old:
            discard(other)


def discard(folder: Path) -> None:
    """Removes a folder of the cache; renamed first, so that nobody meets it half removed."""
    hidden = folder.with_name(DISCARDED + folder.name.removeprefix(DISCARDED))
    try:
        folder.replace(hidden)
        shutil.rmtree(hidden)
    except OSError as error:  # another process may be at it
        log.warning("old cache folder %s is not removed: %s", folder, error)


def prepare_folder() -> None:
    """Makes the folder of this version, and removes what killed writers have left in it.

    Raises:
        OSError: It cannot be written to.
    """
    folder = version_folder()
    claim(folder)
    for entries in folder.iterdir():
        sweep(entries)
