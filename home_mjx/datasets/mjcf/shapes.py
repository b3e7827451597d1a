"""Triangles of MuJoCo's geoms in their own frames, Z up."""

import numpy as np

from home_mjx.datasets.mjcf.model import MjcfScene
from home_mjx.datasets.shapes import Triangles, capsule_triangles, cylinder_triangles, sphere_triangles
from home_mjx.geometry.meshes import box_triangles

PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 0, 2, 3, 4, 5, 6, 7  # `mujoco.mjtGeom`


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
        return cylinder_triangles(float(size[0]), float(size[1]))
    if kind == CAPSULE:
        return capsule_triangles(float(size[0]), float(size[1]))
    if kind == SPHERE:
        return sphere_triangles(float(size[0]))
    return sphere_triangles(float(size.max())) / size.max() * size if kind == ELLIPSOID else np.zeros((0, 3, 3))


def mesh_triangles(scene: MjcfScene, mesh: int) -> Triangles:
    """Return the triangles of a mesh asset [m], in the centred frame that MuJoCo gives it."""
    model = scene.model
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    faces = model.mesh_face[first : first + count]
    return model.mesh_vert[model.mesh_vertadr[mesh] + faces].astype(float)
