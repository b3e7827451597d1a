"""What the semantic engine says, as numbers for the device: see `vocabulary` for what they stand for."""

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics, PartSemantics
from home_mjx.scene_compile.semantics.vocabulary import FIRST_COLOR, MAX_COLORS, number_of
from home_mjx.schema.semantic import Semantic


def with_meaning(rows: Int[np.ndarray, "q c"], house: HouseSemantics) -> Int[np.ndarray, "q c"]:
    """The rows of a house with the columns that the semantic engine fills.

    Args:
        rows: One per part of the architecture, then one per object.
        house: What the engine says of them, in the same order.
    """
    rows = rows.copy()
    for row, item in zip(rows, (*house.parts, *house.objects), strict=True):
        _fill_look(row, item)
    for row, item in zip(rows[len(house.parts) :], house.objects, strict=True):
        row[Semantic.SIZE] = number_of(Semantic.SIZE, item.size)
        row[Semantic.SUPPORT] = number_of(Semantic.SUPPORT, item.support.kind)
        row[Semantic.SUPPORTER] = item.support.supporter
        row[Semantic.CONTAINER] = item.support.container
    return rows


def _fill_look(row: Int[np.ndarray, " c"], item: ObjectSemantics | PartSemantics) -> None:
    """Room type, first material and first colours of each level."""
    row[Semantic.ROOM_TYPE] = number_of(Semantic.ROOM_TYPE, item.room_type)
    row[Semantic.MATERIAL] = number_of(Semantic.MATERIAL, next(iter(item.look.materials), ""))
    for level, first in FIRST_COLOR.items():
        found = [number_of(first, name) for name in item.look.colors[level][:MAX_COLORS]]
        row[first : first + len(found)] = found
