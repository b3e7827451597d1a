"""What became of the houses of a job: one JSON object a line; a kill cuts at most the last."""

import hashlib
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

from home_mjx.core.files import unwritable
from home_mjx.core.paths import cache_folder
from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.houses.version import version_folder
from home_mjx.scene_compile.pipeline.compile import CompileOptions

FREE = "Free some space and start it again with --resume: what is done stays."
COMPILED, CACHED, FAILED = "compiled", "cached", "failed"
BEGINNING = b'{"id": "'  # of every line
KINDS = {"id": str, "status": str, "entry": str | None}  # of what is read in a line


@dataclass(frozen=True)
class CompileOutcome:
    """What became of one house; a line of the report.

    Attributes:
        id: The house.
        status: `compiled`, `cached` (it was there already) or `failed`.
        seconds: How long it took.
        error: Of a failed house: kind, message, file, element and hint.
        entry: Where it is, below the cache folder; None if it failed.
        stand_ins: What was taken in place of what the dataset lacks, a line each.
        fixed: How many objects could move and do not, being more than `MovableOptions.max_bodies`.
    """

    id: str
    status: str
    seconds: float
    error: dict[str, str | None] | None = None
    entry: str | None = None
    stand_ins: list[str] = field(default_factory=list)
    fixed: int = 0


@dataclass(frozen=True)
class CompileSummary:
    """What became of a dataset: counts of houses, and where the report is."""

    compiled: int
    cached: int
    failed: int
    skipped: int  # done in an earlier run
    seconds: float
    report: Path
    incomplete: int = 0  # compiled or cached, with stand-ins for what the dataset lacks
    fixed: int = 0  # objects of all houses that could move and do not, being more than `MovableOptions.max_bodies`


def report_path(root: Path, options: CompileOptions) -> Path:
    """Where it is noted what became of each house of a dataset."""
    name = hashlib.sha256(repr((str(root), options)).encode()).hexdigest()[:16]
    return version_folder() / "reports" / f"{name}.jsonl"


def described(problem: Exception) -> dict[str, str | None]:
    """An error as a line of the report has it: type, message, file, element and hint."""
    if isinstance(problem, HomeMjxError):
        where = {"file": problem.file, "element": problem.element, "hint": problem.hint}
        return {"type": type(problem).__name__, "message": problem.message, **where}
    return {"type": type(problem).__name__, "message": str(problem), "file": None, "element": None, "hint": None}


def done_houses(lines: list[dict[str, Any]]) -> set[str]:
    """Houses that the lines of a report say are in the cache, and that are."""
    entries = {line["id"]: line.get("entry") for line in lines if line["status"] != FAILED}
    return {house_id for house_id, entry in entries.items() if entry and _is_there(entry)}


def _is_there(entry: str) -> bool:
    """The end of an entry's archive is looked at: one that was cut off has lost it."""
    try:
        return is_zipfile(cache_folder() / entry)
    except ValueError:  # no name of a file
        return False


def earlier_lines(path: Path) -> list[dict[str, Any]]:
    """What an earlier run has noted; a file that is no report is refused, so that it is not written over."""
    try:
        lines = read_report(path)
        is_other = not lines and path.is_file() and not all(map(_may_be_cut, path.read_bytes().splitlines()))
    except OSError as error:
        raise ConfigError(f"report cannot be read: {error.strerror}", file=path, hint="Name a new file.") from None
    if is_other:
        raise ConfigError("there is a file that is no report", file=path, hint="Name a new file.")
    return lines


def _may_be_cut(line: bytes) -> bool:
    """Whether a line can be what is left of one that a killed run was writing."""
    return line.startswith(BEGINNING) or BEGINNING.startswith(line)


def read_report(path: Path) -> list[dict[str, Any]]:
    """The lines of a report; what else is there, such as a line that a killed run left half written, is passed over."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.is_file() else []
    found = []
    for line in lines:
        try:
            entry = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if isinstance(entry, dict) and all(isinstance(entry.get(name, ""), kind) for name, kind in KINDS.items()):
            found += [entry] if {"id", "status"} <= entry.keys() else []
    return found


@contextmanager
def journal(path: Path, append: bool) -> Iterator[Callable[[CompileOutcome], None]]:
    """Notes outcomes in a report; each is one write, so that a kill cuts at most the last line."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if not append:
            path.write_bytes(b"")
        report = path.open("ab", buffering=0)  # two runs into one report do not write over each other's lines
    except OSError as error:
        raise ConfigError(f"report cannot be written: {error.strerror}", file=path, hint="Name a new file.") from None
    with report as file:
        if append and path.stat().st_size:
            file.write(b"\n")  # the last line may be cut

        def note(outcome: CompileOutcome) -> None:
            try:
                file.write((json.dumps(asdict(outcome)) + "\n").encode())
            except OSError as error:
                raise unwritable("report", path, error, FREE) from None

        yield note
