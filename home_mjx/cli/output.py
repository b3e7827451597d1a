"""The folder that a subcommand writes to, tried before the work begins."""

import tempfile
from contextlib import suppress
from pathlib import Path

from home_mjx.errors import ConfigError

_made: list[Path] = []  # by this process, the innermost first


def make_folder(path: Path) -> Path:
    """Makes a folder if it is missing, and sees that files can be written there.

    Raises:
        ConfigError: They cannot.
    """
    new = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        _made[:0] = new
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        message = f"cannot write to this folder: {error.strerror}"
        raise ConfigError(message, file=path, hint="Choose another by --out.") from None


def drop_empty_folders() -> None:
    """Removes what `make_folder` made and nobody wrote into: the command was refused after it."""
    for folder in _made:
        with suppress(OSError):  # something is in it
            folder.rmdir()
    _made.clear()
