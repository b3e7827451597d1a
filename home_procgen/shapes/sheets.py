"""Thin solids: cloth, moulded shells and leaves."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from home_procgen.primitives.detail import limit_steps
from home_procgen.primitives.solids import Solid, Vector
from home_procgen.shapes.rounded import join_grids, weld


def sheet(material: str, points: Float[np.ndarray, "n m 3"], thickness: float) -> Solid:
    """Return the solid around a grid of points, half of `thickness` to each side along the surface's normals [m]."""
    along, across = np.gradient(points, axis=0), np.gradient(points, axis=1)
    normal = np.cross(along, across)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    under, upper = (points + side * normal * thickness / 2 for side in (-1, 1))
    return join_grids(material, under, upper)


def surface(
    material: str, place: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, ...]], n: int, m: int, thickness: float
) -> Solid:
    """Return a sheet of n x m pieces, whose points (x, y, z) [m] are a function of u and v in 0..1."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    return sheet(material, np.stack(np.broadcast_arrays(*place(u, v), u)[:3], -1), thickness)


def leaf(
    material: str,
    length: float,
    width: float,
    at: Vector = (0.0, 0.0, 0.0),
    yaw: float = 0.0,
    rise: float = 0.8,
    droop: float = 1.2,
    shape: float = 1.0,
    pieces: int = 4,
) -> Solid:
    """Return a pointed leaf with a fold along its middle.

    Args:
        material: Slot name.
        length: Length along its middle [m].
        width: Maximum width [m].
        at: Position of its base [m].
        yaw: Direction in the plan, from +z to +x [rad].
        rise: Angle above the horizon at its base [rad].
        droop: Angle by which it bends down towards its tip [rad].
        shape: Above 1 the maximum width is nearer to the tip, below 1 nearer to the base.
        pieces: Facets along its length.
    """
    pieces = max(2, limit_steps(pieces))  # one alone would have no width
    s = np.linspace(0, 1, pieces + 1)
    pitch = rise - droop * (s[:-1] + s[1:]) / 2
    out = np.concatenate([[0], np.cumsum(np.cos(pitch))]) * length / pieces
    up = np.concatenate([[0], np.cumsum(np.sin(pitch))]) * length / pieces
    half = width / 2 * np.sin(np.pi * np.clip(s**shape, 0, 1)) ** 0.8
    half[[0, -1]] = 0.0
    thick = 0.0012 + 0.02 * width * (half > 0)
    rows = [
        np.stack([k * half, up + lift, out], -1) for k, lift in ((-1, 0 * s), (1, 0 * s), (0, -thick), (0, -2 * thick))
    ]
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    vertices = np.concatenate(rows) @ turn.T + np.asarray(at)
    return _leaf(material, vertices, pieces + 1)


def _leaf(material: str, vertices: Float[np.ndarray, "v 3"], count: int) -> Solid:
    """Return the leaf of `count` points each on left rim, right rim, upper and lower middle, which meet at the tips."""
    left, right, top, under = (np.arange(count) + k * count for k in range(4))
    left, right, under = (np.concatenate([top[:1], row[1:-1], top[-1:]]) for row in (left, right, under))
    strips = []
    for a, b in ((left, top), (top, right), (right, under), (under, left)):
        strips += [np.stack([a[:-1], a[1:], b[:-1]], -1), np.stack([b[:-1], a[1:], b[1:]], -1)]
    return weld(material, vertices, np.concatenate(strips))
