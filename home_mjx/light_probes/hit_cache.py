"""Light of surfaces by place: means over points where it is known, for points near them."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.records.lights import NUM_GROUPS
from home_mjx.light_probes.surfaces import SurfacePoints

CELLS = 0.15, 0.5, 2.0  # [m], edges of cells; a cell without a point takes the mean of a larger one
COORDINATE_BITS, FACE_BITS = 13, 3  # of a key; coordinates of cells are offset to be positive


class LitPoints(NamedTuple):
    """Points of surfaces with the light that they get."""

    pos: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, "n 3"]
    instance: Int[np.ndarray, " n"]
    light: Float[np.ndarray, "n groups 3"]

    @classmethod
    def join(cls, parts: list["LitPoints"]) -> "LitPoints":
        """Return the points of all parts."""
        none = cls(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, int), np.zeros((0, NUM_GROUPS, 3), np.float32))
        return cls(*map(np.concatenate, zip(none, *parts, strict=True)))


@dataclass(frozen=True)
class HitCache:
    """Means of light by instance, cell and side of the surface.

    Attributes:
        light: Irradiance of all cells of all sizes; the last row is dark.
        edges: Edges of cells of each size [m].
        keys: Sorted keys of the cells of each size.
        start: Row of `light` of each size's first cell.
    """

    light: Float[np.ndarray, "k lanes"]
    edges: tuple[float, ...]
    keys: tuple[np.ndarray, ...]
    start: tuple[int, ...]

    @classmethod
    def from_points(cls, points: LitPoints, edges: tuple[float, ...] = CELLS) -> "HitCache":
        """Return the cache of points."""
        light, keys, start, flat = [], [], [], points.light.reshape(-1, 3 * NUM_GROUPS)
        for edge in edges:
            found, cell, number = np.unique(
                _keys(points.pos, points.normal, points.instance, edge), return_inverse=True, return_counts=True
            )
            order = np.argsort(cell, kind="stable")
            first = np.cumsum(number) - number
            total = np.add.reduceat(flat[order].astype(np.float64), first) if len(found) else flat[:0]
            start.append(sum(len(x) for x in light))
            light.append((total / number[:, None]).astype(np.float32))
            keys.append(found)
        light.append(np.zeros((1, 3 * NUM_GROUPS), np.float32))
        return cls(np.concatenate(light), edges, tuple(keys), tuple(start))

    def rows(self, points: SurfacePoints, instance: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        """Return the rows of `light` of points, by the smallest cell that has a mean; -1 without one."""
        rows, open_rows = np.full(len(instance), -1), np.flatnonzero(points.seen)
        for edge, keys, start in zip(self.edges, self.keys, self.start, strict=True):
            if len(keys) == 0:
                break
            key = _keys(points.pos[open_rows], points.normal[open_rows], instance[open_rows], edge)
            place = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
            found = keys[place] == key
            rows[open_rows[found]] = start + place[found]
            open_rows = open_rows[~found]
        return rows


def _keys(pos: np.ndarray, normal: np.ndarray, instance: np.ndarray, edge: float) -> Int[np.ndarray, " n"]:
    """Return keys of cells: instance, coordinates of the cell, and the axis and sign of the largest part of normals."""
    axis = np.abs(normal).argmax(axis=1)
    key = instance.astype(np.int64) << FACE_BITS | 2 * axis + (np.take_along_axis(normal, axis[:, None], 1)[:, 0] < 0)
    for place in np.moveaxis(np.floor(pos / edge).astype(np.int64) + (1 << COORDINATE_BITS - 1), 1, 0):
        key = key << COORDINATE_BITS | place & (1 << COORDINATE_BITS) - 1
    return key
