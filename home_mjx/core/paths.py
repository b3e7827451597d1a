"""Folders, environment variables and entry points used by the whole package."""

import os
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

CACHE_VARIABLE = "HOME_MJX_CACHE"
ROOT_VARIABLE = "SUNCG_DATA_DIR"


def cache_folder() -> Path:
    """Return the folder of compiled houses, generated datasets and compiled programs, which need not exist.

    `$HOME_MJX_CACHE`, else `home_mjx` in the user's cache folder.
    """
    named = os.environ.get(CACHE_VARIABLE)
    if named:
        return Path(named).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "home_mjx"


def dataset_root() -> Path | None:
    """Return the dataset folder named by `$SUNCG_DATA_DIR`, which need not exist; None if it is not set or empty."""
    named = os.environ.get(ROOT_VARIABLE)
    return Path(named) if named else None


@cache
def installed(group: str) -> dict[str, Any]:
    """Return the installed entry points of a group by name, in the type of the importlib that finds them; cached."""
    return {point.name: point for point in entry_points(group=group)}
