"""Baked late field of one house, and stacking of several houses with padding."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, Int8, UInt8

from home_mjx.audio_jax.late_reverb.lookup.time_grid import MIN_ENERGY
from home_mjx.bank.records.acoustics import LateReverb

# Multiples to which the first axes of each field are padded; other axes have equal lengths in all houses.
AXIS_PADDING: dict[str, tuple[int, ...]] = {
    **dict.fromkeys(("arrival", "level", "comes_from"), (16, 16)),
    "room": (16,),
    **dict.fromkeys(("shape", "opening", "wall"), (4, 4)),
    **dict.fromkeys(("volume", "loss"), (4,)),
    **dict.fromkeys(("near", "weight"), (1, 8, 8, 1)),
    "floor": (1,),
    **dict.fromkeys(("portal_room", "portal_share", "portal_leaf", "portal_leak"), (4,)),
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


def pack_field(values: dict[str, np.ndarray]) -> LateField:
    """Convert arrays to the lowest sufficient precision and return them as a field."""
    half = {name: np.clip(values[name], -6e4, 6e4).astype(np.float16) for name in HALF_FIELDS}
    rest = {n: x.astype(np.float32) if x.dtype == np.float64 else x for n, x in values.items() if n not in half}
    return LateField(**rest, **half)


def stack_fields(fields: Sequence[LateField], leaf_rows: Sequence[Int[np.ndarray, " _"]]) -> LateReverb:
    """Stack the fields of several houses, padded to the largest.

    Args:
        fields: One field per house.
        leaf_rows: For each house, the bank's row of each door leaf.
    """
    rows = [np.append(row, -1)[field.portal_leaf] for field, row in zip(fields, leaf_rows, strict=True)]
    fields = [dataclasses.replace(field, portal_leaf=leaf) for field, leaf in zip(fields, rows, strict=True)]
    arrays = {f.name: jnp.asarray(_pad(f.name, fields)) for f in dataclasses.fields(LateField)}
    return LateReverb(num_rooms=jnp.asarray([len(field.volume) for field in fields], jnp.int32), **arrays)


def _pad(name: str, fields: Sequence[LateField]) -> np.ndarray:
    """Stack one array of all fields, padded with `PAD_VALUES` to multiples of `AXIS_PADDING`."""
    arrays = [np.asarray(getattr(field, name)) for field in fields]
    size = np.max([x.shape for x in arrays], axis=0).astype(int)
    for axis, block in enumerate(AXIS_PADDING.get(name, ())):
        size[axis] = max(-(-size[axis] // block), 1) * block
    out = np.full((len(arrays), *size), PAD_VALUES.get(name, 0), arrays[0].dtype)
    for row, x in enumerate(arrays):
        out[(row, *(slice(n) for n in x.shape))] = x
    return out
