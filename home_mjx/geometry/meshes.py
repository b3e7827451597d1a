"""Triangles: frames, boxes, vertex normals, library models, and the tree over a house's static instances."""

import hashlib
from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.cells import unique_cells
from home_mjx.schema.compiled import BVH, Instances, Model
from home_mjx.schema.house import Mesh

Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # rotation from file to world axes: (x, y, z) -> (x, -z, y)
# Corners of a cube by bits (x, y, z), and its faces as quads, counter-clockwise seen from outside.
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FACE_NORMALS = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]], float)
MIN_CREASE_COSINE = np.cos(np.deg2rad(40.0))  # cosine of the crease angle; sharper edges are not smoothed
WELD_DISTANCE = 1e-4  # [m], corners in the same grid cell of this size are merged
MAX_PAIRS = 1 << 20  # number of pairs of faces that are compared at a time
MAX_CORNER_FACES = 64  # maximum faces around a smoothed corner; more indicate foliage, not a surface
INSTANCE_BOX_MARGIN = 1e-4  # [m], margin of boxes; rays intersect instances in local frames, with other rounding errors


def surface_areas(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, " t"]:
    """Return the areas of triangles [m^2], at least 0 whatever the winding."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.linalg.norm(normal, axis=1) / 2


def to_z_up(points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 3"]:
    """Rotate points from the file's axes (Y up) to the world's (Z up): (x, y, z) to (x, -z, y), without any offset."""
    turned = np.empty(points.shape, np.result_type(points, np.float64))
    for axis, (source, sign) in enumerate(((0, 1), (2, -1), (1, 1))):
        np.multiply(points[..., source], sign, out=turned[..., axis])
    turned += 0.0  # zeros are positive, as of a product of matrices
    return turned


def triangles_z_up(mesh: Mesh) -> Float[np.ndarray, "f 3 3"]:
    """Return the corners of a Y-up mesh's faces in float64, rotated Z up by `to_z_up` [m]."""
    return to_z_up(mesh.vertices.astype(np.float64))[mesh.faces]


def box_triangles(center: Float[np.ndarray, "3"], half: Float[np.ndarray, "3"]) -> Float[np.ndarray, "12 3 3"]:
    """Return the outward-wound surface of an axis-aligned box of half extents `half` [m].

    Triangles 2 i and 2 i + 1 are the face of row i of `FACE_NORMALS`.
    """
    corners = center + _CORNERS * half
    return corners[_QUADS[:, [[0, 1, 2], [0, 2, 3]]]].reshape(12, 3, 3)


def bounds(points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "2 3"]:
    """Return the minimum and maximum corner, as rows, of at least one point, over all leading axes."""
    columns = np.ascontiguousarray(points.reshape(-1, 3).T)  # NumPy reduces long rows ten times as fast
    return np.stack([columns.min(axis=1), columns.max(axis=1)])


def min_thickness(points: Float[np.ndarray, "*b 3"]) -> float:
    """Return the smallest extent of points [m] along the axes and along their principal axes.

    It is 0 for a flat set, up to rounding errors, and may exceed the true minimum width. There must be a point.

    It is at least the width of the set, since other directions are not tried. There must be a point.

    Example:
        >>> sheet = np.array([[0.0, 0, 0], [1, 1, 0], [0, 0, 2], [1, 1, 2]])
        >>> round(min_thickness(sheet), 9)
        0.0
    """
    flat = points.reshape(-1, 3)
    away = flat - flat.mean(axis=0)
    principal = away @ np.linalg.eigh(away.T @ away)[1]
    return float(min(np.ptp(flat, axis=0).min(), np.ptp(principal, axis=0).min()))


def transform(pose: Float[np.ndarray, "3 4"], points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 3"]:
    """Apply an affine map, a 3 x 3 linear part for column vectors and a translation as last column, to points."""
    return points @ pose[:, :3].T + pose[:, 3]


def compose(outer: Float[np.ndarray, "3 4"], inner: Float[np.ndarray, "3 4"]) -> Float[np.ndarray, "3 4"]:
    """Return the affine map that applies `inner`, then `outer`."""
    linear = outer[:, :3] @ inner[:, :3]
    return np.concatenate([linear, transform(outer, inner[:, 3])[:, None]], axis=1)


def invert(pose: Float[np.ndarray, "*b 3 4"]) -> Float[np.ndarray, "*b 3 4"]:
    """Return the inverses of affine maps, rigid or not; raise `LinAlgError` if any linear part is singular."""
    linear = np.linalg.inv(pose[..., :3])
    return np.concatenate([linear, -linear @ pose[..., 3:]], axis=-1)


def make_model(
    name: str,
    triangles: Float[np.ndarray, "t 3 3"],
    uv: Float[np.ndarray, "t 3 2"] | None = None,
    slot: Int[np.ndarray, " t"] | None = None,
    part: Int[np.ndarray, " t"] | None = None,
    normal: Float[np.ndarray, "t 3 3"] | None = None,
    find: Callable[[str], Model | None] = lambda key: None,
) -> Model:
    """Create a library model with its BVH; its triangles are reordered, see `tree_order`.

    Args:
        name: First part of its key; the rest is a digest of its content.
        triangles: Corners in the model's own frame, Z up [m], counter-clockwise outwards; at least one triangle.
        uv: Texture coordinates per corner; 0 if None.
        slot: Material slot of each triangle; 0 if None.
        part: Semantic part of each triangle; 0 if None.
        normal: Unit normals of the corners; computed by `crease_normals` if None.
        find: Looks up a model by key; if it returns one, no tree is built and that model is the result.

    Raises:
        DatasetError: A corner is not finite. Triangles without area are kept.
    """
    count = len(triangles)
    # Rounded before the tree is built, so that its boxes bound the same numbers as rays test.
    triangle = triangles.astype(np.float32)
    uv = np.zeros((count, 3, 2), np.float32) if uv is None else uv.astype(np.float32)
    slot = np.zeros(count, np.int32) if slot is None else slot.astype(np.int32)
    part = np.zeros(count, np.int32) if part is None else part.astype(np.int32)
    normal = (crease_normals(triangles) if normal is None else normal).astype(np.float32)
    digest = hashlib.sha256(b"".join(a.tobytes() for a in (triangle, uv, slot, part, normal))).hexdigest()[:16]
    key = f"{name}:{digest}"
    found = find(key)
    if found is not None:
        return found
    tree, order = _triangle_tree(triangle)
    return Model(
        key=key,
        triangle=triangle[order],
        uv=uv[order],
        normal=normal[order],
        slot=slot[order],
        part=part[order],
        tree=tree,
        box=bounds(triangle),
    )


def tree_order(triangles: Float[np.ndarray, "t 3 3"]) -> Int[np.ndarray, " t"]:
    """Return the order in which `make_model` stores triangles: row i of the model is triangle `order[i]`.

    Pass the triangles as they are passed to `make_model`: another frame or order may have another tree.
    """
    return _triangle_tree(triangles.astype(np.float32))[1]


def _triangle_tree(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[BVH, Int[np.ndarray, " t"]]:
    """Return `build_triangle_tree` of triangles."""
    from home_mjx.geometry.bvh import build_triangle_tree  # loads Numba, which readers of models do not need

    return build_triangle_tree(triangles)


def crease_normals(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "t 3 3"]:
    """Compute unit normals of outward-wound triangles' corners; edges sharper than the crease angle are not smoothed.

    A corner's normal is the area-weighted mean over the faces at its position that differ from its own by less than
    the crease angle (`MIN_CREASE_COSINE`). A face without area has zero normals. Corners at positions with more than
    `MAX_CORNER_FACES` corners have the normals of their faces.

    Example:
        >>> flat = crease_normals(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
        >>> flat[0, 0].tolist()
        [0.0, 0.0, 1.0]
    """
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(area, axis=1, keepdims=True)
    flat = np.divide(area, length, out=np.zeros_like(area), where=length > 0)
    corner, other = _neighbours(triangles)
    joined = _are_smooth(flat, corner // 3, other)
    total = np.zeros((len(triangles) * 3, 3))
    for axis in range(3):
        total[:, axis] = np.bincount(corner[joined], area[other[joined], axis], len(total))
    size = np.linalg.norm(total, axis=1, keepdims=True)
    smooth = np.divide(total, size, out=np.repeat(flat, 3, axis=0), where=size > 1e-12)
    return smooth.reshape(-1, 3, 3)


def _are_smooth(
    normal: Float[np.ndarray, "t 3"], face: Int[np.ndarray, " n"], other: Int[np.ndarray, " n"]
) -> Bool[np.ndarray, " n"]:
    """Return whether pairs of faces differ by less than the crease angle; some pairs at a time, to save memory."""
    found = np.zeros(len(face), bool)
    for start in range(0, len(face), MAX_PAIRS):
        rows = slice(start, start + MAX_PAIRS)
        found[rows] = np.einsum("ni,ni->n", normal[face[rows]], normal[other[rows]]) > MIN_CREASE_COSINE
    return found


def _neighbours(triangles: Float[np.ndarray, "t 3 3"]) -> tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]:
    """Return pairs of a corner (face * 3 + k) and a face with a corner at the same position, its own face included.

    Corners in one grid cell of `WELD_DISTANCE` have the same position. Those at a position with more than
    `MAX_CORNER_FACES` corners are not returned.
    """
    places = np.round(triangles.reshape(-1, 3) / WELD_DISTANCE).astype(np.int64)
    place = unique_cells(places)[1]
    order = np.argsort(place, kind="stable")
    count = np.bincount(place)
    start = np.cumsum(count) - count
    mine = np.where(count[place] <= MAX_CORNER_FACES, count[place], 0)
    corner = np.repeat(np.arange(len(place)), mine)
    step = np.arange(len(corner)) - np.repeat(np.cumsum(mine) - mine, mine)
    return corner, order[start[place[corner]] + step] // 3


def facing_axis(normal: Float[np.ndarray, "t 2"], area: Float[np.ndarray, " t"]) -> Float[np.ndarray, "2"]:
    """Return the first principal axis of a wall's area-weighted normals: a horizontal unit vector of either sign.

    It is across the wall, not along it. If there is no area, or no direction dominates, it is any unit vector.

    Args:
        normal: Horizontal components of each triangle's normal, scaled by its area [m^2]: x and y, or x and z.
        area: Area of each triangle [m^2].
    """
    flat = normal / np.sqrt(np.maximum(area, 1e-12))[:, None]
    return np.linalg.eigh(flat.T @ flat)[1][:, -1]


def build_instance_tree(
    instances: Instances, models: Mapping[str, Model], doors: Int[np.ndarray, " h"] | None = None
) -> BVH:
    """Build a BVH over static instances, one per leaf, whose codes have instance indices; boxes get a small margin.

    Args:
        instances: Instances of a house; movable bodies are omitted. At least one must remain.
        models: Models by key.
        doors: Instances of door leaves, which are omitted as well; None without doors.
    """
    from home_mjx.geometry.bvh import build_tree  # loads Numba, as above

    static = np.setdiff1d(np.flatnonzero(instances.body < 0), [] if doors is None else doors)
    boxes = np.array([instance_box(instances.pose[i], models[instances.model[i]].box) for i in static])
    tree, order = build_tree(boxes + np.array([[-INSTANCE_BOX_MARGIN], [INSTANCE_BOX_MARGIN]]), leaf_size=1)
    leaf = (tree.child < 0) & (tree.child != -1)
    first = np.where(leaf, ~tree.child >> 4, 0)
    return BVH(tree.box, np.where(leaf, ~(static[order[first]] << 4 | 1), tree.child).astype(np.int32))


def instance_box(pose: Float[np.ndarray, "3 4"], box: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "2 3"]:
    """Return the axis-aligned world bounds (min, max) [m] of a model's box, which has the affine pose `pose`.

    For a rotated model they may be larger than those of its triangles.
    """
    corners = np.stack(np.meshgrid(*box.astype(np.float64).T), axis=-1).reshape(-1, 3)
    return bounds(transform(pose, corners))
