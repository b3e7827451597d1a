"""Semantics as integer rows for the device; `vocabulary` maps them to names."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.architecture.shell import BuildingShell
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics, PartSemantics
from home_mjx.schema.categories import room_labels
from home_mjx.schema.compiled import Bodies
from home_mjx.schema.semantic import Semantic, semantic_row
from home_mjx.schema.vocabulary import COLORS_PER_LEVEL, FIRST_COLOR, encode_name


def build_semantic_rows(
    shell: BuildingShell, objects: Sequence[PlacedObject], bodies: Bodies, semantics: HouseSemantics
) -> Int[np.ndarray, "q columns"]:
    """Return the semantic rows of a house: one per part of its shell, then one per object. Columns: `Semantic`."""
    body = {instance: row for row, instance in enumerate(bodies.instance.tolist())}
    rows = [shell.semantics, *(_object_row(o, body.get(o.instance, -1))[None] for o in objects)]
    return fill_semantics(np.concatenate(rows), semantics)


def _object_row(item: PlacedObject, body: int) -> Int[np.ndarray, " columns"]:
    """Return the row of an object with the columns that follow from the dataset; `body` is -1 if it is fixed."""
    info = item.info
    return semantic_row(
        info.fine,
        info.coarse,
        info.nyu40,
        object_id=item.object_id,
        room=item.room,
        level=item.level,
        movable=body,
    )


def fill_semantics(rows: Int[np.ndarray, "q c"], house: HouseSemantics) -> Int[np.ndarray, "q c"]:
    """Return a copy of the rows of a house (parts, then objects) with the columns of the semantic engine filled in."""
    rows = rows.copy()
    for row, item in zip(rows, (*house.parts, *house.objects), strict=True):
        _fill_look(row, item)
    for row, item in zip(rows[len(house.parts) :], house.objects, strict=True):
        row[Semantic.SIZE] = encode_name(Semantic.SIZE, item.size)
        row[Semantic.SUPPORT] = encode_name(Semantic.SUPPORT, item.support.kind)
        row[Semantic.SUPPORTER] = item.support.supporter
        row[Semantic.CONTAINER] = item.support.container
    return rows


def _fill_look(row: Int[np.ndarray, " c"], item: ObjectSemantics | PartSemantics) -> None:
    """Write room labels, first material and first `COLORS_PER_LEVEL` colours of each level into a row, in place."""
    row[Semantic.ROOM_TYPE] = encode_name(Semantic.ROOM_TYPE, item.room_type)
    row[Semantic.ROOM_LABELS] = room_labels(item.room_types) or -1
    row[Semantic.MATERIAL] = encode_name(Semantic.MATERIAL, next(iter(item.appearance.materials), ""))
    for level, first in FIRST_COLOR.items():
        found = [encode_name(first, name) for name in item.appearance.colors[level][:COLORS_PER_LEVEL]]
        row[first : first + len(found)] = found
