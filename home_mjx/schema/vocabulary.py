"""Vocabularies of the semantic table: names of its integers."""

from collections.abc import Mapping
from functools import cache

import numpy as np
from jaxtyping import Int

from home_mjx.core.checks import check_known
from home_mjx.schema.categories import COARSE, FINE, NYU40, ROOM_TYPES
from home_mjx.schema.color_names import palettes
from home_mjx.schema.material_kinds import MATERIAL_KINDS
from home_mjx.schema.semantic import SIZES, SUPPORTS, Semantic

COLORS_PER_LEVEL = 3  # number of columns per level of colour names
FIRST_COLOR = {"basic": Semantic.BASIC, "css": Semantic.CSS, "xkcd": Semantic.XKCD}


@cache
def vocabularies() -> Mapping[Semantic, tuple[str, ...]]:
    """Return the names by number, for each column that has names.

    Example:
        >>> vocabularies()[Semantic.SIZE]
        ('tiny', 'small', 'normal', 'large', 'huge')
    """
    named = {
        Semantic.FINE: FINE,
        Semantic.COARSE: COARSE,
        Semantic.NYU40: NYU40,
        Semantic.ROOM_TYPE: ROOM_TYPES,
        Semantic.MATERIAL: MATERIAL_KINDS,
        Semantic.SIZE: SIZES,
        Semantic.SUPPORT: SUPPORTS,
    }
    for level, first in FIRST_COLOR.items():
        named |= {Semantic(first + i): palettes()[level].names for i in range(COLORS_PER_LEVEL)}
    return named


@cache
def _numbers(column: Semantic) -> Mapping[str, int]:
    return {name: number for number, name in enumerate(vocabularies()[column])}


def encode_name(column: Semantic, name: str) -> int:
    """Return the number of a name in a column; -1 for "" and "unknown".

    Args:
        column: A column that has names.
        name: Such as `wood` in `Semantic.MATERIAL`.

    Raises:
        ConfigError: The column has no such name.

    Example:
        >>> encode_name(Semantic.SIZE, "large"), encode_name(Semantic.SIZE, "")
        (3, -1)
    """
    if name not in ("", "unknown"):
        check_known(f"name in {column.name}", [name], _numbers(column))
    return _numbers(column).get(name, -1)


def decode_row(row: Int[np.ndarray, " c"]) -> dict[str, str | int]:
    """Convert a row of the semantic table to a dictionary by column name, with names for numbers; omit entries of -1.

    Args:
        row: One entry per `Semantic`.
    """
    named = vocabularies()
    found = {column: int(row[column]) for column in Semantic if row[column] >= 0}
    return {
        column.name.lower(): named[column][number] if column in named else number for column, number in found.items()
    }
