"""Triangles of MuJoCo's geoms in their own frames, Z up."""

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.mjcf.model import MjcfScene
from home_mjx.geometry.meshes import box_triangles

MAX_SAGITTA = 1e-4  # [m], maximum distance of a circle from the sides of its polygon
MIN_SIDES, MAX_SIDES = 12, 128  # number of sides of the polygon of a circle
PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 0, 2, 3, 4, 5, 6, 7  # `mujoco.mjtGeom`
Triangles = Float[np.ndarray, "t 3 3"]


def geom_triangles(scene: MjcfScene, geom: int, reach: float) -> Triangles:
    """Return the triangles of a geom in its frame [m], counter-clockwise outwards; none for unknown types.

    Circles become polygons of the same mean radius. An infinite plane becomes a square.

    Args:
        scene: The scene.
        geom: Index of the geom.
        reach: Half edge of an infinite plane [m].
    """
    kind, size = int(scene.model.geom_type[geom]), scene.model.geom_size[geom].astype(float)
    if kind == MESH:
        return mesh_triangles(scene, int(scene.model.geom_dataid[geom]))
    if kind == BOX:
        return box_triangles(np.zeros(3), size)
    if kind == PLANE:
        x, y = (value if value > 0 else reach for value in size[:2].tolist())
        return np.array([[[-x, -y, 0], [x, -y, 0], [x, y, 0]], [[-x, -y, 0], [x, y, 0], [-x, y, 0]]])
    if kind == CYLINDER:
        return _lathe(np.array([[0, -size[1]], [size[0], -size[1]], [size[0], size[1]], [0, size[1]]]))
    if kind == CAPSULE:
        return _lathe(_arc(size[0]) + np.repeat([[0, -size[1]], [0, size[1]]], len(_arc(size[0])) // 2, axis=0))
    if kind == SPHERE:
        return _lathe(_arc(size[0]))
    return _lathe(_arc(float(size.max()))) / size.max() * size if kind == ELLIPSOID else np.zeros((0, 3, 3))


def mesh_triangles(scene: MjcfScene, mesh: int) -> Triangles:
    """Return the triangles of a mesh asset [m], in the centred frame that MuJoCo gives it."""
    model = scene.model
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    faces = model.mesh_face[first : first + count]
    return model.mesh_vert[model.mesh_vertadr[mesh] + faces].astype(float)


def _sides(radius: float) -> int:
    """Return the even number of sides of the polygon of a circle."""
    angle = np.arccos(np.clip(1 - MAX_SAGITTA / max(radius, 1e-9), -1, 1))
    return 2 * int(np.clip(np.ceil(np.pi / max(angle, 1e-3)), MIN_SIDES, MAX_SIDES) / 2 + 0.5)


def _arc(radius: float) -> Float[np.ndarray, "n 2"]:
    """Return (radius, height) of an even number of points on a half circle, from below; the equator is twice there."""
    count = _sides(radius) // 4 + 1
    angle = np.linspace(-np.pi / 2, 0, count)
    angle = np.concatenate([angle, -angle[::-1]])
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _lathe(profile: Float[np.ndarray, "n 2"]) -> Triangles:
    """Return the surface of revolution about z of a profile of (radius, height), from below, without flat bands."""
    sides = _sides(float(profile[:, 0].max()))
    turn = 2 * np.pi * np.arange(sides + 1) / sides
    mean = 2 / (1 + np.cos(np.pi / sides))  # so that the polygon is as much outside of the circle as inside
    x, y = (mean * profile[:, :1] * f(turn) for f in (np.cos, np.sin))
    points = np.stack([x, y, np.broadcast_to(profile[:, 1:], x.shape)], axis=-1)
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    found = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    return found[np.linalg.norm(np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0]), axis=1) > 1e-14]
