"""STL files as triangles: text and binary."""

import re
import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.shapes import Triangles
from home_mjx.datasets.suncg.formats.json_value import Location

FETCH = "Fetch or export it again."
HEAD_BYTES, TRIANGLE_BYTES = 84, 50  # [bytes]
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VERTEX = re.compile(rb"\bvertex((?:\s+[^\s]{1,40}){3})", re.IGNORECASE)


def read_stl(path: Path, data: bytes) -> Triangles:
    """Return the triangles of an STL file; a file is binary if it has the size that its count says, or no `solid`.

    Args:
        path: The file, for messages.
        data: Its content.

    Raises:
        DatasetError: A binary file is shorter than its count says, or a text has other words than numbers.
    """
    place = Location(path)
    count = int.from_bytes(data[HEAD_BYTES - 4 : HEAD_BYTES], "little")
    size = HEAD_BYTES + TRIANGLE_BYTES * count
    if len(data) != size and data.lstrip()[:5].lower() == b"solid":
        return _read_text(place, data)
    if len(data) < max(size, HEAD_BYTES):
        raise place.error(f"STL file of {count} triangles has {len(data)} bytes, expected {size}", FETCH)
    return np.frombuffer(data, TRIANGLE, count, HEAD_BYTES)["corners"].astype(float)


def _read_text(place: Location, data: bytes) -> Triangles:
    """Return the triangles of all solids of a text."""
    values = parse_numbers(place, b" ".join(found[1] for found in VERTEX.finditer(data)))
    if len(values) % 9:
        raise place.error(f"STL file has {len(values) // 3} vertices, which are no triangles", FETCH)
    return values.reshape(-1, 3, 3)


def parse_numbers(place: Location, text: bytes) -> Float[np.ndarray, " n"]:
    """Return the numbers of a text that white space separates.

    Raises:
        DatasetError: The text has other words.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return np.fromstring(text.decode("latin-1"), sep=" ") if text.strip() else np.zeros(0)
    except (DeprecationWarning, ValueError):
        raise place.error("text of the file has other words than numbers", FETCH) from None
