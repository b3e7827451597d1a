"""Solids from an outline moved along a path, or extruded to a board."""

from collections.abc import Sequence
from functools import cache
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from home_procgen.primitives.detail import is_sharp, limit_sides, simplify_line, simplify_outline
from home_procgen.primitives.solids import Solid, Vector, make_solid
from home_procgen.shapes.curves import Points, loop

# Deviations of coarse shapes: of outlines and paths by their extent, of bars by their thickness.
OUTLINE_TOLERANCE, BAR_TOLERANCE = 0.03, 0.3
MIN_CHAMFER_HALF_WIDTH = 0.018  # [m], minimum half thickness of bars with chamfered edges


def triangulate(outline: Float[np.ndarray, "n 2"]) -> Int[np.ndarray, "_ 3"]:
    """Triangulate a simple polygon, of either winding, by ear clipping; return indices of its points.

    Example:
        >>> triangulate(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])).tolist()
        [[3, 0, 1], [1, 2, 3]]
    """
    return _ears(outline.tobytes(), str(outline.dtype))


@cache
def _ears(outline_bytes: bytes, dtype: str) -> Int[np.ndarray, "_ 3"]:
    """Return the read-only triangles of `triangulate`; cached, since sections of bars repeat thousands of times."""
    outline = np.frombuffer(outline_bytes, dtype).reshape(-1, 2)
    x, y = outline.T
    turn = 1.0 if (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0 else -1.0
    left, ears = list(range(len(outline))), []
    while len(left) > 3:
        k = next((k for k in range(len(left)) if _is_ear(outline, left, k, turn)), 0)
        ears.append((left[k - 1], left[k], left[(k + 1) % len(left)]))
        left.pop(k)
    triangles = np.array([*ears, tuple(left)])
    triangles.flags.writeable = False
    return triangles


def _is_ear(outline: np.ndarray, left: list[int], k: int, turn: float) -> bool:
    corners = outline[[left[k - 1], left[k], left[(k + 1) % len(left)]]]
    edges = np.roll(corners, -1, 0) - corners
    if turn * (edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]) <= 1e-12:
        return False
    others = outline[[i for i in left if i not in (left[k - 1], left[k], left[(k + 1) % len(left)])]]
    away = others[:, None] - corners
    side = turn * (edges[:, 0] * away[..., 1] - edges[:, 1] * away[..., 0])
    return not (side > -1e-12).all(1).any()


def prism(
    material: str,
    outline: Points,
    thickness: float,
    at: Vector = (0.0, 0.0, 0.0),
    plane: Literal["front", "side", "top"] = "front",
) -> Solid:
    """Return a board of any simple outline.

    Args:
        material: Slot name.
        outline: (x, y) for `front`, (z, y) for `side`, (x, z) for `top` [m].
        thickness: Extent across the outline, half to each side; for `top` upwards [m].
        at: Position of the outline's origin [m].
        plane: Direction that the outline faces.
    """
    flat = np.asarray(outline, float)
    flat = flat[np.linalg.norm(flat - np.roll(flat, 1, 0), axis=1) > 1e-6]
    flat = simplify_outline(flat, OUTLINE_TOLERANCE * np.ptp(flat, axis=0).max())
    count, cap = len(flat), triangulate(flat)
    lift = (0.0, thickness) if plane == "top" else (-thickness / 2, thickness / 2)
    columns = {"front": (0, 1, 2), "side": (2, 1, 0), "top": (0, 2, 1)}[plane]
    layers = np.concatenate([np.c_[flat, np.full(count, h)] for h in lift])
    i, j = np.arange(count), np.roll(np.arange(count), -1)
    sides = np.concatenate([np.stack([i, j, j + count], -1), np.stack([i, j + count, i + count], -1)])
    turn = _area(flat) > 0
    caps = [cap[:, ::-1], cap + count] if turn else [cap, cap[:, ::-1] + count]
    faces = np.concatenate([sides if turn else sides[:, ::-1], *caps])
    vertices = np.empty_like(layers)
    vertices[:, list(columns)] = layers
    return make_solid(material, vertices + np.asarray(at), faces)


def _area(outline: np.ndarray) -> float:
    x, y = outline.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def sweep(
    material: str,
    path: Points,
    section: Float[np.ndarray, "_ 2"],
    scale: float | Sequence[float] | np.ndarray = 1.0,
    up: Vector | None = None,
    closed: bool = False,
) -> Solid:
    """Sweep an outline along a path, perpendicular to it.

    Args:
        material: Slot name.
        path: Points in space [m].
        section: Outline, its first axis sideways and its second along `up` if possible [m].
        scale: Factor on the section, one value or one per point.
        up: Direction of the section's second axis at the path's start; None: up, or forward on a vertical path.
        closed: The path returns to its start.
    """
    p = np.asarray(path, float)
    if is_sharp(0.0):
        p, scale = _simplify_path(p, scale, float(np.ptp(section, axis=0).max()), closed)
    side, rise = _frames(p, up, closed)
    size = np.broadcast_to(np.asarray(scale, float).reshape(-1, 1, 1), (len(p), 1, 1))
    rings = p[:, None] + size * (section[:, :1] * side[:, None] + section[:, 1:] * rise[:, None])
    count, around = len(p), len(section)
    i = np.arange(around)
    first = np.arange(count if closed else count - 1)[:, None] * around
    a, b = first + i, first + (i + 1) % around
    c, d = (b + around) % (count * around), (a + around) % (count * around)
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    if not closed:
        cap = triangulate(section)
        cap = cap if _area(section) > 0 else cap[:, ::-1]
        ends = [cap[:, ::-1], cap + (count - 1) * around]
        faces = np.concatenate([faces if _area(section) > 0 else faces[:, ::-1], *ends])
    return make_solid(material, rings.reshape(-1, 3), faces)


def _simplify_path(
    p: np.ndarray, scale: float | Sequence[float] | np.ndarray, wide: float, closed: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return fewer points of a path, and their factors on a section that is `wide` [m]."""
    size = np.broadcast_to(np.asarray(scale, float).reshape(-1), len(p))
    tolerance = max(BAR_TOLERANCE * wide * float(size.max()), OUTLINE_TOLERANCE * float(np.ptp(p, axis=0).max()))
    kept = simplify_line(np.c_[p, wide * size / 2], tolerance)
    return (kept[:, :-1], kept[:, -1] * 2 / wide) if len(kept) > 2 or not closed else (p, size)


def _frames(p: np.ndarray, up: Vector | None, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return unit vectors across a path at its points, sideways and up, transported with minimal rotation."""
    before, after = (
        (np.roll(p, 1, 0), np.roll(p, -1, 0)) if closed else (p[[0, *range(len(p) - 1)]], p[[*range(1, len(p)), -1]])
    )
    tangent = after - before
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    hint = up or ((0.0, 0.0, 1.0) if abs(tangent[0, 1]) > 0.95 else (0.0, 1.0, 0.0))
    rise = np.empty_like(p)
    last = np.asarray(hint, float)
    for i, t in enumerate(tangent):
        across = last - (last @ t) * t
        if np.linalg.norm(across) < 1e-6:  # the path turns exactly into `last`
            across = -(last @ t) * tangent[i - 1]
        last = across / np.linalg.norm(across)
        rise[i] = last
    return np.cross(rise, tangent), rise


def tube(
    material: str,
    path: Points,
    radius: float | Sequence[float] | np.ndarray,
    sides: int = 8,
    closed: bool = False,
) -> Solid:
    """Return a round bar along a path; `radius` is one value or one per point [m]."""
    sides = limit_sides(sides, float(np.max(radius)))
    return sweep(material, path, loop(2.0, 2.0, sides), radius, closed=closed)


def rod(
    material: str, start: Vector, end: Vector, radius: float, end_radius: float | None = None, sides: int = 8
) -> Solid:
    """Return a straight round bar between two points, tapering to `end_radius` [m]; None: of constant `radius`."""
    return tube(material, [start, end], [radius, radius if end_radius is None else end_radius], sides)


def beam(material: str, start: Vector, end: Vector, width: float, height: float | None = None) -> Solid:
    """Return a straight bar, chamfered unless thin; `height` (None: `width`) is along up, or +z if vertical [m]."""
    w, h = width / 2, (width if height is None else height) / 2
    c = 0.12 * min(w, h) if min(w, h) > MIN_CHAMFER_HALF_WIDTH and not is_sharp(min(w, h)) else 0.0
    cut = [(-w, c - h), (c - w, -h), (w - c, -h), (w, c - h), (w, h - c), (w - c, h), (c - w, h), (-w, h - c)]
    plain = [(-w, -h), (w, -h), (w, h), (-w, h)]
    return sweep(material, [start, end], np.array(cut if c else plain))


def ring(material: str, radius: float, thickness: float, at: Vector, axis: int = 1, sides: int = 20) -> Solid:
    """Return a torus about a coordinate axis: `radius` of the centre line, `thickness` of the bar [m]."""
    flat = loop(2 * radius, 2 * radius, sides)
    path = np.zeros((sides, 3))
    path[:, [i for i in range(3) if i != axis]] = flat
    return tube(material, path + np.asarray(at), thickness / 2, 8, closed=True)


def band(material: str, path: Points, width: float, thickness: float, up: Vector | None = None) -> Solid:
    """Return a flat strip along a path, with `width` across it and `thickness` along `up` [m]."""
    w, h = width / 2, thickness / 2
    return sweep(material, path, np.array([[-w, -h], [w, -h], [w, h], [-w, h]]), up=up)
