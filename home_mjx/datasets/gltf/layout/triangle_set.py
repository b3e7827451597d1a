"""Triangles of a scene's architecture, in metres and Y up, with operations that keep materials and texture places."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.datasets.gltf.decode.scene import PlacedMesh
from home_mjx.geometry.slabs import PlanPolygon, fan_triangles, keep_triangles, remove_triangles
from home_mjx.schema.house import Material, Mesh

MIN_RELATIVE_AREA = 1e-12  # minimum area of triangles that are cut, over the square of their largest coordinate
MAX_UNCUT_EDGE = 0.3  # [m], triangles with a smaller extent belong to the outline around their centroid as a whole


@dataclass(frozen=True)
class TriangleSet:
    """Triangles with material slots.

    Attributes:
        corners: Corners [m], Y up, counter-clockwise seen from the front.
        uv: Texture coordinates of the corners.
        slot: Index into `materials`.
        materials: Material slots.
    """

    corners: Float[np.ndarray, "t 3 3"]
    uv: Float[np.ndarray, "t 3 2"]
    slot: Int[np.ndarray, " t"]
    materials: tuple[Material, ...]

    def __len__(self) -> int:
        """Return the number of triangles."""
        return len(self.corners)

    def __getitem__(self, rows: np.ndarray) -> "TriangleSet":
        """Return the triangles of a mask or of row numbers."""
        return TriangleSet(self.corners[rows], self.uv[rows], self.slot[rows], self.materials)

    @cached_property
    def doubled_normal(self) -> Float[np.ndarray, "t 3"]:
        """Normals whose lengths are twice the areas [m^2]."""
        a, b, c = self.corners.transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @cached_property
    def area(self) -> Float[np.ndarray, " t"]:
        """Areas [m^2]."""
        return np.linalg.norm(self.doubled_normal, axis=1) / 2

    @cached_property
    def slope(self) -> Float[np.ndarray, " t"]:
        """Vertical component of the unit normals; 1: faces up, 0: upright or without area."""
        return self.doubled_normal[:, 1] / np.maximum(2 * self.area, 1e-300)

    @cached_property
    def middle(self) -> Float[np.ndarray, "t 3"]:
        """Centroids [m]."""
        return self.corners.mean(axis=1)

    @property
    def heights(self) -> Float[np.ndarray, "t 2"]:
        """Minimum and maximum height of each triangle [m]."""
        return np.stack([self.corners[..., 1].min(axis=1), self.corners[..., 1].max(axis=1)], axis=1)

    @property
    def extent(self) -> Float[np.ndarray, " t"]:
        """Largest extent of each triangle along an axis of the plan [m]."""
        return np.ptp(self.corners[..., [0, 2]], axis=1).max(axis=1, initial=0)

    def within(self, low: float, high: float) -> Bool[np.ndarray, " t"]:
        """Return a mask of the triangles that reach into a range of heights [m]."""
        return (self.heights[:, 1] > low) & (self.heights[:, 0] < high)

    def mesh(self, path: Path, part: Int[np.ndarray, " t"] | None = None) -> Mesh:
        """Return a mesh with only the slots that are used; `part` is the wall of each triangle."""
        used, slot = np.unique(self.slot, return_inverse=True)
        return Mesh(
            path=path,
            vertices=self.corners.reshape(-1, 3),
            faces=np.arange(3 * len(self)).reshape(-1, 3),
            uv=self.uv,
            slot=slot.reshape(-1),
            group=np.full(len(self), -1),
            materials=tuple(self.materials[i] for i in used),
            part=part,
        )


def concat_triangles(sets: Sequence[TriangleSet]) -> TriangleSet:
    """Concatenate sets of triangles with the same materials, at least one."""
    arrays = (np.concatenate([getattr(s, name) for s in sets]) for name in ("corners", "uv", "slot"))
    corners, uv, slot = arrays
    return TriangleSet(corners, uv, slot, sets[0].materials)


def collect_triangles(placed: Iterable[PlacedMesh]) -> TriangleSet:
    """Return the triangles of placed meshes in the house's frame; mirrored meshes are wound anew.

    Equal materials share a slot.
    """
    slots: dict[Material, int] = {}
    parts = [(np.zeros((0, 3, 3)), np.zeros((0, 3, 2)), np.zeros(0, int))]
    for item in placed:
        mesh, matrix = item.mesh, item.matrix
        corners = (mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3])[mesh.faces]
        order = [0, 2, 1] if np.linalg.det(matrix[:3, :3]) < 0 else [0, 1, 2]
        own = np.array([slots.setdefault(m, len(slots)) for m in mesh.materials])
        parts.append((corners[:, order], mesh.uv[:, order], own[mesh.slot]))
    corners, uv, slot = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return TriangleSet(corners, uv, slot, tuple(slots))


def halve_long_edges(triangles: TriangleSet, max_edge: float) -> TriangleSet:
    """Return triangles cut into four at the middles of their edges until no edge is longer than `max_edge` [m].

    The surface stays exactly the same, except for rounding.
    """
    done = []
    while len(triangles):
        edge = np.linalg.norm(triangles.corners - np.roll(triangles.corners, 1, axis=1), axis=2).max(axis=1)
        done.append(triangles[edge <= max_edge])
        triangles = _quarter(triangles[edge > max_edge])
    return concat_triangles(done) if done else triangles


def _quarter(triangles: TriangleSet) -> TriangleSet:
    """Return the four quarters of each triangle."""

    def cut(values: np.ndarray) -> np.ndarray:
        """Return the quarters of per-corner values."""
        a, b, c = values.transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        return np.concatenate([np.stack(q, axis=1) for q in quarters])

    return TriangleSet(cut(triangles.corners), cut(triangles.uv), np.tile(triangles.slot, 4), triangles.materials)


def split_by_outlines(
    triangles: TriangleSet, outlines: Sequence[Sequence[PlanPolygon]]
) -> tuple[list[TriangleSet], TriangleSet]:
    """Cut sloping or level triangles along outlines in the plan (x, z).

    Triangles with all corners in one piece of an outline, or smaller than `MAX_UNCUT_EDGE`, are not cut.

    Args:
        triangles: None is upright.
        outlines: Disjoint triangles (x, z) that fill each outline; earlier outlines have priority.

    Returns:
        The part of each outline, and the rest.
    """
    found = []
    for pieces in outlines:
        inside, triangles = _split(triangles, pieces)
        found.append(inside)
    return found, triangles


def _split(triangles: TriangleSet, pieces: Sequence[PlanPolygon]) -> tuple[TriangleSet, TriangleSet]:
    """Return the parts of triangles inside and outside one outline; slivers that cannot be cut are outside."""
    plan = triangles.corners[..., [0, 2]]
    low, high = (f([p for piece in pieces for p in piece], axis=0) for f in (np.min, np.max))
    near = np.flatnonzero(((plan.max(axis=1) > low) & (plan.min(axis=1) < high)).all(axis=1))
    small = triangles.extent[near] < MAX_UNCUT_EDGE
    tested = np.where(small[:, None, None], plan[near].mean(axis=1, keepdims=True), plan[near])
    within = np.any([_contains(piece, tested) for piece in pieces], axis=0)
    whole, cut = near[within], near[~within & ~small & ~_is_sliver(plan[near])].tolist()
    inside = [_cut(triangles, row, keep_triangles([plan[row]], pieces)) for row in cut]
    outside = [_cut(triangles, row, remove_triangles([plan[row]], pieces)) for row in cut]
    rest = np.setdiff1d(np.arange(len(triangles)), [*whole.tolist(), *cut])
    return concat_triangles([triangles[whole], *inside]), concat_triangles([triangles[rest], *outside])


def _is_sliver(plan: Float[np.ndarray, "t 3 2"]) -> Bool[np.ndarray, " t"]:
    """Return a mask of the plan triangles whose area is lost in the rounding of their coordinates."""
    (x0, z0), (x1, z1) = (np.moveaxis(plan[:, k] - plan[:, 0], -1, 0) for k in (1, 2))
    return np.asarray(abs(x0 * z1 - x1 * z0) <= MIN_RELATIVE_AREA * abs(plan).max(axis=(1, 2), initial=0) ** 2)


def _contains(piece: PlanPolygon, plan: Float[np.ndarray, "t 3 2"]) -> Bool[np.ndarray, " t"]:
    """Return a mask of the plan triangles whose corners are all in a convex polygon, of either winding."""
    way = np.roll(piece, -1, axis=0) - piece
    away = plan[:, :, None] - piece
    side = way[:, 0] * away[..., 1] - way[:, 1] * away[..., 0]
    return np.asarray((side >= -1e-9).all(axis=(1, 2)) | (side <= 1e-9).all(axis=(1, 2)))


def _cut(triangles: TriangleSet, row: int, pieces: Sequence[PlanPolygon]) -> TriangleSet:
    """Return plan pieces of one triangle as triangles in its plane."""
    corners, uv = triangles.corners[row][:, [0, 2, 1]], triangles.uv[row]
    fans = [fan_triangles(piece, corners, uv) for piece in pieces]
    if not fans:
        return triangles[np.zeros(0, int)]
    slot = np.full(sum(len(c) for c, _ in fans), triangles.slot[row])
    turned = np.concatenate([c for c, _ in fans])[..., [0, 2, 1]]
    return TriangleSet(turned, np.concatenate([u for _, u in fans]), slot, triangles.materials)
