"""What tests of compiled houses ask of them, by means that share nothing with the compiler."""

import mujoco
import numpy as np
import trimesh
from scipy.spatial import cKDTree

from home_mjx.schema.categories import COARSE
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic


def name_of(compiled: CompiledHouse, i: int) -> str:
    """The model of an instance; a door's frame and leaves are `<model>/frame` and `<model>/leaf`."""
    return compiled.instances.model[i].partition(":")[0].partition("/")[0]


def object_instances(compiled: CompiledHouse) -> list[list[int]]:
    """The instances of each object, the architecture left out."""
    ids = compiled.instances.object_id
    return [np.flatnonzero(ids == i).tolist() for i in dict.fromkeys(ids[1:].tolist())]


def row_of(compiled: CompiledHouse, i: int) -> np.ndarray:
    return compiled.semantics[compiled.instances.semantic[i]]


def world_triangles(compiled: CompiledHouse, i: int) -> np.ndarray:
    pose, triangle = compiled.instances.pose[i], compiled.models[compiled.instances.model[i]].triangle.astype(float)
    return triangle @ pose[:, :3].T + pose[:, 3]


def crossed_partitions(compiled: CompiledHouse, start: np.ndarray, end: np.ndarray) -> list[int]:
    """Partitions of the walls that a segment meets, by brute force over all triangles of the architecture."""
    model = compiled.models[compiled.instances.model[ARCHITECTURE]]
    a, b, c = model.triangle.astype(float).transpose(1, 0, 2)
    way = end - start
    normal = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.einsum("td,td->t", normal, a - start) / (normal @ way)
        point = start + t[:, None] * way
        sides = [np.einsum("td,td->t", np.cross(q - p, point - p), normal) for p, q in ((a, b), (b, c), (c, a))]
    hit = np.all([s > 0 for s in sides], axis=0) & (t > 0) & (t < 1)
    return sorted(set(compiled.semantics[model.part[hit], Semantic.PARTITION].tolist()))


def obstacle_points(compiled: CompiledHouse, skip: tuple[str, ...]) -> np.ndarray:
    """Dense samples of everything that stands in an agent's way, in the plan."""
    points = []
    for i in range(len(compiled.instances.model)):
        category = COARSE[row_of(compiled, i)[Semantic.COARSE]]
        if compiled.instances.body[i] < 0 and (i == ARCHITECTURE or category not in skip):
            triangle = world_triangles(compiled, i)
            mesh = trimesh.Trimesh(triangle.reshape(-1, 3), np.arange(3 * len(triangle)).reshape(-1, 3), process=False)
            points.append(trimesh.sample.sample_surface(mesh, int(500 * mesh.area) + 500, seed=0)[0])
    points = np.concatenate(points)
    return points[(points[:, 2] > 0.05 + 0.04) & (points[:, 2] < 0.05 + 1.6)][:, :2]


def cell_points(compiled: CompiledHouse) -> np.ndarray:
    n = compiled.navigation
    _, rows, columns = np.indices(n.home_mask.shape)
    return np.stack([columns + 0.5, rows + 0.5], axis=-1) * n.cell + n.origin


def nearest(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    return cKDTree(points).query(targets)[0]


def mujoco_contacts(compiled: CompiledHouse) -> list[tuple]:
    """Names and distance of every pair of boxes that MuJoCo finds in contact."""
    spec = mujoco.MjSpec()
    fixed, moving, kind = compiled.colliders, compiled.bodies, mujoco.mjtGeom.mjGEOM_BOX
    for i in range(len(fixed.pos)):
        pose = {"pos": fixed.pos[i], "quat": fixed.quat[i]}
        spec.worldbody.add_geom(name=f"static{i}", type=kind, size=fixed.size[i], **pose)
    for i in range(len(moving.pos)):
        body = spec.worldbody.add_body(pos=moving.pos[i], quat=moving.quat[i])
        body.add_freejoint()
        body.add_geom(name=f"body{i}", type=kind, size=moving.size[i])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return [(model.geom(c.geom1).name, model.geom(c.geom2).name, c.dist) for c in data.contact]
