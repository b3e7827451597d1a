"""Locations in a dataset, and JSON values with their location, for error messages."""

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import read_text
from home_mjx.errors import DatasetError

MAX_COORDINATE = 1e6  # [m], maximum coordinate; larger ones are mistakes, and their products overflow float32
MAX_MESSAGE_LENGTH = 500  # maximum length of a message [characters]
MAX_JSON_BYTES = 1 << 24  # maximum file size; a value of two characters may take a hundred bytes of memory
MAX_ENTRIES = 100_000  # maximum length of a list
MAX_NAME_BYTES = 200  # [bytes], maximum length of a file name, with room for an extension
HOUSE_FIELDS = {"version", "id", "up", "front", "scaleToMeters", "levels", "bbox", "materials", "camera"}
LEVEL_FIELDS = {"id", "bbox", "nodes", "valid"}
_NODE = {"id", "type", "valid", "bbox", "transform", "materials", "materialIndices"}
NODE_FIELDS = {
    "object": _NODE | {"modelId", "state", "isMirrored"},
    "box": _NODE | {"dimensions", "isMirrored"},
    "room": _NODE | {"modelId", "nodeIndices", "roomTypes", "hideCeiling", "hideFloor", "hideWalls", "stats"},
    "ground": _NODE | {"modelId", "hideFloor"},
}
PRESERVED_FIELDS = {"camera", "stats"}  # known, but unused; preserved for writing


def printable(text: str) -> str:
    """Return `text`, cut to `MAX_MESSAGE_LENGTH` characters and `…`, with unprintable characters escaped."""
    text = text if len(text) <= MAX_MESSAGE_LENGTH else f"{text[:MAX_MESSAGE_LENGTH]}…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


@dataclass(frozen=True)
class Location:
    """Location in a dataset: a file, and a line or an element path in it.

    Example:
        >>> print(Location(Path("a.obj"), "line 7").error("expected 3 numbers, got `1 2`"))
        expected 3 numbers, got `1 2` (in a.obj, at line 7). Correct the line, or fetch or export the file again.
    """

    file: Path
    element: str = ""

    def error(self, message: str, hint: str | None = None, kind: type[DatasetError] = DatasetError) -> DatasetError:
        """Return an error of class `kind` at this location, not raised; the default hint suits any line or value."""
        return kind(
            printable(message),
            file=self.file,
            element=printable(self.element) or None,
            hint=printable(hint or self._remedy()),
        )

    def _remedy(self) -> str:
        """Return the default hint of an error."""
        return "Correct the line, or fetch or export the file again."


@dataclass(frozen=True)
class JsonValue(Location):
    """A JSON value with its location; absent and `null` are equivalent, as in the JavaScript that wrote SUNCG.

    Example:
        >>> node = JsonValue(Path("house.json"), "levels[0].nodes[2]", {"state": "open"})
        >>> print(node.member("state").error("expected an integer", "Remove it."))
        expected an integer (in house.json, at levels[0].nodes[2].state). Remove it.
    """

    data: Any = None
    has_key: bool = True  # True if the file has the key, even with `null`

    @property
    def has_value(self) -> bool:
        """True if the file has a value other than `null`."""
        return self.data is not None

    def member(self, key: str) -> "JsonValue":
        """Return the value of `key`, null if absent; raise `DatasetError` if this is not an object."""
        if not isinstance(self.data, dict):
            raise self._expected("an object")
        return JsonValue(
            self.file, f"{self.element}.{key}" if self.element else key, self.data.get(key), key in self.data
        )

    def entries(self) -> list["JsonValue"]:
        """Return the values of a list; raise `DatasetError` for other values, and beyond `MAX_ENTRIES`."""
        if not isinstance(self.data, list):
            raise self._expected("a list")
        if len(self.data) > MAX_ENTRIES:
            raise self.error(f"expected at most {MAX_ENTRIES} entries, got {len(self.data)}")
        return [JsonValue(self.file, f"{self.element}[{i}]", item) for i, item in enumerate(self.data)]

    def text(self) -> str:
        """Return a string.

        Raises:
            DatasetError: The value is no string, or has lone surrogates, which no path can have.
        """
        if not isinstance(self.data, str):
            raise self._expected("a string")
        if not self.data.isascii() and any("\ud800" <= c <= "\udfff" for c in self.data):
            raise self.error("text has lone surrogates, which are no characters")
        return self.data

    def name(self) -> str:
        """Return a string that is a plain file name of at most `MAX_NAME_BYTES`; raise `DatasetError` for other values.

        A plain name is not "", `.` or `..`, and has no slash, backslash or NUL.
        """
        text = self.text()
        if text in ("", ".", "..") or any(c in text for c in "/\\\0"):
            hint = "It must not be empty, contain `/` or lead out of its folder."
            raise self.error(f"`{text[:60]}` is not a plain name", hint)
        if len(text.encode("utf-8", "replace")) > MAX_NAME_BYTES:
            raise self.error(f"`{text[:60]}…` is too long for a name", f"Names have at most {MAX_NAME_BYTES} bytes.")
        return text

    def integer(self) -> int:
        """Return an integer, also from a float with an integral value; raise `DatasetError` for other values.

        Integers that a float cannot represent exactly are such values.
        """
        if isinstance(self.data, bool) or not isinstance(self.data, int | float) or self.data != self._floor():
            raise self._expected("an integer")
        return int(self.data)

    def number(self) -> float:
        """Return a finite number as a float; raise `DatasetError` for other values, booleans included."""
        if isinstance(self.data, bool) or not isinstance(self.data, int | float):
            raise self._expected("a number")
        if self._floor() is None:
            raise self._expected("a finite number")
        return float(self.data)

    def coordinate(self) -> float:
        """Return a number from -`MAX_COORDINATE` to `MAX_COORDINATE`; raise `DatasetError` for other values."""
        number = self.number()
        if abs(number) > MAX_COORDINATE:
            raise self.error(f"expected a number between -{MAX_COORDINATE:g} and {MAX_COORDINATE:g}, got {number:g}")
        return number

    def flag(self, default: bool = False) -> bool:
        """Return a flag written as 0, 1, "0", "1", true or false, else raise `DatasetError`; `default` if null."""
        if not self.has_value:
            return default
        if self.data in (0, "0"):
            return False
        if self.data in (1, "1"):
            return True
        raise self._expected("0 or 1")

    def vector(self, length: int) -> Float[np.ndarray, " n"]:
        """Return a list of `length` coordinates as an array; raise `DatasetError` for other values."""
        if isinstance(self.data, list) and len(self.data) != length:
            raise self.error(f"expected {length} numbers, got {len(self.data)}")
        return np.array([item.coordinate() for item in self.entries()])

    def color(self) -> tuple[float, float, float]:
        """Return a colour `#rrggbb` as sRGB in 0..1; raise `DatasetError` for other values."""
        if not re.fullmatch("#[0-9a-fA-F]{6}", self.text()):
            raise self._expected("a colour such as `#a3b0ff`")
        red, green, blue = bytes.fromhex(self.text()[1:])
        return red / 255, green / 255, blue / 255

    def _remedy(self) -> str:
        """Return the default hint of an error."""
        if ".nodes[" in self.element:
            return "Correct the value, or leave the node out by setting its `valid` to 0."
        return "Correct the value in the file."

    def _floor(self) -> int | None:
        """Return the number rounded down; None for NaN, infinities and integers that exceed floats."""
        try:
            return math.floor(float(self.data))
        except (ValueError, OverflowError):
            return None

    def _expected(self, what: str) -> DatasetError:
        """Return, without raising it, the error for a value of another kind."""
        return self.error(f"expected {what}, got `{self._shown()[:60]}`")

    def _shown(self) -> str:
        """Return the value as JSON for messages; "nothing" if the file does not have the key."""
        try:
            return json.dumps(self.data, default=str) if self.has_key else "nothing"
        except RecursionError:  # nesting close to the limit of the JSON reader
            return type(self.data).__name__


def read_json(path: Path) -> JsonValue:
    """Read the JSON document in a file; NaN and Infinity are accepted, as Python's reader does.

    Raises:
        DatasetError: The file is missing, larger than `MAX_JSON_BYTES`, not UTF-8, or not JSON (with line and column).
    """
    text = read_text(path, max_bytes=MAX_JSON_BYTES)
    place = Location(path)
    try:
        return JsonValue(path, "", json.loads(text))
    except json.JSONDecodeError as error:
        place = Location(path, f"line {error.lineno}, column {error.colno}")
        raise place.error(
            f"not valid JSON: {error.msg}", "The file may be truncated: fetch or write it again."
        ) from None
    except (ValueError, RecursionError) as error:
        raise place.error(f"not valid JSON: {error}", "Fetch or write the file again.") from None


def preserved_fields(value: JsonValue, known: set[str]) -> dict[str, Any]:
    """Return the unknown fields and `PRESERVED_FIELDS` of a JSON object, unchanged, for writing; {} otherwise."""
    return unknown_fields(value, known - PRESERVED_FIELDS)


def unknown_fields(value: JsonValue, known: set[str]) -> dict[str, Any]:
    """Return the fields of a JSON object that are not in `known`, unchanged; {} for other values."""
    return {key: data for key, data in value.data.items() if key not in known} if isinstance(value.data, dict) else {}
