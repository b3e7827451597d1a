"""Triangles of MuJoCo's geoms in their own frames, Z up."""

import numpy as np

from home_mjx.datasets.mjcf.model import HEIGHTS, MjcfScene
from home_mjx.datasets.shapes import (
    Triangles,
    capsule_triangles,
    cylinder_triangles,
    grid_triangles,
    sphere_triangles,
)
from home_mjx.geometry.meshes import box_triangles

PLANE, _, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = range(8)  # `mujoco.mjtGeom`


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
    if kind == HEIGHTS:
        return height_triangles(scene, int(scene.model.geom_dataid[geom]))
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


def height_triangles(scene: MjcfScene, field: int) -> Triangles:
    """Return the triangles of a height field [m]: its surface, two for each cell, its sides and its base."""
    model = scene.model
    rows, columns, first = (int(a[field]) for a in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
    x, y, top, base = model.hfield_size[field].astype(float).tolist()
    heights = model.hfield_data[first : first + rows * columns].reshape(rows, columns) * top
    plan = np.stack(np.meshgrid(np.linspace(-x, x, columns), np.linspace(-y, y, rows)), axis=-1)
    upper = np.concatenate([plan, heights[..., None]], axis=-1)
    lower = np.concatenate([plan, np.full((rows, columns, 1), -base)], axis=-1)
    rims = [
        np.stack([lower[rim], upper[rim]])
        for rim in (np.s_[0, :], np.s_[:, -1], np.s_[-1, ::-1], np.s_[::-1, 0])  # counter-clockwise from above
    ]
    corners = lower[[0, 0, -1, -1], [0, -1, 0, -1]].reshape(2, 2, 3)
    return np.concatenate([grid_triangles(upper), *map(grid_triangles, rims), grid_triangles(corners)[:, ::-1]])
