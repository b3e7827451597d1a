"""Walls as in SUNCG: two prisms, one towards the room and one behind it, with holes for doors and windows.

Dimensions are those of the program that wrote the dataset (SSTK's `makeWallWithHoles`), as fractions of the depth d.
Each prism is d/2 thick and extends 2d/5 beyond both ends of the wall, so that corners close. The outer prism overlaps
the inner one by d/19, so that their faces do not coincide.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int

WALL_DEPTH = 0.1  # [m], thickness of a wall
WALL_EXTRA_HEIGHT = 0.035  # [m], height of a wall above its nominal height
Hole = tuple[float, float, float, float]  # [m]: from, to along the wall; from, to above its base
# Lines of a grid over a wall's rectangle, along it and upwards [m], and a mask of its solid cells.
Panel = tuple[Float[np.ndarray, " n"], Float[np.ndarray, " m"], Bool[np.ndarray, "_ _"]]


@dataclass(frozen=True)
class WallSegment:
    """A straight wall; its interior side is along cross(end - start, +Y): to the right, seen from above."""

    start: Float[np.ndarray, "3"]  # [m], Y up, at the base of the centre line
    end: Float[np.ndarray, "3"]  # [m], at the height of the start
    height: float  # [m], nominal
    holes: tuple[Hole, ...] = ()
    depth: float = WALL_DEPTH  # [m]
    extra_height: float = WALL_EXTRA_HEIGHT  # [m]
    split_heights: tuple[float, ...] = ()  # [m], heights above its base at which faces are split

    @property
    def length(self) -> float:
        """Length of the centre line [m]."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True)
class WallPrism:
    """One layer of a wall: closed, outward-wound."""

    vertices: Float[np.ndarray, "v 3"]  # [m], Y up
    faces: Int[np.ndarray, "f 3"]
    uv: Float[np.ndarray, "f 3 2"]  # [m]; along the wall and upwards on large faces
    is_large_face: Bool[np.ndarray, " f"]  # True for faces of the two large sides, False for cut faces


def wall_prisms(wall: WallSegment) -> tuple[WallPrism, WallPrism]:
    """Build a wall's inner prism, on its interior side, and its outer one, Y up [m]; they overlap by depth / 19.

    Both extend beyond the wall's ends by 2/5 of its depth, and above its nominal height by `extra_height`.

    Args:
        wall: The wall; start and end must differ, or vertices are NaN. Holes that reach its ends, its base or its
            nominal height are open there. Holes that touch are merged, see `merge_holes`.

    Example:
        >>> inner, outer = wall_prisms(WallSegment(np.zeros(3), np.array([4.0, 0, 0]), 2.7))
        >>> inner.vertices.min(axis=0).round(3).tolist(), inner.vertices.max(axis=0).round(3).tolist()
        ([-0.04, 0.0, 0.0], [4.04, 2.735, 0.05])
        >>> outer.vertices[:, 2].min().round(4), outer.vertices[:, 2].max().round(4)
        (np.float64(-0.0447), np.float64(0.0053))
    """
    half, beyond = wall.depth / 2, 2 * wall.depth / 5
    panel = _panel(wall, beyond)
    return _prism(wall, panel, beyond, 0.0, half), _prism(wall, panel, beyond, wall.depth / 19 - half, half)


def _prism(wall: WallSegment, panel: Panel, beyond: float, low: float, thickness: float) -> WallPrism:
    """Extrude a panel along the wall's interior normal, from an offset of `low` from its line to `low + thickness` [m].

    The panel begins `beyond` before the wall's start [m]. A panel without solid cells gives a prism without faces.
    """
    points, faces, large = extrude_grid(*panel, (low, low + thickness))
    along = (wall.end - wall.start) / wall.length
    up = np.array([0.0, 1.0, 0.0])
    vertices = wall.start + (points[:, :1] - beyond) * along + points[:, 1:2] * up + points[:, 2:] * np.cross(along, up)
    uv = np.where(large[:, None, None], points[faces][..., :2], points[faces][..., [0, 2]])
    return WallPrism(vertices, faces, uv, large)


def _panel(wall: WallSegment, beyond: float) -> Panel:
    """Return grid lines along the prism and upwards [m], and the mask (along, up) of solid cells.

    Lines along begin at 0, `beyond` [m] before the wall's start, and end as far after its end. Lines upwards include
    `split_heights` and end at the prism's top. Holes are first merged, and opened at ends, base and top, see
    `merge_holes` and `_open`: cells outside the given holes may be empty, too.
    """
    width, top = wall.length + 2 * beyond, wall.height + wall.extra_height
    holes = np.array([_open(hole, wall, beyond, width, top) for hole in merge_holes(wall.holes)]).reshape(-1, 4)
    us = np.unique(np.clip([0.0, width, *holes[:, 0], *holes[:, 1]], 0, width))
    vs = np.unique(np.clip([0.0, top, *holes[:, 2], *holes[:, 3], *wall.split_heights], 0, top))
    u, v = np.meshgrid((us[1:] + us[:-1]) / 2, (vs[1:] + vs[:-1]) / 2, indexing="ij")
    keep = np.ones(u.shape, bool)
    for left, right, low, high in holes:
        keep &= ~((left < u) & (u < right) & (low < v) & (v < high))
    return us, vs, keep


def merge_holes(holes: Sequence[Hole]) -> list[Hole]:
    """Merge holes that touch or overlap into their bounding rectangle, until none touch; the input is not modified.

    Holes are (from, to along the wall, from, to above its base) [m]. A merged one may cover solid parts between its
    holes, and has the place of the last of them.

    Example:
        >>> merge_holes([(0, 1, 0, 1), (3, 4, 0, 1), (0.5, 2, 0.5, 2)])
        [(3, 4, 0, 1), (0, 2, 0, 2)]
    """
    merged: list[Hole] = []
    for hole in holes:
        while meeting := [other for other in merged if _meet(hole, other)]:
            left, right, low, high = zip(hole, *meeting, strict=True)
            hole = min(left), max(right), min(low), max(high)
            merged = [other for other in merged if other not in meeting]
        merged.append(hole)
    return merged


def _meet(a: Hole, b: Hole) -> bool:
    """Return whether two holes overlap or touch, also in a corner only."""
    return a[0] <= b[1] and b[0] <= a[1] and a[2] <= b[3] and b[2] <= a[3]


def _open(hole: Hole, wall: WallSegment, beyond: float, width: float, top: float) -> Hole:
    """Convert a hole to the prism's frame, which begins `beyond` before the wall's start; cut it at the base.

    Holes that reach an end or the nominal height of the wall reach the end (`width`) or the `top` of the prism [m].
    """
    left, right, low, high = hole
    return (
        0.0 if left <= 0 else left + beyond,
        width if right >= wall.length else right + beyond,
        max(low, 0.0),
        top if high >= wall.height else high,
    )


def extrude_grid(
    us: Float[np.ndarray, " n"],
    vs: Float[np.ndarray, " m"],
    keep: Bool[np.ndarray, "n1 m1"],
    depth: tuple[float, float],
) -> tuple[Float[np.ndarray, "p 3"], Int[np.ndarray, "f 3"], Bool[np.ndarray, " f"]]:
    """Extrude the kept cells of a rectangular grid: rectangles with rectangular holes, and rectilinear polygons.

    Faces are cut along all grid lines, which avoids T-junctions, so the solid is watertight. Cells that touch in a
    corner share an edge of four faces.

    Args:
        us: Grid lines along u, ascending, without repetition.
        vs: Grid lines along v, ascending, without repetition.
        keep: Mask of solid cells; row = u, column = v.
        depth: Low and high end along w, where (u, v, w) is right-handed.

    Returns:
        Corners (u, v, w) in the unit of the lines, outward triangles, and the mask of triangles on large faces. Large
        faces are at both ends of w, the others are cut faces. All results are empty if no cell is solid.
    """
    used, faces, large = _topology(keep.shape, keep.tobytes())
    grid = np.stack(np.meshgrid(us, vs, indexing="ij"), -1).reshape(-1, 2)
    points = np.concatenate([np.c_[grid, np.full(len(grid), w)] for w in depth])
    return points[used], faces.copy(), large.copy()


@lru_cache(maxsize=1024)  # most walls with openings differ only in lengths
def _topology(
    shape: tuple[int, int], kept: bytes
) -> tuple[Int[np.ndarray, " p"], Int[np.ndarray, "f 3"], Bool[np.ndarray, " f"]]:
    """Return the topology of `extrude_grid` for a mask in bytes: nodes, triangles, and mask of large faces.

    Nodes are numbered in C order, first those at the low end of w, then those at the high end. Triangles index the used
    ones, which are returned. Results are cached; callers must copy before they modify them.
    """
    keep = np.frombuffer(kept, bool).reshape(shape)
    node = np.arange((shape[0] + 1) * (shape[1] + 1)).reshape(shape[0] + 1, shape[1] + 1)
    corner = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], -1)  # counter-clockwise from +w
    padded = np.pad(keep, 1)
    beside = np.stack([padded[1:-1, :-2], padded[2:, 1:-1], padded[1:-1, 2:], padded[:-2, 1:-1]], -1)
    bare = keep[..., None] & ~beside
    back, front = corner[keep], corner[keep] + node.size
    edge = np.stack([corner, np.roll(corner, -1, -1)], -1)[bare]
    sides = np.concatenate([edge, edge[:, ::-1] + node.size], -1)
    quads = np.concatenate([front, back[:, ::-1], sides])
    faces = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    used, faces = np.unique(faces, return_inverse=True)
    large = np.arange(len(quads)) < 2 * len(front)
    return used, faces.reshape(-1, 3), np.repeat(large, 2)
