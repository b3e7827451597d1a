"""Vocabularies of the semantic table: names of its integers."""

from collections.abc import Mapping
from functools import cache

import numpy as np
from jaxtyping import Int

from home_mjx.errors import UnknownNameError, did_you_mean
from home_mjx.schema.categories import COARSE, FINE, NYU40, ROOM_TYPES, room_types_in
from home_mjx.schema.color_names import nearest_names, palettes
from home_mjx.schema.material_kinds import MATERIAL_KINDS
from home_mjx.schema.semantic import SIZES, SUPPORTS, Semantic

COLORS_PER_LEVEL = 3  # number of columns per level of colour names
FIRST_COLOR = {"basic": Semantic.COLOR, "css": Semantic.CSS, "xkcd": Semantic.XKCD}


@cache
def vocabularies() -> Mapping[Semantic, tuple[str, ...]]:
    """Return for each column that has names a tuple of them; a name's position is the number in the table.

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
    """Return the position of each name of a column."""
    return {name: number for number, name in enumerate(vocabularies()[column])}


def encode_name(column: Semantic, name: str) -> int:
    """Return the number of a name in a column; -1 for "", and for "unknown" unless it is a name of the column.

    Args:
        column: A column that has names.
        name: Such as `wood` in `Semantic.MATERIAL`.

    Raises:
        UnknownNameError: The column has no such name, or no names at all, such as `Semantic.ROOM`.

    Example:
        >>> encode_name(Semantic.SIZE, "large"), encode_name(Semantic.SIZE, "")
        (3, -1)
    """
    if column not in vocabularies():
        named = [other.name for other in vocabularies()]
        raise UnknownNameError(f"entries of `Semantic.{column.name}` have no names", hint=did_you_mean("", named))
    if name not in ("", "unknown") and name not in _numbers(column):
        what = f"{column.name.lower().replace('_', ' ')}"
        hint = _color_hint(column, name) or did_you_mean(name, _numbers(column))
        raise UnknownNameError(f"unknown {what} `{name}` in `Semantic.{column.name}`", hint=hint)
    return _numbers(column).get(name, -1)


def _color_hint(column: Semantic, name: str) -> str | None:
    """Return a hint for a colour that another palette has, with the most similar name of this one.

    None if no palette has it, or if the column is not one of colours.
    """
    own = next((level for level, first in FIRST_COLOR.items() if first <= column < first + COLORS_PER_LEVEL), None)
    others = [level for level, first in FIRST_COLOR.items() if own is not None and name in _numbers(first)]
    if own is None or not others:
        return None
    palette = palettes()[others[0]]
    nearest = nearest_names(palette.lab[[palette.names.index(name)]], own)[0]
    where = " and ".join(f"`Semantic.{FIRST_COLOR[level].name}`" for level in others)
    known = did_you_mean("", palettes()[own].names)
    return f"It is a name in {where}; the most similar one here is `{nearest}`. {known}"


def decode_row(row: Int[np.ndarray, " c"]) -> dict[str, str | int | tuple[str, ...]]:
    """Convert a row of the semantic table to a dictionary by lower-case column name; omit negative entries.

    Numbers of columns with `vocabularies` become names, `room_labels` a tuple of names; others stay numbers.

    Args:
        row: One entry per `Semantic`.
    """
    named = vocabularies()
    found = {column: int(row[column]) for column in Semantic if row[column] >= 0}
    decoded: dict[str, str | int | tuple[str, ...]] = {
        column.name.lower(): named[column][number] if column in named else number for column, number in found.items()
    }
    if Semantic.ROOM_LABELS in found:
        decoded["room_labels"] = tuple(ROOM_TYPES[kind] for kind in room_types_in(found[Semantic.ROOM_LABELS]))
    return decoded
