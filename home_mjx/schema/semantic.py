"""Rows of the semantic table, which describe the surfaces that rays hit."""

import numpy as np
from jaxtyping import Int

from home_mjx.core.named_enum import NamedIntEnum
from home_mjx.schema.categories import coarse_index, fine_index, nyu40_index

SIZES = ("tiny", "small", "normal", "large", "huge")  # size classes within a category
SUPPORTS = ("floor", "wall", "ceiling", "object")


class Semantic(NamedIntEnum):
    """Columns of the semantic table; -1 means none."""

    OBJECT_ID = 0  # node index in file order, over all levels
    FINE = 1  # index into the sorted v1 fine categories; names only in v2 follow
    COARSE = 2
    NYU40 = 3  # 0 void, 1 wall .. 40 otherprop
    ROOM = 4  # room index in the house
    LEVEL = 5
    PARTITION = 6  # physical wall or slab; its sound transmission applies once per crossing
    MOVABLE = 7  # index of the movable body
    ROOM_TYPE = 8  # first label of the room, index into ROOM_TYPES
    MATERIAL = 9  # index into MATERIAL_KINDS
    SIZE = 10  # within the category, index into SIZES
    COLOR = 11  # main colour, index into the palette of 16; up to two more follow
    COLOR_2 = 12
    COLOR_3 = 13
    CSS = 14  # the same for the palette of 139
    CSS_2 = 15
    CSS_3 = 16
    XKCD = 17  # the same for the palette of 949
    XKCD_2 = 18
    XKCD_3 = 19
    SUPPORT = 20  # index into SUPPORTS
    SUPPORTER = 21  # object id of the supporting object
    CONTAINER = 22  # object id of the containing object
    ROOM_LABELS = 23  # all labels of the room as a bit mask: bit i stands for ROOM_TYPES[i]


def semantic_row(
    fine: str,
    coarse: str,
    nyu40: str,
    *,
    object_id: int = -1,
    room: int = -1,
    level: int = -1,
    partition: int = -1,
    movable: int = -1,
) -> Int[np.ndarray, " c"]:
    """Build a row of the semantic table; columns that are no argument, filled later, are -1.

    `fine` and `coarse` are names in `FINE` and `COARSE`, others map to `unknown`; `nyu40` is one in `NYU40`, others map
    to `void`. The other arguments are columns of `Semantic`.

    Example:
        >>> semantic_row("wall", "wall", "wall", level=0, partition=3)[[Semantic.NYU40, Semantic.PARTITION]]
        array([1, 3], dtype=int32)
    """
    row = np.full(len(Semantic), -1, np.int32)
    row[Semantic.OBJECT_ID] = object_id
    row[Semantic.FINE] = fine_index(fine)
    row[Semantic.COARSE] = coarse_index(coarse)
    row[Semantic.NYU40] = nyu40_index(nyu40)
    row[Semantic.ROOM] = room
    row[Semantic.LEVEL] = level
    row[Semantic.PARTITION] = partition
    row[Semantic.MOVABLE] = movable
    return row
