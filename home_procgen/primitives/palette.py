"""Colours and textures of material slots by finish."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from home_mjx.schema.house import Material

Color = tuple[float, float, float]
T = TypeVar("T")


def rgb(code: str) -> Color:
    """Return sRGB in 0..1 from `#rrggbb`.

    Example:
        >>> rgb("#ff0000")
        (1.0, 0.0, 0.0)
    """
    red, green, blue = (int(code[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


def textured(name: str, tint: str = "#ffffff", slot: str = "") -> Material:
    """Return an opaque material with a texture of the library, multiplied by `tint` (`#rrggbb`)."""
    return Material(slot, rgb(tint), Path("texture") / f"{name}.png", 1.0)


def plain(color: str, opacity: float = 1.0, slot: str = "") -> Material:
    """Return a material of one colour (`#rrggbb`), without a texture."""
    return Material(slot, rgb(color), None, opacity)


def _plain(*colors: str) -> tuple[Material, ...]:
    return tuple(plain(color) for color in colors)


def _textured(*names: str) -> tuple[Material, ...]:
    return tuple(textured(name) for name in names)


FINISHES: Mapping[str, tuple[Material, ...]] = {
    "wood": _textured("wood_1", "wood_2", "wood_3", "wood_4", "wood_5", "wood_6"),
    "color": _plain("#f2f0ea", "#dfe3e0", "#c9d3d6", "#e6d8c3", "#b9c4b1", "#8fa3ad", "#d9b8a4"),
    "textile": _textured("textile_1", "textile_2", "textile_3", "textile_4", "textile_5"),
    "upholstery": _textured("textile_1", "textile_2", "textile_3", "textile_4", "textile_5", "leather_1", "leather_2"),
    "linen": tuple(textured("linen_1", tint) for tint in ("#ffffff", "#e4ecf2", "#f3e6da", "#e3eadd")),
    "carpet": _textured("carpet_1", "carpet_2", "carpet_3", "textile_3", "textile_4"),
    "stone": _textured("stone_1", "stone_2"),
    "chrome": _plain("#c4c6c8", "#a9adb1"),
    "steel": _plain("#b4b8bb", "#e8eaea", "#8c9094"),
    "black": _plain("#1e1f22"),
    "plastic": _plain("#2b2d31", "#7b2f2a", "#e9e4d8", "#3f5a63"),
    "ceramic": _plain("#f5f5f3"),
    "glass": (plain("#9fbcc6", opacity=0.35),),
    "mirror": _plain("#d7e1e6"),
    "shade": _plain("#f4e6c4", "#f0efe9", "#d9c3a0"),
    "bulb": _plain("#fff6dc"),
    "screen": _plain("#0d0f13"),
    "picture": _textured("picture_1", "picture_2", "picture_3", "picture_4"),
    "book": _plain("#8c2f2b", "#2f4a6b", "#3d5c43", "#c9a24a", "#5a3f5e"),
}

DRY_WALLS = (
    *(textured("wallp_0", tint) for tint in ("#f6f3ea", "#e9e2d3", "#dfe7e8", "#e6ebdf", "#f0dfd3", "#d7dde6")),
    *_textured("wallp_1", "wallp_2", "wallp_3", "wallp_4"),
)
WET_WALLS = _textured("tile_1", "tile_2", "tile_5")
FACADES = (*_textured("bricks_1", "bricks_2"), textured("stucco_1", "#f3ead6"))
CEILINGS = (plain("#fafaf7"), textured("stucco_1"))
CUT_MATERIAL = plain("#808080")  # SUNCG's grey of cut wall faces


def choose_random(options: Sequence[T], rng: np.random.Generator) -> T:
    """Draw one of the options with equal probabilities."""
    return options[int(rng.integers(len(options)))]
