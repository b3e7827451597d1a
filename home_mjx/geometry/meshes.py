"""Triangles: frames, boxes and library models."""

import hashlib

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.bvh import build_triangle_tree
from home_mjx.geometry.normals import crease_normals
from home_mjx.schema.compiled import Model
from home_mjx.schema.house import Mesh


def surface_areas(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, " t"]:
    """Return the areas of triangles [m^2]."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.linalg.norm(normal, axis=1) / 2


Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # rotation from file to world axes: (x, y, z) -> (x, -z, y)

# Corners of a cube by bits (x, y, z), and its faces as quads, counter-clockwise seen from outside.
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FACE_NORMALS = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]], float)


def to_z_up(points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 3"]:
    """Rotate points from the dataset's axes (Y up) to the world's (Z up), without the house's offset."""
    return points @ Z_UP.T


def triangles_z_up(mesh: Mesh) -> Float[np.ndarray, "f 3 3"]:
    """Return the triangles of a mesh, Z up [m]."""
    return to_z_up(mesh.vertices.astype(np.float64))[mesh.faces]


def box_triangles(center: Float[np.ndarray, "3"], half: Float[np.ndarray, "3"]) -> Float[np.ndarray, "12 3 3"]:
    """Return the surface of an axis-aligned box, two triangles per face in the order of `FACE_NORMALS`.

    Args:
        center: Centre [m].
        half: Half extents [m].
    """
    corners = center + _CORNERS * half
    return corners[_QUADS[:, [[0, 1, 2], [0, 2, 3]]]].reshape(12, 3, 3)


def bounds(points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "2 3"]:
    """Return the minimum and maximum corner of points."""
    flat = points.reshape(-1, 3)
    return np.stack([flat.min(axis=0), flat.max(axis=0)])


def transform(pose: Float[np.ndarray, "3 4"], points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 3"]:
    """Apply an affine map to points."""
    return points @ pose[:, :3].T + pose[:, 3]


def compose(outer: Float[np.ndarray, "3 4"], inner: Float[np.ndarray, "3 4"]) -> Float[np.ndarray, "3 4"]:
    """Return the affine map that applies `inner`, then `outer`."""
    linear = outer[:, :3] @ inner[:, :3]
    return np.concatenate([linear, transform(outer, inner[:, 3])[:, None]], axis=1)


def invert(pose: Float[np.ndarray, "*b 3 4"]) -> Float[np.ndarray, "*b 3 4"]:
    """Return the inverses of affine maps."""
    linear = np.linalg.inv(pose[..., :3])
    return np.concatenate([linear, -linear @ pose[..., 3:]], axis=-1)


def make_model(
    name: str,
    triangles: Float[np.ndarray, "t 3 3"],
    uv: Float[np.ndarray, "t 3 2"] | None = None,
    slot: Int[np.ndarray, " t"] | None = None,
    part: Int[np.ndarray, " t"] | None = None,
    normal: Float[np.ndarray, "t 3 3"] | None = None,
) -> Model:
    """Create a library model with its bounding volume hierarchy.

    Args:
        name: First part of its key; the rest is a digest of its content.
        triangles: Corners in the model's own frame, Z up [m], counter-clockwise outwards.
        uv: Texture coordinates per corner; 0 if None.
        slot: Material slot of each triangle; 0 if None.
        part: Semantic part of each triangle; 0 if None.
        normal: Unit normals of the corners; computed by `crease_normals` if None.
    """
    count = len(triangles)
    # Rounded before the tree is built, so that its boxes bound the same numbers as rays test.
    triangle = triangles.astype(np.float32)
    uv = np.zeros((count, 3, 2), np.float32) if uv is None else uv.astype(np.float32)
    slot = np.zeros(count, np.int32) if slot is None else slot.astype(np.int32)
    part = np.zeros(count, np.int32) if part is None else part.astype(np.int32)
    normal = (crease_normals(triangles) if normal is None else normal).astype(np.float32)
    tree, order = build_triangle_tree(triangle)
    digest = hashlib.sha256(b"".join(a.tobytes() for a in (triangle, uv, slot, part, normal))).hexdigest()[:16]
    return Model(
        key=f"{name}:{digest}",
        triangle=triangle[order],
        uv=uv[order],
        normal=normal[order],
        slot=slot[order],
        part=part[order],
        tree=tree,
        box=bounds(triangle),
    )


def tree_order(triangles: Float[np.ndarray, "t 3 3"]) -> Int[np.ndarray, " t"]:
    """Return the order in which `make_model` stores triangles: row i of the model is triangle `order[i]`."""
    return build_triangle_tree(triangles.astype(np.float32))[1]
