"""Bounded reading of files below a dataset root, and writing of files whole or not at all."""

import io
import itertools
import json
import os
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

_swept: set[Path] = set()  # folders, by this process

# The largest SUNCG file is a few MB and has 130,000 lines; anything larger is a mistake or an attack.
MAX_BYTES = 1 << 25
MAX_LINES = 1 << 20
MAX_LINE = 1 << 20  # [bytes] of JSON lines; a task has some 1,500
MAX_UNPACKED = 1 << 32  # [bytes], of arrays of one file
MAX_NAME = 1000  # characters of a path that a message shows
TEMPORARY = ".tmp"  # how names of files end that are not yet whole; they begin with a dot
UNFINISHED = f".{'[0-9a-f]' * 32}{TEMPORARY}"  # pattern of the names that `write_whole` gives
LEFTOVER_SECONDS = 3600.0  # nothing takes so long to write


def read_text(path: Path, hint: str | None = None, most: int | None = None) -> str:
    """The text of a UTF-8 file.

    Args:
        path: The file.
        hint: What to do if it is missing.
        most: Largest accepted size [bytes]; `MAX_BYTES` by default.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is unreadable, too large or not UTF-8.
    """
    text = _decode(read_bytes(path, hint, most), path)
    if text.count("\n") > MAX_LINES:
        message = f"file has {text.count(chr(10))} lines, at most {MAX_LINES} are read"
        raise DatasetError(message, file=path, hint="Fetch or write it again.")
    return text


def read_json_lines(path: Path, what: str, parse: Callable[[Any], Row], most: int | None = None) -> Iterator[Row]:
    """What is made of each line of a file of JSON lines.

    Args:
        path: The file.
        what: What a line holds, for messages.
        parse: From a line's JSON to what is wanted.
        most: Largest accepted size [bytes]; `MAX_BYTES` by default.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: It cannot be read, or a line is broken; says which.
    """
    for number, line in enumerate(_lines(path, most), 1):
        try:
            yield parse(json.loads(line))
        except DatasetError as error:
            place = f"line {number}, {error.element}" if error.element else f"line {number}"
            raise type(error)(error.message, file=path, element=place, hint=error.hint) from None
        except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
            reason = f"`{error.args[0]}` is missing" if type(error) is KeyError else str(error)
            hint = "Each line must be one JSON object, as the package writes them."
            raise DatasetError(f"no {what}: {reason}", file=path, element=f"line {number}", hint=hint) from None


def _lines(path: Path, most: int | None) -> Iterator[str]:
    """Lines of a file one after the other, so that no more than one of them takes memory; errors as of `read_text`."""
    with _readable(path):
        _check(path, most or MAX_BYTES)
        with open_regular(path) as file:
            for number in itertools.count(1):
                line = file.readline(MAX_LINE + 1)
                if not line:
                    return
                if len(line) > MAX_LINE or number > MAX_LINES:
                    what = f"a line has at most {MAX_LINE} bytes, and a file {MAX_LINES} lines"
                    raise DatasetError(what, file=path, element=f"line {number}", hint="Fetch or write it again.")
                yield _decode(line, path, number)


def write_json_lines(path: Path, rows: Iterable[Any], what: str) -> None:
    """Writes a file that `read_json_lines` reads, one row a line.

    Args:
        path: The file.
        rows: What JSON can hold.
        what: What the rows are, for messages.

    Raises:
        ConfigError: It cannot be written.
    """
    text = "".join(f"{json.dumps(row)}\n" for row in rows)
    with write_durably(path, what) as file:
        file.write(text.encode())


def read_bytes(path: Path, hint: str | None = None, most: int | None = None) -> bytes:
    """The content of a file; arguments and errors as in `read_text`."""
    with _readable(path, hint):
        _check(path, most or MAX_BYTES)
        return path.read_bytes()


@contextmanager
def _readable(path: Path, hint: str | None = None) -> Iterator[None]:
    """What fails as the file is read is a typed error."""
    try:
        yield
    except DatasetError:  # from `_check`: it is a ValueError as well
        raise
    except FileNotFoundError:
        raise MissingFileError("file is missing", file=path, hint=hint or "Fetch or write it again.") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        reason = f"file cannot be read: {getattr(error, 'strerror', error)}"
        name = path if len(str(path)) < MAX_NAME else f"{str(path)[:MAX_NAME]}…"
        raise DatasetError(reason, file=name, hint="Check its name and who may read it.") from None


def read_arrays(path: Path, names: Sequence[str], what: str, hint: str) -> list[np.ndarray]:
    """Arrays of an `.npz` file by name; nothing in it is run.

    Args:
        path: The file.
        names: Of the arrays.
        what: What the file is, for messages.
        hint: What to do if it is none.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: It is broken, or lacks a name.
    """
    try:
        with open_regular(path) as opened, np.load(opened, allow_pickle=False) as file:
            _check_unpacked(file.zip, names, path)
            return [_is_array(file[name], name) for name in names]
    except DatasetError:  # of `_check_unpacked`
        raise
    except FileNotFoundError:
        raise MissingFileError(f"there is no {what}", file=path, hint=hint) from None
    except KeyError as error:
        raise DatasetError(f"file lacks {error.args[0]}", file=path, hint="Another version made it.") from None
    except Exception as error:  # a made-up file can make NumPy and zipfile raise nearly anything, MemoryError too
        raise DatasetError(f"file is no {what}: {error!s:.300}", file=path, hint=hint) from None


def _is_array(found: Any, name: str) -> np.ndarray:
    """What NumPy gives for a part of an archive: its bytes, where it has not the head of an array."""
    if not isinstance(found, np.ndarray):
        raise ValueError(f"`{name}` is no array")
    if found.dtype.kind == "U":  # NumPy makes strings of any numbers, with which Python then fails anywhere
        letters = np.frombuffer(found.tobytes(), np.dtype(np.uint32).newbyteorder(found.dtype.byteorder))
        if letters.max(initial=0) > sys.maxunicode:
            raise ValueError(f"`{name}` has characters that there are not")
    return found


def open_regular(path: Path) -> io.BufferedReader:
    """Opens a regular file for reading; never waits, as a pipe would have it.

    Raises:
        OSError: It is no regular file, or cannot be read.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return os.fdopen(handle, "rb")
    os.close(handle)
    raise OSError(f"{path} is not a regular file")


def _check_unpacked(archive: zipfile.ZipFile, names: Sequence[str], path: Path) -> None:
    """Refuses arrays that a small file would unpack to more than anyone writes."""
    sizes = {info.filename.removesuffix(".npy"): info.file_size for info in archive.infolist()}
    total = sum(sizes.get(name, 0) for name in names)
    if total > MAX_UNPACKED:
        message = f"arrays have {total} bytes when they are unpacked, at most {MAX_UNPACKED} are read"
        raise DatasetError(message, file=path, hint="Write it again, in several files.")


def is_file(path: Path) -> bool:
    """Whether the file exists; never fails, however long or odd the name is."""
    return os.path.isfile(path)


def is_folder(path: Path) -> bool:
    """Whether the folder exists; never fails either."""
    return os.path.isdir(path)


def _check(path: Path, most: int) -> None:
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):  # reading a pipe might never end
        raise DatasetError("file cannot be read: it is not a regular file", file=path, hint="Fetch or write it again.")
    if status.st_size > most:
        message = f"file has {status.st_size} bytes, at most {most} are read"
        raise DatasetError(message, file=path, hint="Fetch or write it again.")


def _decode(data: bytes, path: Path, first: int = 1) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + first
        raise DatasetError(
            f"byte {error.start} is not UTF-8", file=path, element=f"line {line}", hint="Save the file as UTF-8."
        ) from None


def below(root: Path, folder: Path, relative: str) -> Path | None:
    """The path `relative` to `folder`; None if it leads out of `root`.

    Only the text of the path counts, so that folders of a dataset may be symbolic links to another disk.

    Example:
        >>> below(Path("/data"), Path("/data/object/122"), "../../texture//wood_8.jpg").as_posix()
        '/data/texture/wood_8.jpg'
    """
    path = Path(os.path.normpath(folder / relative.replace("\\", "/")))
    return path if path.is_relative_to(root) else None


@contextmanager
def write_whole(path: Path) -> Iterator[IO[bytes]]:
    """A file beside `path` that takes its place when the block ends, so that no reader ever meets half a file.

    If the block raises, `path` stays as it was. Nothing is forced to the disk: what is written so is checked when it
    is read, and can be made again. Who first writes to a folder sweeps it, see `sweep`.

    Args:
        path: The file; its folder is made if need be.

    Raises:
        OSError: The folder cannot be written to.

    Example:
        >>> with write_whole(Path("notes.json")) as file:  # doctest: +SKIP
        ...     file.write(b"{}")
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent not in _swept:
        _swept.add(path.parent)
        sweep(path.parent)
    beside = path.with_name(f".{uuid.uuid4().hex}{TEMPORARY}")
    with _in_place(path, beside, beside.open("xb")) as file:  # not private, so that others can read it
        yield file


def sweep(folder: Path) -> None:
    """Removes what killed processes have left of `write_whole` in a folder, more than an hour ago.

    Args:
        folder: Where they wrote; need not exist.

    Example:
        >>> sweep(Path("kernels"))
    """
    for path in folder.glob(UNFINISHED):
        with suppress(OSError):  # another process was quicker, or it is someone else's
            if time.time() - path.stat().st_mtime > LEFTOVER_SECONDS:
                path.unlink()


@contextmanager
def write_durably(path: Path, what: str, hint: str | None = None) -> Iterator[IO[bytes]]:
    """As `write_whole`, and on the disk when the block ends; the file has the permissions of any new one.

    What a killed process leaves beside `path` is overwritten the next time.

    Args:
        path: The file; its folder exists.
        what: What is written, for messages.
        hint: What to do if it cannot be.

    Raises:
        ConfigError: It cannot be written, such as on a full disk; nothing of it is left.

    Example:
        >>> with write_durably(Path("notes.json"), "notes") as file:  # doctest: +SKIP
        ...     file.write(b"{}")
    """
    beside = path.with_name(f".{path.name}.new")
    with writing(what, path, hint), _in_place(path, beside, beside.open("wb")) as file:
        yield file
        file.flush()
        os.fsync(file.fileno())
    _sync_folder(path.parent)


@contextmanager
def _in_place(path: Path, beside: Path, file: IO[bytes]) -> Iterator[IO[bytes]]:
    """An open file that takes the place of another one when the block ends, and is gone if that raises."""
    try:
        with file:
            yield file
        beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise


def write_through(path: Path, content: bytes, mode: str = "wb") -> None:
    """Writes to a file, and returns when it is on the disk; a new name is, once its folder is forced there.

    For what takes its place by a rename, or is added to line by line.

    Args:
        path: The file; its folder exists.
        content: What is written.
        mode: `wb`, or `ab` to add.

    Raises:
        OSError: It cannot be written.

    Example:
        >>> write_through(Path("lines.jsonl"), b"{}", "ab")  # doctest: +SKIP
    """
    with path.open(mode) as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Forces a folder's list of names to the disk; some systems cannot."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def write_together(folder: Path, what: str) -> Iterator[Path]:
    """A folder to write files to; all of them take their places in another one when the block ends, or none does.

    Args:
        folder: Where they are to be; made if need be.
        what: What they are, for messages.

    Raises:
        ConfigError: They cannot be written there.

    Example:
        >>> with write_together(Path("play"), "film") as beside:  # doctest: +SKIP
        ...     (beside / "film.jsonl").write_text("{}")
    """
    with writing(what, folder):
        folder.mkdir(parents=True, exist_ok=True)
        # In it, not in the system's folder: from another disk, files would be copied, and could come half.
        beside = tempfile.TemporaryDirectory(dir=folder, prefix=".", suffix=TEMPORARY)
    with beside:
        yield Path(beside.name)
        with writing(what, folder):
            for file in sorted(Path(beside.name).iterdir()):
                file.replace(folder / file.name)


@contextmanager
def writing(what: str, path: Path, hint: str | None = None) -> Iterator[None]:
    """Where the system refuses to write, the block raises what `unwritable` gives."""
    try:
        yield
    except HomeMjxError:  # a missing file of a dataset is an `OSError` as well
        raise
    except OSError as error:
        raise unwritable(what, path, error, hint) from error


def as_path(path: object, what: str) -> Path:
    """The path of a file, as users give it.

    Args:
        path: Text or a path.
        what: What the file is, for messages.

    Raises:
        ConfigError: It is neither.

    Example:
        >>> as_path("runs/tasks.jsonl", "tasks").name
        'tasks.jsonl'
    """
    if isinstance(path, str | os.PathLike):
        return Path(path)
    message = f"expected the path of a file of {what}, got {path!r:.60}"
    raise ConfigError(message, hint='Write its name, such as "runs/tasks.jsonl".')


def unwritable(what: str, path: Path, error: OSError, hint: str | None = None) -> ConfigError:
    """What to raise where the system refuses to write.

    Example:
        >>> print(unwritable("film", Path("out.mp4"), OSError(28, "No space left on device")))
        film cannot be written: No space left on device (in out.mp4). Free some space, or name another folder.
    """
    hint = hint or "Free some space, or name another folder."
    return ConfigError(f"{what} cannot be written: {error.strerror or error}", file=path, hint=hint)


def replace_folder(target: Path, files: Mapping[str, bytes]) -> None:
    """Writes a folder beside its place and, once it is on the disk, moves it there; an older one goes.

    Args:
        target: The folder.
        files: Contents by path in it.

    Raises:
        OSError: It cannot be written; the older folder, if there is one, is still there.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    fresh, old = (target.with_name(f".{target.name}.{uuid.uuid4().hex}") for _ in range(2))
    try:
        for name, content in files.items():
            (fresh / name).parent.mkdir(parents=True, exist_ok=True)
            write_through(fresh / name, content)
        if target.exists():
            target.rename(old)
        fresh.rename(target)
        _sync_folder(target.parent)
    finally:
        if old.exists() and not target.exists():
            old.rename(target)
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)
