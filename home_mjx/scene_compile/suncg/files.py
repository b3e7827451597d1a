"""Bounded reading of files below a dataset root."""

import os
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
        size = path.stat().st_size
        data = path.read_bytes() if size <= MAX_BYTES else b""
    except FileNotFoundError:
        raise DatasetError("file is missing", file=path, hint=hint) from None
    except OSError as error:
        raise DatasetError(f"file cannot be read: {error.strerror}", file=path, hint=hint) from None
    if size > MAX_BYTES:
        raise DatasetError(f"file has {size} bytes, at most {MAX_BYTES} are read", file=path)
    return _decode(data, path)


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
