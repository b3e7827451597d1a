"""Names of colours at HoME's three levels: 16 basic ones, 139 of CSS, and 949 of the XKCD survey.

`color_names.csv` holds Matplotlib's `CSS4_COLORS` and `XKCD_COLORS`. The former is without the nine names that HoME
lacked (British spellings, `fuchsia`, `rebeccapurple`) and has spaces between the words of each name.

The nearest name has the smallest CIEDE2000 difference. Two tests compare it with CIELAB's and OKLab's Euclidean
distances and HoME's distance in sRGB. Of 464 XKCD colours whose last word is a basic colour ("olive green"), 42, 39, 30
and 27 % get that word. Of 103 XKCD colours with the same name in CSS, 28, 22, 22 and 25 % get that name.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import ciede2000, srgb_to_lab

COLOR_LEVELS = ("basic", "css", "xkcd")


@dataclass(frozen=True)
class Palette:
    """Colours of one level."""

    names: tuple[str, ...]  # sorted
    srgb: Float[np.ndarray, "c 3"]  # 0..1
    lab: Float[np.ndarray, "c 3"]


@cache
def palettes() -> Mapping[str, Palette]:
    """Return the three palettes by level.

    Example:
        >>> {level: len(palette.names) for level, palette in palettes().items()}
        {'basic': 16, 'css': 139, 'xkcd': 949}
    """
    text = files("home_mjx.schema").joinpath("color_names.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    return {level: _palette([row for row in rows if row["level"] == level]) for level in COLOR_LEVELS}


def _palette(rows: list[dict[str, str]]) -> Palette:
    """Convert rows of the table (`name`, and `srgb` as #rrggbb) to a palette, in their order."""
    srgb = np.array([list(bytes.fromhex(row["srgb"].removeprefix("#"))) for row in rows]) / 255
    return Palette(tuple(row["name"] for row in rows), srgb, srgb_to_lab(srgb))


def nearest_names(lab: Float[np.ndarray, "n 3"], level: str) -> list[str]:
    """Return for each colour, rounded to 0.1, the palette name with the smallest CIEDE2000 difference.

    Of equal colours, such as `aqua` and `cyan`, the first name in the palette is returned.

    Args:
        lab: CIELAB colours.
        level: One of `COLOR_LEVELS`.

    Example:
        >>> nearest_names(srgb_to_lab(np.array([[0.95, 0.1, 0.1]])), "css")
        ['red']
    """
    column = COLOR_LEVELS.index(level)
    return [_names_by_look(color)[column] for color in map(tuple, lab.round(1).tolist())]


@lru_cache(maxsize=1 << 14)
def _names_by_look(lab: tuple[float, float, float]) -> tuple[str, ...]:
    """Return the names nearest to a CIELAB colour, one per level of `COLOR_LEVELS`; cached, since many recur."""
    found = [palettes()[level] for level in COLOR_LEVELS]
    ends = np.cumsum([len(palette.names) for palette in found])[:-1]
    away = np.split(ciede2000(np.array(lab), np.concatenate([palette.lab for palette in found])), ends)
    return tuple(palette.names[int(part.argmin())] for palette, part in zip(found, away, strict=True))
