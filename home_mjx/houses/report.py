"""Report of a compile job: one JSON object per line and house; a kill truncates at most the last line."""

import hashlib
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

from home_mjx.core.files import write_error
from home_mjx.core.paths import cache_folder
from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.houses.version import version_folder
from home_mjx.scene_compile.pipeline.compile import CompileOptions

DISK_FULL_HINT = "Free some space and start it again with --resume: finished houses are kept."
COMPILED, CACHED, FAILED = "compiled", "cached", "failed"
LINE_PREFIX = b'{"id": "'  # first bytes of every line
FIELD_TYPES = {"id": str, "status": str, "entry": str | None}  # types of the fields that are read


@dataclass(frozen=True)
class CompileOutcome:
    """Outcome of compiling one house; a line of the report.

    Attributes:
        id: The house.
        status: `compiled`, `cached` (it was in the cache already) or `failed`.
        seconds: Wall-clock time [s].
        error: Type, message, file, element and hint of the error; None unless it failed.
        entry: Path relative to the cache folder; None if it failed.
        fallbacks: Descriptions of the fallbacks for missing parts of the dataset.
        fixed: Number of movable objects that stay fixed because they exceed `MovableOptions.max_bodies`.
    """

    id: str
    status: str
    seconds: float
    error: dict[str, str | None] | None = None
    entry: str | None = None
    fallbacks: list[str] = field(default_factory=list)
    fixed: int = 0


@dataclass(frozen=True)
class CompileSummary:
    """Result of a compile job: counts of houses, and the path of the report."""

    compiled: int
    cached: int
    failed: int
    skipped: int  # done in an earlier run
    seconds: float
    report: Path
    incomplete: int = 0  # houses with fallbacks for missing parts of the dataset
    fixed: int = 0  # movable objects of all houses that exceed `MovableOptions.max_bodies` and stay fixed


def report_path(root: Path, options: CompileOptions) -> Path:
    """Return the default path of the report for a dataset's root and options; the file need not exist."""
    name = hashlib.sha256(repr((str(root), options)).encode()).hexdigest()[:16]
    return version_folder() / "reports" / f"{name}.jsonl"


def error_record(problem: Exception) -> dict[str, str | None]:
    """Convert an error to a dictionary of type, message, file, element and hint; the last three may be None."""
    if isinstance(problem, HomeMjxError):
        where = {"file": problem.file, "element": problem.element, "hint": problem.hint}
        return {"type": type(problem).__name__, "message": problem.message, **where}
    return {"type": type(problem).__name__, "message": str(problem), "file": None, "element": None, "hint": None}


def find_done_houses(lines: list[dict[str, Any]]) -> set[str]:
    """Return the ids whose last line that is not `failed` has an entry that exists and is not truncated.

    A later `failed` line of the same id changes nothing.
    """
    entries = {line["id"]: line.get("entry") for line in lines if line["status"] != FAILED}
    return {house_id for house_id, entry in entries.items() if entry and _is_there(entry)}


def _is_there(entry: str) -> bool:
    """Return whether `entry`, relative to the cache folder, is a zip archive with an intact end (not truncated)."""
    try:
        return is_zipfile(cache_folder() / entry)
    except ValueError:  # not a valid file name
        return False


def load_report(path: Path) -> list[dict[str, Any]]:
    """Return the valid lines of an earlier report; empty if there is no file, or only truncated or empty lines.

    Raises:
        ConfigError: The file cannot be read, or is not a report and must not be overwritten.
    """
    try:
        lines = read_report(path)
        is_other = not lines and path.is_file() and not all(map(_may_be_cut, path.read_bytes().splitlines()))
    except OSError as error:
        raise ConfigError(f"report cannot be read: {error.strerror}", file=path, hint="Name a new file.") from None
    if is_other:
        raise ConfigError("file exists and is not a report", file=path, hint="Name a new file.")
    return lines


def _may_be_cut(line: bytes) -> bool:
    """Return whether a line begins as one of a report, complete or truncated; True for an empty line."""
    return line.startswith(LINE_PREFIX) or LINE_PREFIX.startswith(line)


def read_report(path: Path) -> list[dict[str, Any]]:
    """Return the valid lines of a report, in order, empty if there is no file; skip others, such as truncated ones.

    A valid line is a JSON object with the texts `id` and `status`; its `entry`, if any, is a text or null.
    """
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.is_file() else []
    found = []
    for line in lines:
        try:
            entry = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if isinstance(entry, dict) and all(isinstance(entry.get(name, ""), kind) for name, kind in FIELD_TYPES.items()):
            found += [entry] if {"id", "status"} <= entry.keys() else []
    return found


@contextmanager
def open_journal(path: Path, append: bool) -> Iterator[Callable[[CompileOutcome], None]]:
    """Open a report and yield a function that appends one outcome as a line of JSON.

    Each outcome is one write, so that a kill truncates at most the last line.

    Args:
        path: The report; its folder is created.
        append: Keep earlier lines; otherwise they are deleted.

    Raises:
        ConfigError: The report cannot be written; the yielded function raises it too.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if not append:
            path.write_bytes(b"")
        report = path.open("ab", buffering=0)  # two runs that share a report do not overwrite each other's lines
    except OSError as error:
        raise ConfigError(f"report cannot be written: {error.strerror}", file=path, hint="Name a new file.") from None
    with report as file:
        if append and path.stat().st_size:
            file.write(b"\n")  # the last line may be truncated

        def note(outcome: CompileOutcome) -> None:
            """Append one outcome; raise `ConfigError` if that fails."""
            try:
                file.write((json.dumps(asdict(outcome)) + "\n").encode())
            except OSError as error:
                raise write_error("report", path, error, DISK_FULL_HINT) from None

        yield note
