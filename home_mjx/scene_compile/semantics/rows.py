"""Rows of the semantic table: what a hit means."""

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.compiled import Semantic
from home_mjx.scene_compile.suncg.categories import coarse_index, fine_index, nyu40_index


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
    """One row; columns are those of `Semantic`. Those that the semantic engine fills are -1.

    Args:
        fine: Fine v1 category; `unknown` for names that v1 lacks.
        coarse: Coarse v1 category.
        nyu40: NYUv2-40 class; `void` for unknown names.
        object_id: Node index in file order over all levels.
        room: Room index in the house.
        level: Level index.
        partition: Physical wall or slab.
        movable: Movable slot.

    Example:
        >>> semantic_row("wall", "wall", "wall", level=0, partition=3)[[Semantic.NYU40, Semantic.PARTITION]]
        array([1, 3], dtype=int32)
    """
    row = np.full(len(Semantic), -1, np.int32)
    row[Semantic.OBJECT] = object_id
    row[Semantic.FINE] = fine_index(fine)
    row[Semantic.COARSE] = coarse_index(coarse)
    row[Semantic.NYU40] = nyu40_index(nyu40)
    row[Semantic.ROOM] = room
    row[Semantic.LEVEL] = level
    row[Semantic.PARTITION] = partition
    row[Semantic.MOVABLE] = movable
    return row
