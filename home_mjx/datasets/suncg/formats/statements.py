"""Statements of OBJ and MTL files: lines of any ending, continued lines, comments, names."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from home_mjx.core.files import MAX_LINES, read_bytes, read_text
from home_mjx.errors import DatasetError, MissingFileError

OBJ_GEOMETRY = {  # statements whose surface would be missing, with what they are
    "surf": "a free-form surface",
    "bsp": "a B-spline patch",
    "bzp": "a Bezier patch",
    "cdp": "a Cardinal patch",
    "call": "the content of another file",
    "csh": "the output of a program",
}
OBJ_READ = {"v", "vt", "vn", "f", "fo", "o", "g", "usemtl", "mtllib"}
OBJ_IGNORED = {  # they change no triangle, and no colour of one
    *("p", "l", "s", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "ctech", "stech"),
    *("vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "parm", "trim", "hole", "scrv", "sp", "end", "con"),
    *("cdc", "res"),
}
NAMED = {"usemtl", "newmtl", "g", "o"}  # statements with a name, which may be a path of Windows
MTL_READ = {"newmtl", "kd", "d", "tr", "ks", "ns", "map_kd"}
MTL_IGNORED = {  # what the simulator's materials do not have: other lobes, emission, bumps, reflections
    *("ka", "ke", "tf", "ni", "illum", "sharpness", "pr", "pm", "ps", "pc", "pcr", "aniso", "anisor"),
    *("map_ka", "map_ks", "map_ns", "map_ke", "map_pr", "map_pm", "map_ps", "map_aat", "map_tr", "map_refl"),
    *("bump", "map_bump", "disp", "map_disp", "norm", "map_norm", "decal", "refl", "km", "map_ni", "map_ao"),
}


def read_statement_lines(path: Path, hint: str | None = None, tolerant: bool = False) -> str:
    """Read the text of an OBJ or MTL; `hint` is the remedy if it is missing.

    If `tolerant`, a file that is not UTF-8 is read as Latin-1, which older exporters write on Windows.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is unreadable, too large or, unless tolerant, not UTF-8.
    """
    try:
        return read_text(path, hint)
    except MissingFileError:
        raise
    except DatasetError:
        if not tolerant:
            raise
        text = read_bytes(path, hint).decode("latin-1")
        if text.count("\n") > MAX_LINES:
            raise
        return text


def split_statements(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield line number, keyword in lower case and arguments of every statement; blank and comment lines are left out.

    A backslash at the end of a line continues it on the next one; the number is that of the first. Comments, and names
    of materials and groups, are not continued by a backslash at their end: paths of Windows may have one there. A
    comment behind a statement remains in its arguments.

    Example:
        >>> next(split_statements("Kd 1 0 0"))
        (1, 'kd', '1 0 0')
    """
    for number, line in _logical_lines(text):
        words = line.split(None, 1)
        if len(words) == 2 and words[0][0] != "#":
            yield number, words[0].lower(), words[1]
        elif words and words[0][0] != "#":
            yield number, words[0].lower(), ""


def _logical_lines(text: str) -> Iterable[tuple[int, str]]:
    """Return (line number, text) of all lines, blank ones and comments too; lines end with LF, CR or both.

    A line continued by a backslash, see `_is_continued`, is joined to the next ones by spaces. Its number, from 1, is
    that of its first line, so numbers may have gaps.
    """
    lines = (text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text).split("\n")
    return _join_continued(lines) if "\\" in text else enumerate(lines, 1)


def _join_continued(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield each line, joined by spaces with those that continue it, without the backslashes, and its line number."""
    parts: list[str] = []
    for number, line in enumerate(lines, 1):
        is_continued = _is_continued(line)
        parts.append(line.rstrip()[:-1] if is_continued else line)
        if not is_continued or number == len(lines):
            yield number - len(parts) + 1, " ".join(parts)
            parts = []


def _is_continued(line: str) -> bool:
    """Return whether a line ends with a backslash that is neither in a comment nor the last character of a name."""
    text = line.rstrip()
    if not text.endswith("\\") or re.search(r"(^|\s)#", text):
        return False
    return text.split(None, 1)[0].lower() not in NAMED or len(text.split()[-1]) == 1


def bare_name(text: str) -> str:
    """Return a name without a comment behind it and without quotes around it.

    Example:
        >>> bare_name('"my wood.mtl" # oak')
        'my wood.mtl'
    """
    name = re.split(r"\s#", f" {text}", maxsplit=1)[0].strip()
    return name[1:-1] if len(name) > 2 and name[0] == name[-1] == '"' else name


def library_names(text: str) -> list[str]:
    """Return all file names that the arguments of a `mtllib` may mean, the likely ones first.

    Example:
        >>> library_names("my wood.mtl oak.mtl")
        ['my wood.mtl oak.mtl', 'my wood.mtl', 'oak.mtl', 'my', 'wood.mtl']
    """
    return list(dict.fromkeys([text, *split_library_names(text), *map(bare_name, text.split())]))


def split_library_names(text: str) -> list[str]:
    """Split the arguments of a `mtllib` behind each `.mtl`, so that names may contain spaces; one name without any."""
    parts = re.split(r"(?<=\.mtl)[\"\s]+", bare_name(text), flags=re.IGNORECASE)
    return [bare_name(part.strip('"')) for part in parts if part] or [text]
