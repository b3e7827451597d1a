"""The folder that a subcommand writes to, tried before the work begins."""

import tempfile
from pathlib import Path

from home_mjx.errors import ConfigError


def make_folder(path: Path) -> Path:
    """Makes a folder if it is missing, and sees that files can be written there.

    Raises:
        ConfigError: They cannot.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        message = f"cannot write to this folder: {error.strerror}"
        raise ConfigError(message, file=path, hint="Choose another by --out.") from None
