"""Bounded reading of files below a dataset root."""

import os
import stat
from pathlib import Path

from home_mjx.errors import DatasetError

MAX_BYTES = 1 << 28  # the largest SUNCG file is a few MB; refuse what can only be a mistake


def read_text(path: Path, hint: str | None = None) -> str:
    """The text of a UTF-8 file.

    Args:
        path: The file.
        hint: What to do if it is missing.

    Raises:
        DatasetError: The file is missing, unreadable, too large or not UTF-8.
    """
    try:
        _check(path)
        return _decode(path.read_bytes(), path)
    except FileNotFoundError:
        raise DatasetError("file is missing", file=path, hint=hint or "Fetch or write it again.") from None
    except OSError as error:
        reason = f"file cannot be read: {error.strerror}"
        raise DatasetError(reason, file=path, hint="Check who may read it.") from None


def _check(path: Path) -> None:
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):  # reading a pipe might never end
        raise DatasetError("file cannot be read: it is not a regular file", file=path, hint="Fetch or write it again.")
    if status.st_size > MAX_BYTES:
        message = f"file has {status.st_size} bytes, at most {MAX_BYTES} are read"
        raise DatasetError(message, file=path, hint="Fetch or write it again.")


def _decode(data: bytes, path: Path) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise DatasetError(
            f"byte {error.start} is not UTF-8", file=path, element=f"line {line}", hint="Save the file as UTF-8."
        ) from None


def below(root: Path, folder: Path, relative: str) -> Path | None:
    """`relative`, seen from `folder`, or None if it leads out of `root`.

    Only the text of the path counts, so that folders of a dataset may be symbolic links to another disk.

    Example:
        >>> below(Path("/data"), Path("/data/object/122"), "../../texture//wood_8.jpg").as_posix()
        '/data/texture/wood_8.jpg'
    """
    path = Path(os.path.normpath(folder / relative.replace("\\", "/")))
    return path if path.is_relative_to(root) else None
