"""Files of ProcTHOR: names such as `train.jsonl.gz?first=0&count=100`, and the text of each house."""

import gzip
import hashlib
import json
import re
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from io import BufferedIOBase
from itertools import islice
from pathlib import Path
from urllib.parse import parse_qsl

from home_mjx.core.checks import check_known
from home_mjx.core.files import open_regular, read_bytes
from home_mjx.errors import ConfigError, DatasetError, MissingFileError

SUFFIXES = (".json", ".jsonl", ".jsonl.gz")
OPTIONS = ("first", "count", "split", "assets")
MAX_HOUSE_BYTES = 1 << 24  # [bytes], maximum length of the text of a house; those of ProcTHOR have 60 to 200 kB
MAX_UNPACKED_BYTES = 1 << 32  # [bytes], maximum length of the lines of a file; those of ProcTHOR-10k have 1 GB
MAX_HOUSES = 1 << 20  # maximum number of lines of a file
HEAD_BYTES = 1 << 16
GZIP_MAGIC = b"\x1f\x8b"
MARKS = (b'"proceduralParameters"', b'"floorPolygon"')  # one of them is in every house
NAME_HINT = "Write `procthor:PATH` or `procthor:PATH?first=0&count=100`; PATH is a .json, .jsonl or .jsonl.gz file."
FETCH_HINT = "Fetch or write the file again."


@dataclass(frozen=True)
class ProcthorName:
    """Parts of a name such as `procthor-10k?split=val&first=0&count=100`.

    Attributes:
        path: A file of houses, or a folder of such files.
        first: Number of the first house.
        count: Number of houses; None: all.
        split: Name of a file in the folder, without its suffix, such as `train`; None: all files.
        assets: AI2-THOR's `asset-database.json`, with the size of each model; None: it is looked for near the houses.
    """

    path: Path
    first: int = 0
    count: int | None = None
    split: str | None = None
    assets: Path | None = None

    @classmethod
    def parse(cls, text: str) -> "ProcthorName":
        """Parse the text after the scheme.

        Raises:
            ConfigError: The text is malformed, or an option is unknown.

        Example:
            >>> ProcthorName.parse("train.jsonl.gz?first=5").first
            5
        """
        path, _, options = text.partition("?")
        try:
            pairs = dict(parse_qsl(options, keep_blank_values=True, strict_parsing=bool(options)))
        except ValueError:
            raise ConfigError(f"`procthor:{text}` does not name houses", hint=NAME_HINT) from None
        check_known("option of ProcTHOR's houses", pairs, OPTIONS)
        if not path:
            raise ConfigError("name of ProcTHOR's houses has no path", hint=NAME_HINT)
        assets = Path(pairs["assets"]).expanduser().absolute() if "assets" in pairs else None
        count = _whole("count", pairs["count"], 1) if "count" in pairs else None
        place = Path(path).expanduser().absolute()
        return cls(place, _whole("first", pairs.get("first", "0"), 0), count, pairs.get("split"), assets)


def _whole(name: str, text: str, least: int) -> int:
    if not re.fullmatch(r"[0-9]{1,9}", text) or int(text) < least:
        raise ConfigError(f"`{name}` must be a whole number of at least {least}, got `{text:.40}`", hint=NAME_HINT)
    return int(text)


@dataclass(frozen=True)
class HouseText:
    """Text of one house: a file, or a line of one.

    Attributes:
        file: The file.
        line: Number of the line, from 1; 0: the whole file is the house.
        packed: The line, compressed; empty: the file is read when it is needed.
    """

    file: Path
    line: int = 0
    packed: bytes = b""

    @property
    def place(self) -> str:
        """Element path of the house in its file; "" for a whole file."""
        return f"line {self.line}" if self.line else ""

    def read(self) -> bytes:
        """Return the text.

        Raises:
            DatasetError: The file is missing, unreadable or too large.
        """
        return zlib.decompress(self.packed) if self.packed else read_bytes(self.file, max_bytes=MAX_HOUSE_BYTES)


class ProcthorSource:
    """Houses of the files that a name selects.

    Args:
        name: The name.

    Raises:
        MissingFileError: There is no such file, or no house in it.
        DatasetError: A file is not of ProcTHOR's, or broken.
    """

    def __init__(self, name: ProcthorName) -> None:
        self.name = name
        self.files = _select_files(name)

    @cached_property
    def houses(self) -> Mapping[str, HouseText]:
        """Texts by house id: the stem of a file, with the number of the line from 0 where there are lines."""
        last = None if self.name.count is None else self.name.first + self.name.count
        found = dict(islice(self._all(last), self.name.first, last))
        if not found:
            raise MissingFileError(f"no house has number {self.name.first} or more", file=self.name.path)
        return found

    def _all(self, last: int | None) -> Iterator[tuple[str, HouseText]]:
        total = 0
        for file in self.files:
            stem = house_stem(file)
            for house in _texts(file, self.name.first - total, None if last is None else last - total):
                yield (f"{stem}_{house.line - 1:05d}" if house.line else stem), house
                total += 1


def house_stem(file: Path) -> str:
    """Return the name of a file without its suffix, in letters that ids of houses may have.

    Example:
        >>> house_stem(Path("my houses/train.jsonl.gz"))
        'train'
    """
    return re.sub(r"[^A-Za-z0-9._-]", "_", re.sub(r"\.(json|jsonl|jsonl\.gz)$", "", file.name))[:100]


def _select_files(name: ProcthorName) -> list[Path]:
    """Return the files of a name, sorted."""
    path, split = name.path, name.split
    if not path.exists():
        raise MissingFileError("no file or folder of houses", file=path, hint=NAME_HINT)
    files = _folder_files(path) if path.is_dir() else [path]
    if split is not None:
        files = [file for file in files if house_stem(file) == split]
    if files:
        return files
    if split is not None:
        raise ConfigError(f"there is no file of the split `{split:.40}` in {path}", hint="Such as train.jsonl.gz.")
    raise MissingFileError("folder has no house of ProcTHOR", file=path, hint=NAME_HINT)


def _folder_files(folder: Path) -> list[Path]:
    files = sorted(file for file in folder.iterdir() if file.name.endswith(SUFFIXES) and file.is_file())
    return [file for file in files if recognizes_procthor(file)]


def recognizes_procthor(path: Path) -> bool:
    """Return whether a file holds houses of ProcTHOR, or a folder such files, by the content of their beginning."""
    if path.is_dir():
        with suppress(OSError):
            return any(map(recognizes_procthor, _candidates(path)))
        return False
    if not path.name.endswith(SUFFIXES):
        return False
    try:
        with _opened(path) as file:
            head = file.read(HEAD_BYTES)
            return any(mark in head or mark in file.read(MAX_HOUSE_BYTES) for mark in MARKS)
    except (OSError, EOFError, zlib.error):
        return False


def _candidates(folder: Path) -> list[Path]:
    """Return the first files of a folder that may hold houses; the first ten tell what is in it."""
    return sorted(file for file in folder.iterdir() if file.name.endswith(SUFFIXES) and file.is_file())[:10]


@contextmanager
def _opened(path: Path) -> Iterator[BufferedIOBase]:
    """Open a file for reading, unpacked if its first bytes are those of gzip."""
    with open_regular(path) as raw:
        if raw.peek(2)[:2] != GZIP_MAGIC:
            yield raw
            return
        with gzip.open(raw) as unpacked:
            yield unpacked


def _texts(file: Path, first: int, last: int | None) -> Iterator[HouseText]:
    """Generate the houses of a file up to the `last`th; those before number `first` without their text.

    Lines without text are no houses.

    Raises:
        DatasetError: The file is broken or, unpacked, too large.
    """
    if file.name.endswith(".json"):
        yield HouseText(file)
        return
    try:
        with _opened(file) as opened:
            full = ((number, line) for number, line in _lines(opened, file) if line.strip())
            for count, (number, line) in enumerate(islice(full, None if last is None else max(last, 0))):
                yield HouseText(file, number, zlib.compress(line, 1) if count >= first else b"")
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise DatasetError(f"file is not valid gzip: {error}", file=file, hint=FETCH_HINT) from None
    except OSError as error:
        raise DatasetError(f"file cannot be read: {error.strerror or error}", file=file, hint=FETCH_HINT) from None


def _lines(opened: BufferedIOBase, file: Path) -> Iterator[tuple[int, bytes]]:
    """Generate the lines of a file with their numbers from 1; raise `DatasetError` if they are too many or too long."""
    total = 0
    for number in range(1, MAX_HOUSES + 1):
        line = opened.readline(MAX_HOUSE_BYTES + 1)
        total += len(line)
        if not line:
            return
        if len(line) > MAX_HOUSE_BYTES or total > MAX_UNPACKED_BYTES:
            message = f"a line has more than {MAX_HOUSE_BYTES} bytes, or the file more than {MAX_UNPACKED_BYTES}"
            raise DatasetError(message, file=file, element=f"line {number}", hint=FETCH_HINT)
        yield number, line


def parse_text(house: HouseText) -> object:
    """Return the JSON value of a house.

    Raises:
        DatasetError: It is not JSON in UTF-8; the message has line and column.
    """
    data = house.read()
    try:
        return json.loads(data)
    except json.JSONDecodeError as error:
        line = house.line + error.lineno - 1 if house.line else error.lineno
        place = f"line {line}, column {error.colno}"
        raise DatasetError(f"not valid JSON: {error.msg}", file=house.file, element=place, hint=FETCH_HINT) from None
    except (ValueError, RecursionError) as error:
        element = house.place or None
        raise DatasetError(f"not valid JSON: {error}", file=house.file, element=element, hint=FETCH_HINT) from None


def text_digest(house: HouseText) -> bytes:
    """Return the SHA-256 digest of the text of a house."""
    return hashlib.sha256(house.read()).digest()
