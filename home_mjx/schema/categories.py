"""SUNCG's fixed vocabularies and the index of a name in them; names of option values that packages share.

Ids on the device are indices into these tuples. Names that only v2 has come last, so that v1's ids are unchanged.
"""

import json
import re
from collections.abc import Iterable
from functools import cache
from importlib.resources import files

_LISTS: dict[str, list[str]] = json.loads(
    files("home_mjx.schema").joinpath("categories.json").read_text(encoding="utf-8")
)

NUM_FINE_V1, NUM_COARSE_V1 = len(_LISTS["fine"]), len(_LISTS["coarse"])  # 187 and 90
FINE: tuple[str, ...] = (*_LISTS["fine"], *_LISTS["fine_v2"])  # 187 + 52, each sorted by code point
COARSE: tuple[str, ...] = (*_LISTS["coarse"], *_LISTS["coarse_v2"])  # 90 + 4, each sorted by code point
NYU40: tuple[str, ...] = tuple(_LISTS["nyu40"])  # 41 in the order of NYUv2-40; 0 is void
ROOM_TYPES: tuple[str, ...] = tuple(_LISTS["room_types"])  # 25
CAMERA_MODELS = ("pinhole", "panorama", "cube", "orthographic", "lidar")
COLLISIONS = ("box", "exact")  # collision geometry of objects in an exported house


@cache
def _positions(names: tuple[str, ...]) -> dict[str, int]:
    """Return the position of each name."""
    return {name: index for index, name in enumerate(names)}


def fine_index(name: str) -> int:
    """Return the index of a name in `FINE`; other names map to `unknown`.

    Example:
        >>> FINE[fine_index("double_bed")], FINE[fine_index("bidet")], FINE[fine_index("unicorn")]
        ('double_bed', 'bidet', 'unknown')
    """
    return _positions(FINE).get(name, _positions(FINE)["unknown"])


def coarse_index(name: str) -> int:
    """Return the index of a name in `COARSE`; other names map to `unknown`."""
    return _positions(COARSE).get(name, _positions(COARSE)["unknown"])


def nyu40_index(name: str) -> int:
    """Return the NYUv2-40 label of a name; 0 (void) if unknown."""
    return _positions(NYU40).get(name, 0)


def room_type_index(name: str) -> int:
    """Return the index of a name in `ROOM_TYPES`; -1 if unknown."""
    return _positions(ROOM_TYPES).get(name, -1)


def room_labels(names: Iterable[str]) -> int:
    """Return the labels of a room as a bit mask: bit i stands for `ROOM_TYPES[i]`; 0 without a known label.

    Example:
        >>> room_labels(["Kitchen", "Dining_Room"]), room_labels(["Cellar"])
        (18, 0)
    """
    return sum({1 << index for index in map(room_type_index, names) if index >= 0})


def room_types_in(labels: int) -> tuple[int, ...]:
    """Return the indices into `ROOM_TYPES` of a bit mask of `room_labels`, ascending; () for 0, and for -1 (no room).

    Example:
        >>> room_types_in(18)
        (1, 4)
    """
    return tuple(index for index in range(len(ROOM_TYPES)) if labels > 0 and labels >> index & 1)


def texture_family(texture: str) -> str:
    """Return the family of a SUNCG texture name.

    All digits, then trailing underscores are removed. Names that contain `textile` or else `wood`, in lower case, map
    to it (HoME's rule).

    Args:
        texture: Name without folder and extension.

    Example:
        >>> texture_family("wallp_0"), texture_family("facing_stone_12"), texture_family("wood_3_1")
        ('wallp', 'facing_stone', 'wood')
    """
    name = re.sub(r"\d", "", texture).rstrip("_")
    return next((family for family in ("textile", "wood") if family in name), name)
