"""Output folder of a subcommand, checked before the work starts."""

import tempfile
from contextlib import suppress
from pathlib import Path

from home_mjx.errors import ConfigError

_created: list[Path] = []  # folders created by this process, innermost first


def make_folder(path: Path) -> Path:
    """Create a folder and its parents if missing, check that files can be written there, and return `path`.

    Raises:
        ConfigError: The folder cannot be created or written.
    """
    new = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        _created[:0] = new
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        message = f"cannot write to this folder: {error.strerror}"
        raise ConfigError(message, file=path, hint="Choose another with --out.") from None


def drop_empty_folders() -> None:
    """Remove folders that `make_folder` created (not those it found) if they are still empty, after an error."""
    for folder in _created:
        with suppress(OSError):  # the folder is not empty
            folder.rmdir()
    _created.clear()
