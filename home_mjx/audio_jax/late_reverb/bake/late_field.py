"""Baked late field of one house, and stacking of several houses with padding."""

import dataclasses
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, Int8, UInt8

from home_mjx.audio_jax.late_reverb.lookup.time_grid import MIN_ENERGY
from home_mjx.audio_jax.late_reverb.trace.cells import CELLS_PER_PLACE, MAX_CELLS
from home_mjx.bank.records.acoustics import LateReverb

# Axes whose lengths differ between houses, and the multiples to which these are padded.
AXIS_PADDING = {"cells": 16, "rooms": 4, "levels": 1, "rows": 8, "columns": 8, "near_cells": 1, "portals": 4}
MAX_LENGTHS = {"cells": MAX_CELLS, "near_cells": CELLS_PER_PLACE}  # that no house exceeds
# The first axes of each field; the others have equal lengths in all houses.
FIELD_AXES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("arrival", "level", "comes_from"), ("cells", "cells")),
    "room": ("cells",),
    **dict.fromkeys(("shape", "opening", "wall"), ("rooms", "rooms")),
    **dict.fromkeys(("volume", "loss"), ("rooms",)),
    **dict.fromkeys(("near", "weight"), ("levels", "rows", "columns", "near_cells")),
    "floor": ("levels",),
    **dict.fromkeys(("portal_room", "portal_share", "portal_leaf", "portal_leak"), ("portals",)),
}
HALF_FIELDS = ("level", "shape", "weight", "loss", "opening", "wall", "portal_leak")
PAD_VALUES: dict[str, Any] = {
    "level": np.log(MIN_ENERGY),
    "shape": np.log(MIN_ENERGY),
    "floor": np.inf,
    "volume": 1.0,
    "loss": 1.0,
    "portal_leaf": -1,
}


@dataclass(frozen=True)
class LateField:
    """Baked late reverberation of one house; see `bank.records.acoustics.LateReverb` for its fields."""

    arrival: UInt8[np.ndarray, "n n"]
    level: Float[np.ndarray, "n n spans bands"]
    comes_from: Int8[np.ndarray, "n n spans 3"]
    room: Int[np.ndarray, " n"]
    shape: Float[np.ndarray, "r r bands knots"]
    near: UInt8[np.ndarray, "levels rows columns e"]
    weight: Float[np.ndarray, "levels rows columns e"]
    floor: Float[np.ndarray, " levels"]
    origin: Float[np.ndarray, " 2"]
    step: Float[np.ndarray, ""]
    volume: Float[np.ndarray, " r"]
    loss: Float[np.ndarray, "r bands"]
    opening: Float[np.ndarray, "r r bands"]
    wall: Float[np.ndarray, "r r bands"]
    portal_room: Int[np.ndarray, "p 2"]
    portal_share: Float[np.ndarray, " p"]
    portal_leaf: Int[np.ndarray, "p 2"]
    portal_leak: Float[np.ndarray, "p bands"]

    @property
    def nbytes(self) -> int:
        """Size of all arrays as stored [bytes]."""
        return sum(x.nbytes for x in vars(self).values())

    @property
    def lengths(self) -> dict[str, int]:
        """Lengths of the axes of `AXIS_PADDING`."""
        named = {name: dict(zip(axes, getattr(self, name).shape, strict=False)) for name, axes in FIELD_AXES.items()}
        return {axis: length for axes in named.values() for axis, length in axes.items()}


def pack_field(values: dict[str, np.ndarray]) -> LateField:
    """Convert arrays by name, `HALF_FIELDS` to float16 (clipped), float64 to float32; return them as a field."""
    half = {name: np.clip(values[name], -6e4, 6e4).astype(np.float16) for name in HALF_FIELDS}
    rest = {n: x.astype(np.float32) if x.dtype == np.float64 else x for n, x in values.items() if n not in half}
    return LateField(**rest, **half)


def padded_lengths(fields: Sequence[LateField], capacity_factor: float = 1.0) -> dict[str, int]:
    """Return lengths of the axes of `AXIS_PADDING`, padded, for fields up to `capacity_factor` times the largest.

    They are rounded up to the multiples there, at least one. There must be a field. The factor raises no length above
    `MAX_LENGTHS`, which no house exceeds.
    """
    found = [field.lengths for field in fields]
    lengths: dict[str, int] = {}
    for axis, block in AXIS_PADDING.items():
        largest = max(each[axis] for each in found)
        grown = min(math.ceil(largest * capacity_factor), max(largest, MAX_LENGTHS.get(axis, sys.maxsize)))
        lengths[axis] = max(-(-grown // block), 1) * block
    return lengths


def stack_fields(
    fields: Sequence[LateField], leaf_rows: Sequence[Int[np.ndarray, " _"]], lengths: Mapping[str, int] | None = None
) -> LateReverb:
    """Stack the fields of several houses with padding.

    Args:
        fields: One field per house.
        leaf_rows: For each house, the bank's row of each door leaf; leaf -1 stays -1.
        lengths: Lengths of the axes, see `padded_lengths`; None: for the largest of these fields.

    Raises:
        ValueError: A field is longer than `lengths`.
    """
    lengths = padded_lengths(fields) if lengths is None else lengths
    rows = [np.append(row, -1)[field.portal_leaf] for field, row in zip(fields, leaf_rows, strict=True)]
    fields = [dataclasses.replace(field, portal_leaf=leaf) for field, leaf in zip(fields, rows, strict=True)]
    arrays = {f.name: jnp.asarray(_pad(f.name, fields, lengths)) for f in dataclasses.fields(LateField)}
    return LateReverb(num_rooms=jnp.asarray([len(field.volume) for field in fields], jnp.int32), **arrays)


def _pad(name: str, fields: Sequence[LateField], lengths: Mapping[str, int]) -> np.ndarray:
    """Stack one array of all fields, padded with its value in `PAD_VALUES`, else 0, to `lengths`.

    A longer array raises `ValueError`.
    """
    arrays = [np.asarray(getattr(field, name)) for field in fields]
    size = [lengths[axis] for axis in FIELD_AXES.get(name, ())]
    size += arrays[0].shape[len(size) :]
    out = np.full((len(arrays), *size), PAD_VALUES.get(name, 0), arrays[0].dtype)
    for row, x in enumerate(arrays):
        out[(row, *(slice(n) for n in x.shape))] = x
    return out
