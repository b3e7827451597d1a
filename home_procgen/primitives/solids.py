"""Closed solids with outward faces and UVs in metres, for walls and furniture."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

from home_mjx.geometry.wall_prisms import extrude_grid
from home_mjx.schema.house import JointKind, Material, Mesh
from home_procgen.primitives.detail import is_sharp, limit_sides, simplify_outline
from home_procgen.primitives.grid import round_shape

Vector = tuple[float, float, float]
PROFILE_TOLERANCE = 0.08  # of the radius, by which profiles are simplified where shapes are coarse
TIE_TOLERANCE = 1e-6  # of normals, and [m] of extents, below which their difference is rounding


@dataclass(frozen=True)
class MovablePart:
    """A drawer, a door or a lid; solids with equal parts move together.

    Args:
        name: Name without a number.
        kind: Kind of joint.
        axis: Unit vector: of rotation by the right-hand rule, or of translation.
        point: Point on a hinge's axis, or corner of a slide, which distinguishes equal drawers [m].
        travel: Range from the drawn position [rad] or [m].
    """

    name: str
    kind: JointKind
    axis: Vector
    point: Vector
    travel: float

    def transform(self, turn: Float[np.ndarray, "3 3"], shift: Float[np.ndarray, " 3"]) -> "MovablePart":
        """Return the part of solids that were rotated or mirrored about the origin, and then moved.

        Args:
            turn: An orthogonal matrix.
            shift: Translation [m].
        """
        sense = np.sign(np.linalg.det(turn)) if self.kind == "hinge" else 1.0  # a mirror reverses the sense of rotation
        return replace(self, axis=_triple(sense * turn @ self.axis), point=_triple(turn @ self.point + shift))


def _triple(values: Float[np.ndarray, " 3"]) -> Vector:
    x, y, z = round_shape(values).tolist()
    return x, y, z


@dataclass(frozen=True)
class Solid:
    """A closed, outward-wound piece of a mesh, with one material or one per face."""

    vertices: Float[np.ndarray, "v 3"]  # [m], Y up
    faces: Int[np.ndarray, "f 3"]
    uv: Float[np.ndarray, "f 3 2"]  # [m] per corner
    material: str | tuple[int, ...]  # slot name, or slot number per face
    group: str | None = None  # name of the `o` line
    part: MovablePart | None = None  # its movable part; None if it is fixed

    @property
    def box(self) -> Float[np.ndarray, "2 3"]:
        """Lower and upper corner of the bounding box [m]."""
        return np.stack([self.vertices.min(0), self.vertices.max(0)])


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Compute `np.cross` of rows of three, without its costly shape checks."""
    (x, y, z), (u, v, w) = a.T, b.T
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u]).T


def project_uv(vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Float[np.ndarray, "f 3 2"]:
    """Return UVs in metres from the projection of each face along its dominant axis, u along the longer extent.

    Wood grain runs along u. Ties go to the first axis, so that the faces of a diagonal board are projected alike.
    """
    corners = vertices[faces]
    normal = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.abs(normal)
    axis = (size >= (1 - TIE_TOLERANCE) * size.max(axis=-1, keepdims=True)).argmax(-1)
    extent = (vertices.max(0) - vertices.min(0)).tolist()
    planes = ((2, 1), (0, 2), (0, 1))
    columns = np.array([(a, b) if extent[a] >= extent[b] - TIE_TOLERANCE else (b, a) for a, b in planes])[axis]
    return np.take_along_axis(corners, columns[:, None, :], -1)


def picture_uv(piece: Solid) -> Solid:
    """Return a solid whose UVs are x and y over its box, 0..1, so that front and back show the texture once."""
    low, high = piece.box[:, :2]
    return replace(piece, uv=(piece.vertices[piece.faces][..., :2] - low) / (high - low))


def make_solid(material: str, vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Solid:
    """Return a solid with rounded vertices and projected UVs; faces are reversed if they point inwards."""
    vertices = round_shape(vertices)
    corners = vertices[faces] - vertices.mean(0)
    if np.einsum("fi,fi->", corners[:, 0], _cross(corners[:, 1], corners[:, 2])) < 0:
        faces = faces[:, ::-1]
    return Solid(vertices, faces, project_uv(vertices, faces), material)


def cushion(material: str, size: Vector, at: Vector = (0.0, 0.0, 0.0), bevel: float = 0.03) -> Solid:
    """Return a box with bevelled edges.

    Args:
        material: Slot name.
        size: Extents along x, y, z [m].
        at: Centre of the bottom face [m].
        bevel: Width of the cut edges [m].
    """
    if is_sharp(bevel):
        return box(material, size, at)
    half = np.asarray(size) / 2
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    insets = bevel * (1 - np.eye(3))
    vertices = (signs[:, None] * (half - insets)).reshape(-1, 3)
    hull = ConvexHull(vertices)
    outward = np.einsum("fi,fi->f", hull.equations[:, :3], _normals(vertices[hull.simplices])) > 0
    faces = np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1]).astype(np.int64)
    return make_solid(material, vertices + np.asarray(at) + (0, half[1], 0), faces)


def box(material: str, size: Vector, at: Vector = (0.0, 0.0, 0.0)) -> Solid:
    """Return a box of extents `size` along x, y, z [m]; `at` is the centre of its bottom face [m].

    Example:
        >>> box("wood", (1, 0.5, 2)).box.tolist()
        [[-0.5, 0.0, -1.0], [0.5, 0.5, 1.0]]
    """
    low, high = np.array([-0.5, 0.0, -0.5]), np.array([0.5, 1.0, 0.5])
    ends = np.stack([low, high]) * size + at
    points, faces = extrude_grid(ends[:, 2], ends[:, 0], np.ones((1, 1), bool), (ends[0, 1], ends[1, 1]))[:2]
    return make_solid(material, points[:, [1, 2, 0]], faces)


def lathe(
    material: str,
    profile: Sequence[tuple[float, float]],
    at: Vector = (0.0, 0.0, 0.0),
    sides: int = 16,
    closed: bool = False,
    stretch: float = 1.0,
) -> Solid:
    """Return a solid of revolution about the vertical axis.

    Args:
        material: Slot name.
        profile: Points (radius, height) [m] from the bottom up; an end off the axis is capped.
        at: Point of the axis at height 0 [m].
        sides: Number of facets.
        closed: The profile is a loop, as of a hollow lampshade, and gets no caps.
        stretch: Factor on z, for oval bowls.
    """
    if not closed:
        profile = [(0.0, profile[0][1]), *(p for p in profile if p[0] > 0), (0.0, profile[-1][1])]
    radius = max(r for r, _ in profile)
    profile = simplify_outline(np.asarray(profile, float), PROFILE_TOLERANCE * radius).tolist()
    sides = limit_sides(sides, radius)
    angle = 2 * np.pi * np.arange(sides) / sides
    rings = [
        np.stack([r * np.cos(angle), np.full(sides, h), stretch * r * np.sin(angle)], -1)[: sides if r > 0 else 1]
        for r, h in profile
    ]
    start = np.cumsum([0] + [len(ring) for ring in rings]).tolist()
    pairs = [(i, (i + 1) % len(rings)) for i in range(len(rings) - (not closed))]
    faces = [_band(start[i], len(rings[i]), start[j], len(rings[j]), sides) for i, j in pairs]
    return make_solid(material, np.concatenate(rings) + np.asarray(at), np.concatenate(faces))


def cylinder(
    material: str, radius: float, height: float, at: Vector = (0.0, 0.0, 0.0), top: float | None = None, sides: int = 16
) -> Solid:
    """Return an upright cylinder on `at`, or a cone's frustum with radius `top` at its upper end [m]."""
    return lathe(material, [(radius, 0.0), (radius if top is None else top, height)], at, sides)


def _band(low: int, low_size: int, high: int, high_size: int, sides: int) -> Int[np.ndarray, "f 3"]:
    """Return triangles between two rings of vertices, given by first index and size (`sides`, or 1 for a tip)."""
    j = np.arange(sides)
    a, b = low + j % low_size, low + (j + 1) % low_size
    c, d = high + (j + 1) % high_size, high + j % high_size
    lower, upper = np.stack([a, c, b], -1), np.stack([a, d, c], -1)
    return np.concatenate(([lower] if low_size > 1 else []) + ([upper] if high_size > 1 else []))


def _normals(corners: Float[np.ndarray, "f 3 3"]) -> Float[np.ndarray, "f 3"]:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def move(piece: Solid, by: Vector | Float[np.ndarray, " 3"]) -> Solid:
    """Translate a solid, and the joint of its part, by a vector [m]; its UVs are unchanged."""
    part = piece.part and piece.part.transform(np.eye(3), np.asarray(by, float))
    return replace(piece, vertices=piece.vertices + np.asarray(by), part=part)


def rotate(piece: Solid, axis: int, angle: float, pivot: Vector = (0.0, 0.0, 0.0)) -> Solid:
    """Rotate a solid and its part, not its UVs, about axis 0, 1 or 2 (x, y, z) through `pivot`, right-handed [rad]."""
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[[i, i, j, j], [i, j, i, j]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    part = piece.part and piece.part.transform(turn, np.asarray(pivot) - turn @ np.asarray(pivot))
    return replace(piece, vertices=round_shape((piece.vertices - pivot) @ turn.T + np.asarray(pivot)), part=part)


def to_mesh(path: Path, pieces: Sequence[Solid], slots: Sequence[str], materials: tuple[Material, ...]) -> Mesh:
    """Join solids into one mesh; vertices are not merged, so every solid remains closed.

    Args:
        path: Path of the OBJ file, relative to the dataset root.
        pieces: The solids.
        slots: Names of the material slots in order, for solids with a slot name.
        materials: One per slot.
    """
    first = np.cumsum([0] + [len(p.vertices) for p in pieces])
    groups = tuple(dict.fromkeys(p.group for p in pieces if p.group is not None))
    slot = [
        np.full(len(p.faces), slots.index(p.material)) if isinstance(p.material, str) else np.array(p.material)
        for p in pieces
    ]
    group = [np.full(len(p.faces), groups.index(p.group) if p.group is not None else -1) for p in pieces]
    return Mesh(
        path=path,
        vertices=np.round(np.concatenate([p.vertices for p in pieces]), 6) + 0.0,
        faces=np.concatenate([p.faces + start for p, start in zip(pieces, first, strict=False)]),
        uv=np.round(np.concatenate([p.uv for p in pieces]), 6) + 0.0,
        slot=np.concatenate(slot),
        group=np.concatenate(group),
        materials=materials,
        groups=groups,
    )
