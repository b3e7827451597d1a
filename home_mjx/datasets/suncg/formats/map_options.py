"""Options of a `map_Kd`: scale and offset of texture coordinates, clamping; others are without effect or refused."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location
from home_mjx.datasets.suncg.formats.statements import bare_name

VECTORS = ("-s", "-o", "-t")  # up to three numbers each
MAX_VALUES = {**dict.fromkeys(VECTORS, 3), "-mm": 2}  # maximum values of an option; 1 for others
INERT = ("-blendu", "-blendv", "-boost", "-texres", "-cc", "-bm", "-colorspace")  # filters of images, and bumps
NAMES = (*MAX_VALUES, *INERT, "-clamp", "-imfchan", "-type")
TRAILING = re.compile(rf'(.*?\.\w{{2,5}}"?)\s+((?:{"|".join(NAMES)})\s.*)', re.IGNORECASE)  # name, options behind it
CLAMP_TOLERANCE = 1e-3  # maximum distance of clamped texture coordinates from 0..1


@dataclass(frozen=True)
class PlacedMap:
    """A colour map with its placement: texture coordinates become `uv * scale + offset`.

    Attributes:
        file: Path as in the MTL; "" without a map.
        scale: Factors of u and v.
        offset: Shift of u and v.
        is_clamped: The image does not repeat.
    """

    file: str = ""
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    is_clamped: bool = False

    def place(self, uv: Float[np.ndarray, "f 3 2"]) -> Float[np.ndarray, "f 3 2"]:
        """Return `uv * scale + offset`: texture coordinates of the image for those of the OBJ.

        They are not clamped: of a clamped image, all must be in 0..1 within `CLAMP_TOLERANCE`.

        Raises:
            ValueError: The image is clamped, and coordinates are outside of it.

        Example:
            >>> PlacedMap("a.png", scale=(2.0, 1.0)).place(np.full((1, 3, 2), 0.5))[0, 0].tolist()
            [1.0, 0.5]
        """
        placed = uv * self.scale + self.offset
        if self.is_clamped and abs(placed - 0.5).max(initial=0) > 0.5 + CLAMP_TOLERANCE:
            raise ValueError("option `-clamp on` of `map_Kd`: faces reach beyond the image")
        return placed


def read_color_map(text: str, place: Location, is_known: Callable[[str], bool]) -> PlacedMap:
    """Read the arguments of a `map_Kd`.

    Of an option given twice the last counts. The file name loses its quotes and a comment behind it, unless it is
    known.

    Args:
        text: Options and file name, which may contain spaces.
        place: Line of the MTL, for errors.
        is_known: Returns whether a file of this name exists; such a name is not searched for options.

    Raises:
        DatasetError: There is no file name, or an option changes the image in a way that is not read.

    Example:
        >>> from pathlib import Path
        >>> read_color_map("-s 2 2 1 my wood.png", Location(Path("a.mtl")), lambda name: False).file
        'my wood.png'
    """
    values: dict[str, list[str]] = {}
    rest = _options_first(text, is_known)
    while rest.startswith("-") and not is_known(rest):
        name, count = rest.split()[0].lower(), len(rest.split())
        if name not in NAMES or count < 3:
            hint = "Known are the options of the MTL format, each with a value, before the name."
            raise place.error(f"expected a file name, got `{rest[:60]}`", hint)
        most = min(MAX_VALUES.get(name, 1), count - 2)  # the last word is part of the file name
        taken = _taken(rest.split()[1 : most + 1], name in MAX_VALUES, place, text)
        values[name] = taken
        rest = re.split(r"\s+", rest, maxsplit=len(taken) + 1)[-1]
    file = rest if is_known(rest) else bare_name(rest)
    if not file:
        raise place.error(f"expected a file name, got `{text[:60]}`")
    _check_options(values, place)
    scale, offset = (_pair(values.get(name, []), fill) for name, fill in (("-s", 1.0), ("-o", 0.0)))
    return PlacedMap(file, scale, offset, values.get("-clamp", ["off"])[0].lower() == "on")


def _options_first(text: str, is_known: Callable[[str], bool]) -> str:
    """Return the arguments with options behind the file name, which some exporters write, moved before it.

    They are unchanged without such options, with a comment, or if they end with a known name.
    """
    found = TRAILING.match(text)
    starts = [word.start() for word in re.finditer(r"\S+", text)]
    if found is None or re.search(r"\s#", found[1]) or any(is_known(text[start:]) for start in starts):
        return text
    return f"{bare_name(found[2])} {found[1]}"


def _taken(words: list[str], is_numeric: bool, place: Location, text: str) -> list[str]:
    """Return the first word or, if `is_numeric`, all leading numbers; raise `DatasetError` if there are none."""
    if not is_numeric:
        return words[:1]
    count = next((i for i, word in enumerate(words) if not _is_number(word)), len(words))
    if count == 0:
        raise place.error(f"expected a finite number after an option, got `{text[:60]}`")
    return words[:count]


def _is_number(word: str) -> bool:
    """Return whether a word is a finite ASCII number within `MAX_COORDINATE`, without `_`."""
    try:
        return word.isascii() and "_" not in word and abs(float(word)) <= MAX_COORDINATE and math.isfinite(float(word))
    except ValueError:
        return False


def _check_options(values: dict[str, list[str]], place: Location) -> None:
    """Raise `DatasetError` for options that would change the colours of the image.

    These are `-imfchan`, `-type`, a `-t` other than 0, and a `-mm` other than 0 or 0 1.
    """
    changes = {
        "-t": any(float(x) != 0 for x in values.get("-t", [])),
        "-mm": [float(x) for x in values.get("-mm", [])] not in ([], [0.0], [0.0, 1.0]),
        "-imfchan": "-imfchan" in values,
        "-type": "-type" in values,
    }
    for name in (name for name, is_changed in changes.items() if is_changed):
        hint = "Apply it to the image itself, and remove the option."
        raise place.error(f"option `{name} {' '.join(values[name])}` of `map_Kd` is not read", hint)


def _pair(words: list[str], fill: float) -> tuple[float, float]:
    """Return the first two numbers; missing ones are `fill`."""
    u, v, *_ = [*(float(word) for word in words), fill, fill]
    return u, v
