"""Size-bounded file reading and atomic file writing."""

import codecs
import io
import itertools
import json
import os
import re
import shutil
import stat
import sys
import tempfile
import time
import uuid
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np

from home_mjx.errors import ConfigError, DatasetError, HomeMjxError, MissingFileError

Row = TypeVar("Row")

# Python's strings, in any version of it, see `read_code`: four kinds of quotes, in which a backslash escapes.
_STRING = "|".join(
    (
        r'"""[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*"""',
        r"'''[^'\\]*(?:(?:\\.|'(?!''))[^'\\]*)*'''",
        r'"[^"\\\n]*(?:\\.[^"\\\n]*)*"',
        r"'[^'\\\n]*(?:\\.[^'\\\n]*)*'",
    )
)
_COMMENT = re.compile(rf"({_STRING})|^[ \t]*(?:#[^\n]*)?\n|[ \t]*#[^\n]*", re.MULTILINE | re.DOTALL)
_DOCSTRING = re.compile(
    rf'((?:\A|:\n)[ \t]*)[rR]?"""[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*"""(?=\n|\Z)|{_STRING}', re.DOTALL
)

_swept: set[Path] = set()  # folders that this process has swept

# The largest SUNCG file has a few MB and 130,000 lines; anything larger is a mistake or an attack.
MAX_BYTES = 1 << 25
MAX_LINES = 1 << 20
MAX_LINE_BYTES = 1 << 20  # [bytes], maximum length of a JSON line; a task has about 1,500
MAX_UNPACKED_BYTES = 1 << 32  # [bytes], maximum size of the unpacked arrays of one file
MAX_PATH_LENGTH = 1000  # maximum length of a path in a message [characters]
NUM_HEAD_BYTES = 4096  # number of bytes that tell what a file is
ZIP_MAGIC = b"PK"
FILE_KINDS = (  # first bytes, at the start or after a length of four bytes, and what the file is
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"ftyp", "a film (MP4)"),
    (b"RIFF", "sound (WAV)"),
    (b"\x1f\x8b", "compressed by gzip; unpack it first"),
    (b"\x93NUMPY", "one NumPy array (.npy)"),
    (b"\x80", "a Python pickle, which is never loaded"),
    (b"\x89HDF", "an HDF5 file"),
    (b"%PDF", "a PDF document"),
)
TEMPORARY_SUFFIX = ".tmp"  # suffix of incomplete files; their names begin with a dot
TEMPORARY_PATTERN = f".{'[0-9a-f]' * 32}{TEMPORARY_SUFFIX}"  # pattern of the temporary names of `write_atomically`
MIN_LEFTOVER_SECONDS = 3600.0  # [s], minimum age of a leftover file; no write takes that long


def read_code(path: Path) -> str:
    """Return a Python file for digests: without comments and blank lines, and with empty docstrings.

    Regular expressions find them, not `ast` or `tokenize`: those differ between versions of Python, and take longer.
    A docstring is a text in triple double quotes on lines of its own, at the start or after a colon. Code must be valid
    in Python 3.11, where f-strings do not contain their own quotes.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is unreadable, too large or not UTF-8.
    """
    code = _COMMENT.sub(lambda found: found[1] or "", read_text(path).replace("\r\n", "\n"))
    return _DOCSTRING.sub(lambda found: found[0] if found[1] is None else f'{found[1]}""', code)


def read_text(path: Path, hint: str | None = None, max_bytes: int | None = None) -> str:
    """Return the text of a UTF-8 file, without its byte order mark.

    Args:
        path: The file.
        hint: Remedy if the file is missing, for the message.
        max_bytes: Maximum accepted size [bytes]; `MAX_BYTES` by default.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is unreadable, too large, not UTF-8, or has more than `MAX_LINES` lines.
    """
    text = _decode(read_bytes(path, hint, max_bytes), path)
    if text.count("\n") > MAX_LINES:
        message = f"file has {text.count(chr(10))} lines, at most {MAX_LINES} are read"
        raise DatasetError(message, file=path, hint="Fetch or write it again.")
    return text


def read_json_lines(
    path: Path, content: str, parse: Callable[[Any], Row], max_bytes: int | None = None
) -> Iterator[Row]:
    """Yield `parse(value)` for the JSON value of each line of a file, which is read lazily.

    Nothing is opened, and no error raised, before the first row is requested.

    Args:
        path: The file.
        content: Name of the content of a line, for messages.
        parse: Converts the JSON value of a line to a row. Its `ValueError`, `TypeError`, `AttributeError`, and errors
            of look-up, arithmetic and recursion become `DatasetError`; others come through.
        max_bytes: Maximum accepted size of the file [bytes]; `MAX_BYTES` by default.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file cannot be read, or a line is blank, not JSON or rejected by `parse`; it names the line.
    """
    for number, line in enumerate(_lines(path, max_bytes), 1):
        try:
            yield parse(json.loads(line))
        except DatasetError as error:
            place = f"line {number}, {error.element}" if error.element else f"line {number}"
            raise type(error)(error.message, file=path, element=place, hint=error.hint) from None
        except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
            reason = f"`{error.args[0]}` is missing" if type(error) is KeyError else str(error)
            if not isinstance(error, ValueError | RecursionError) and not line.lstrip().startswith("{"):
                reason = f"expected a JSON object, got `{line.strip():.60}`"
            hint = "Each line must be one JSON object, as the package writes them."
            raise DatasetError(f"invalid {content}: {reason}", file=path, element=f"line {number}", hint=hint) from None


def _lines(path: Path, most: int | None) -> Iterator[str]:
    """Yield decoded lines with newline; errors as in `read_text`, also for lines above `MAX_LINE_BYTES`.

    `most`: maximum size of the file [bytes]; None: `MAX_BYTES`.
    """
    with _readable(path):
        _check(path, most or MAX_BYTES)
        with open_regular(path) as file:
            for number in itertools.count(1):
                line = file.readline(MAX_LINE_BYTES + 1)
                if not line:
                    return
                if len(line) > MAX_LINE_BYTES or number > MAX_LINES:
                    what = f"a line has at most {MAX_LINE_BYTES} bytes, and a file {MAX_LINES} lines"
                    raise DatasetError(what, file=path, element=f"line {number}", hint="Fetch or write it again.")
                yield _decode(line, path, number)


def write_json_lines(path: Path, rows: Iterable[Any], content: str) -> None:
    """Write JSON-serializable rows for `read_json_lines`, one per line; path and errors as in `write_durably`."""
    text = "".join(f"{json.dumps(row)}\n" for row in rows)
    with write_durably(path, content) as file:
        file.write(text.encode())


def read_bytes(path: Path, hint: str | None = None, max_bytes: int | None = None) -> bytes:
    """Return the bytes of a file, which need not be text; arguments and errors of reading or size as in `read_text`."""
    with _readable(path, hint):
        _check(path, max_bytes or MAX_BYTES)
        return path.read_bytes()


@contextmanager
def _readable(path: Path, hint: str | None = None) -> Iterator[None]:
    """Convert the block's `OSError` or `ValueError`: `MissingFileError` if the file is missing, else `DatasetError`.

    A `DatasetError` of the block is raised unchanged. `hint` is the remedy for a missing file only.
    """
    try:
        yield
    except DatasetError:  # from `_check`; a `DatasetError` is also a `ValueError`
        raise
    except FileNotFoundError:
        raise MissingFileError("file is missing", file=path, hint=hint or "Fetch or write it again.") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        reason = f"file cannot be read: {getattr(error, 'strerror', error)}"
        name = path if len(str(path)) < MAX_PATH_LENGTH else f"{str(path)[:MAX_PATH_LENGTH]}…"
        raise DatasetError(reason, file=name, hint="Check its name and who may read it.") from None


def read_arrays(path: Path, names: Sequence[str], content: str, hint: str) -> list[np.ndarray]:
    """Read arrays of an `.npz` file, in the order of `names`; pickled objects are rejected, so no code in it runs.

    Args:
        path: The file.
        names: Names of the arrays.
        content: Name of the file's content, for messages.
        hint: Remedy if the file is missing or is not such a file.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is broken, an array is missing, or the arrays exceed `MAX_UNPACKED_BYTES`.
    """
    try:
        with open_regular(path) as opened, np.load(opened, allow_pickle=False) as file:
            _check_unpacked(file.zip, names, path)
            return [_is_array(file[name], name) for name in names]
    except DatasetError:  # from `_check_unpacked`
        raise
    except FileNotFoundError:
        raise MissingFileError(f"there is no {content}", file=path, hint=hint) from None
    except KeyError as error:
        hint = f"It is of another kind or version. {hint}"
        raise DatasetError(f"file lacks {error.args[0]}", file=path, hint=hint) from None
    except Exception as error:  # a crafted file can make NumPy and zipfile raise nearly anything, including MemoryError
        kind = _describe_content(path)
        what = f": {error!s:.300}" if kind is None else f", but {kind}"
        raise DatasetError(f"file is not a valid {content}{what}", file=path, hint=hint) from None


def _describe_content(path: Path) -> str | None:
    """Return a file's kind in words, such as "a PNG picture" or "empty"; None if unreadable or a zip file (`.npz`)."""
    try:
        with open_regular(path) as file:
            head = file.read(NUM_HEAD_BYTES)
    except OSError:
        return None
    if head.startswith(ZIP_MAGIC):
        return None
    for magic, kind in FILE_KINDS:
        if head.startswith(magic) or head[4 : 4 + len(magic)] == magic:
            return kind
    return _describe_text(head) if head else "empty"


def _describe_text(head: bytes) -> str:
    """Return in words the kind, JSON, text or binary, of a file by its first bytes, which have no known signature."""
    try:
        text = codecs.getincrementaldecoder("utf-8")().decode(head).lstrip()
    except UnicodeDecodeError:
        return "binary data of an unknown kind"
    if any(ord(letter) < ord(" ") and not letter.isspace() for letter in text):
        return "binary data of an unknown kind"
    first = text.partition("\n")[0].strip()
    if first.startswith("{") and first.endswith("}"):
        return "JSON lines, such as the results of `play` or episodes"
    return "JSON text" if text.startswith(("{", "[")) else "text"


def _is_array(found: Any, name: str) -> np.ndarray:
    """Return `found` if it is a valid array, else raise `ValueError`; NumPy returns bytes for headerless members."""
    if not isinstance(found, np.ndarray):
        raise ValueError(f"`{name}` is not an array")
    if found.dtype.kind == "U":  # NumPy accepts any code points, on which Python later fails anywhere
        letters = np.frombuffer(found.tobytes(), np.dtype(np.uint32).newbyteorder(found.dtype.byteorder))
        if letters.max(initial=0) > sys.maxunicode:
            raise ValueError(f"`{name}` has invalid Unicode characters")
    return found


def open_regular(path: Path) -> io.BufferedReader:
    """Open a regular file for reading; never block on pipes.

    Raises:
        OSError: The path is not a regular file, or cannot be read.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return os.fdopen(handle, "rb")
    os.close(handle)
    raise OSError(f"{path} is not a regular file")


def _check_unpacked(archive: zipfile.ZipFile, names: Sequence[str], path: Path) -> None:
    """Raise `DatasetError` if the named arrays, of those that exist, unpack to more than `MAX_UNPACKED_BYTES` bytes."""
    sizes = {info.filename.removesuffix(".npy"): info.file_size for info in archive.infolist()}
    total = sum(sizes.get(name, 0) for name in names)
    if total > MAX_UNPACKED_BYTES:
        message = f"arrays have {total} bytes after unpacking, at most {MAX_UNPACKED_BYTES} are read"
        raise DatasetError(message, file=path, hint="Write it again, in several files.")


def is_file(path: Path) -> bool:
    """Return whether a regular file, or a link to one, exists; never raise, even for long or invalid names."""
    return os.path.isfile(path)


def is_folder(path: Path) -> bool:
    """Return whether a folder, or a link to one, exists; never raise, even for long or invalid names."""
    return os.path.isdir(path)


def _check(path: Path, most: int) -> None:
    """Raise `DatasetError` if the path is not a regular file, or one of more than `most` bytes; links are followed.

    Errors of `Path.stat` come through: `FileNotFoundError` if nothing is there, other `OSError`s, and `ValueError` for
    a null byte. `_readable` converts them.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):  # reading a pipe might block forever
        raise DatasetError("file cannot be read: it is not a regular file", file=path, hint="Fetch or write it again.")
    if status.st_size > most:
        message = f"file has {status.st_size} bytes, at most {most} are read"
        raise DatasetError(message, file=path, hint="Fetch or write it again.")


def _decode(data: bytes, path: Path, first: int = 1) -> str:
    """Decode UTF-8 without its byte order mark; `DatasetError` names the line, where `data` begins at line `first`."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        kind = next((kind for magic, kind in FILE_KINDS if first == 1 and data.startswith(magic)), None)
        if kind is not None:
            raise DatasetError(f"file is {kind}", file=path, hint="Give a text file in UTF-8.") from None
        line = data.count(b"\n", 0, error.start) + first
        raise DatasetError(
            f"byte {error.start} is not UTF-8", file=path, element=f"line {line}", hint="Save the file as UTF-8."
        ) from None


def resolve_below(root: Path, folder: Path, relative: str) -> Path | None:
    """Return the normalized path `relative` to `folder`; None if it leads out of `root`. No path needs to exist.

    Backslashes separate as well. Only the text is checked, so folders of a dataset may be symbolic links.

    Example:
        >>> resolve_below(Path("/data"), Path("/data/object/122"), "../../texture//wood_8.jpg").as_posix()
        '/data/texture/wood_8.jpg'
    """
    root, path = (Path(os.path.normpath(x)) for x in (root, folder / relative.replace("\\", "/")))
    return path if path.is_relative_to(root) and ".." not in path.parts[len(root.parts) :] else None


@contextmanager
def write_atomically(path: Path) -> Iterator[IO[bytes]]:
    """Write a file atomically: a temporary file replaces `path` when the block ends, so no reader sees a partial file.

    If the block raises, `path` is unchanged. Nothing is synced to disk: such files are checked on reading and can be
    regenerated. The folder is created if missing. The first write of a process to a folder removes leftovers, see
    `remove_leftovers`.

    Raises:
        OSError: The folder cannot be written to.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent not in _swept:
        _swept.add(path.parent)
        remove_leftovers(path.parent)
    beside = path.with_name(f".{uuid.uuid4().hex}{TEMPORARY_SUFFIX}")
    with _in_place(path, beside, beside.open("xb")) as file:  # not private, so that other users can read it
        yield file


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files of `write_atomically` that killed processes left in a folder more than an hour ago.

    The folder need not exist. Files that cannot be removed are ignored.
    """
    for path in folder.glob(TEMPORARY_PATTERN):
        with suppress(OSError):  # removed by another process, or owned by another user
            if time.time() - path.stat().st_mtime > MIN_LEFTOVER_SECONDS:
                path.unlink()


@contextmanager
def write_durably(path: Path, content: str, hint: str | None = None) -> Iterator[IO[bytes]]:
    """Write a file as `write_atomically` does and sync it to disk; the file has the permissions of any new one.

    A leftover temporary file of a killed process is overwritten by the next call.

    Args:
        path: The file, in an existing folder.
        content: Name of the content, for messages.
        hint: Remedy if it cannot be written.

    Raises:
        ConfigError: The file cannot be written, such as on a full disk; no partial file remains.
    """
    beside = path.with_name(f".{path.name}.new")
    with convert_write_errors(content, path, hint), _in_place(path, beside, beside.open("wb")) as file:
        yield file
        file.flush()
        os.fsync(file.fileno())
    _sync_folder(path.parent)


@contextmanager
def _in_place(path: Path, beside: Path, file: IO[bytes]) -> Iterator[IO[bytes]]:
    """Yield `file`, which is open at `beside`; move it to `path` when the block ends, delete it if the block raises."""
    try:
        with file:
            yield file
        beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise


def write_synced(path: Path, content: bytes, mode: str = "wb") -> None:
    """Write bytes to a file in an existing folder and sync them to disk; `mode` is `wb`, or `ab` to append.

    Use it for files that are renamed into place, or that grow line by line. A new name also needs a sync of its folder.

    Raises:
        OSError: The file cannot be written.
    """
    with path.open(mode) as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Sync the entries of a folder to disk; ignore systems that cannot."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def write_all_or_none(folder: Path, content: str) -> Iterator[Path]:
    """Yield a temporary folder whose files all move to `folder` when the block ends, or none if it raises.

    Files of the same names are replaced, others of `folder` are kept. `folder` is created if missing. If moving one
    file fails, those before it, in order of names, are already in `folder`.

    Args:
        folder: Destination.
        content: Name of the files, for messages.

    Raises:
        ConfigError: The files cannot be written.
    """
    with convert_write_errors(content, folder):
        folder.mkdir(parents=True, exist_ok=True)
        # Inside `folder`, since a move from another disk would copy files and could leave partial ones.
        beside = tempfile.TemporaryDirectory(dir=folder, prefix=".", suffix=TEMPORARY_SUFFIX)
    with beside:
        yield Path(beside.name)
        with convert_write_errors(content, folder):
            for file in sorted(Path(beside.name).iterdir()):
                file.replace(folder / file.name)


@contextmanager
def convert_write_errors(content: str, path: Path, hint: str | None = None) -> Iterator[None]:
    """Convert an `OSError` of the block to the `ConfigError` of `write_error`, except errors of this package."""
    try:
        yield
    except HomeMjxError:  # a `MissingFileError` is also an `OSError`
        raise
    except OSError as error:
        raise write_error(content, path, error, hint) from error


def as_path(path: object, content: str) -> Path:
    """Convert a user's file name, text or a path, to a `Path`; `content` is the name of the file's content.

    The file need not exist, and `~` is not expanded.

    Raises:
        ConfigError: `path` is neither.
    """
    if isinstance(path, str | os.PathLike):
        return Path(path)
    message = f"expected the path of a file of {content}, got {path!r:.60}"
    raise ConfigError(message, hint='Write its name, such as "runs/tasks.jsonl".')


def write_error(content: str, path: Path, error: OSError, hint: str | None = None) -> ConfigError:
    """Return, without raising it, the `ConfigError` for a failed write of `content` to `path`.

    Its reason is the system's text of `error`, else the message. `hint` is the remedy; None: free space or another
    folder.

    Example:
        >>> print(write_error("film", Path("out.mp4"), OSError(28, "No space left on device")))
        film cannot be written: No space left on device (in out.mp4). Free some space, or name another folder.
    """
    hint = hint or "Free some space, or name another folder."
    return ConfigError(f"{content} cannot be written: {error.strerror or error}", file=path, hint=hint)


def replace_folder(target: Path, files: Mapping[str, bytes]) -> None:
    """Replace a folder and all its old files: write and sync a new one beside it, then rename it into place.

    Between two renames the folder is absent for an instant.

    Args:
        target: The folder; created if missing.
        files: Contents by relative path; at least one.

    Raises:
        OSError: The folder cannot be written; an older folder is unchanged.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    fresh, old = (target.with_name(f".{target.name}.{uuid.uuid4().hex}") for _ in range(2))
    try:
        for name, content in files.items():
            (fresh / name).parent.mkdir(parents=True, exist_ok=True)
            write_synced(fresh / name, content)
        if target.exists():
            target.rename(old)
        fresh.rename(target)
        _sync_folder(target.parent)
    finally:
        if old.exists() and not target.exists():
            old.rename(target)
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)
