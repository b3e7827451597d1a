"""Baked probes of one house, and stacking of several houses with padding."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int, UInt32

from home_mjx.bank.records.lights import NUM_GROUPS, LightProbes
from home_mjx.light_probes.charts import Charts
from home_mjx.light_probes.lattice import ProbeLattice

AXES = {
    "light": ("probes",),
    "room": ("probes",),
    "spill": ("rooms", "rooms"),
    "texel": ("texels",),
    "texel_room": ("texels",),
    "chart_start": ("instances",),
    "chart": ("triangles",),
    "chart_frame": ("charts",),
    "chart_count": ("charts",),
    "chart_first": ("charts",),
}  # those whose lengths differ; of other fields: rooms
# Multiples to which they are padded.
PADDING = {
    "probes": 256,
    "rooms": 4,
    "texels": 1024,
    "instances": 32,
    "triangles": 1024,
    "charts": 64,
}
MAX_COLOR = 65408.0  # the largest number of the packed format
FILL = {"first": -1, "keys": -1, "count": 2, "step": 1, "chart_start": -1, "chart": -1, "chart_count": 2}


class SurfaceLight(NamedTuple):
    """Light at the texels of charts."""

    charts: Charts
    light: Float[np.ndarray, "x texel_groups 3"]


@dataclass(frozen=True)
class ProbeField:
    """Baked light probes of one house; see `bank.records.lights.LightProbes` for its fields."""

    light: UInt32[np.ndarray, "p groups 6"]
    room: Int[np.ndarray, " p"]
    first: Int[np.ndarray, " r"]
    origin: Float[np.ndarray, "r 3"]
    step: Float[np.ndarray, "r 3"]
    count: Int[np.ndarray, "r 3"]
    keys: Int[np.ndarray, "r k"]
    spill: Float[np.ndarray, "r s"]
    texel: UInt32[np.ndarray, "x texel_groups"]
    texel_room: Int[np.ndarray, " x"]
    chart_start: Int[np.ndarray, " i"]
    chart: Int[np.ndarray, " t"]
    chart_frame: Float[np.ndarray, "c 3 3"]
    chart_count: Int[np.ndarray, "c 2"]
    chart_first: Int[np.ndarray, " c"]

    @classmethod
    def pack(
        cls,
        lattice: ProbeLattice,
        light: Float[np.ndarray, "p 6 lanes"],
        valid: Bool[np.ndarray, " p"],
        keys: Int[np.ndarray, "r k"],
        spill: Float[np.ndarray, "r s"],
        surfaces: SurfaceLight,
    ) -> "ProbeField":
        """Return the record; rooms without a valid probe get none."""
        charts = surfaces.charts
        groups = np.moveaxis(light.reshape(len(light), 6, NUM_GROUPS, 3), 1, 2)
        lit = np.bincount(lattice.room[valid], minlength=len(lattice.first)) > 0
        return cls(
            pack_colors(groups),
            lattice.room.astype(np.int16),
            np.where(lit, lattice.first, -1).astype(np.int32),
            lattice.origin.astype(np.float32),
            lattice.step.astype(np.float32),
            lattice.count.astype(np.int32),
            keys,
            other_shares(spill),
            pack_colors(surfaces.light),
            charts.room.astype(np.int16),
            charts.start.astype(np.int32),
            charts.of_triangle.astype(np.int16),
            charts.frame.astype(np.float32),
            charts.count.astype(np.int16),
            charts.first.astype(np.int32),
        )

    @property
    def nbytes(self) -> int:
        """Size of all arrays as stored [bytes]."""
        return sum(x.nbytes for x in vars(self).values())

    @property
    def lengths(self) -> dict[str, int]:
        """Lengths of the axes of `PADDING`."""
        return {
            "probes": len(self.light),
            "rooms": len(self.first),
            "texels": len(self.texel),
            "instances": len(self.chart_start),
            "triangles": len(self.chart),
            "charts": len(self.chart_first),
        }


def pack_colors(color: Float[np.ndarray, "*n 3"]) -> UInt32[np.ndarray, "*n"]:
    """Pack colours of at least 0 to 32 bits: 9 bits per channel, red lowest, and a common exponent in the highest 5.

    Source: the texture format RGB9E5 of OpenGL, EXT_texture_shared_exponent. `shaders.probes` unpacks them.
    """
    color = np.clip(color, 0, MAX_COLOR)
    power = np.frexp(color.max(axis=-1, initial=2.0**-16))[1]
    power += np.round(color.max(axis=-1) * 2.0 ** (9 - power)) >= 512
    channel = np.round(color * 2.0 ** (9 - power)[..., None]).astype(np.uint32)
    return channel[..., 0] | channel[..., 1] << 9 | channel[..., 2] << 18 | (power + 15).astype(np.uint32) << 27


def other_shares(spill: Float[np.ndarray, "r s"]) -> Float[np.ndarray, "r r"]:
    """Return for each room the shares of other rooms in the light that it gets from other rooms' lamps."""
    shares = spill[:, 1:] * (1 - np.eye(len(spill)))
    return (shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-20)).astype(np.float32)


def padded_lengths(records: Sequence[ProbeField], capacity_factor: float = 1.0) -> dict[str, int]:
    """Return lengths of the axes of `PADDING`, padded, for fields up to `capacity_factor` times the largest."""
    largest = {axis: max(record.lengths[axis] for record in records) for axis in PADDING}
    return {
        axis: max(-(-math.ceil(n * capacity_factor) // PADDING[axis]), int(axis != "texels")) * PADDING[axis]
        for axis, n in largest.items()
    }


def stack_fields(records: Sequence[ProbeField], lengths: Mapping[str, int] | None = None) -> LightProbes:
    """Stack the fields of several houses with padding.

    Args:
        records: One field per house.
        lengths: Lengths of the axes, see `padded_lengths`; None: for the largest of these fields.
    """
    lengths = padded_lengths(records) if lengths is None else lengths
    arrays = {f.name: jnp.asarray(_stack(f.name, records, lengths)) for f in fields(ProbeField)}
    return LightProbes(**arrays)


def _stack(name: str, records: Sequence[ProbeField], lengths: Mapping[str, int]) -> np.ndarray:
    """Stack one array of all fields, padded."""
    arrays = [getattr(record, name) for record in records]
    size = [lengths[axis] for axis in AXES.get(name, ("rooms",))]
    out = np.full((len(arrays), *size, *arrays[0].shape[len(size) :]), FILL.get(name, 0), arrays[0].dtype)
    for row, x in zip(out, arrays, strict=True):
        row[tuple(slice(n) for n in x.shape)] = x
    return out
