"""Rays from inside a closed mesh never get out, least of all through its edges and corners."""

import numpy as np
import pytest
import trimesh
from soup import BACKENDS, Placed, Soup, f32, in_jit, random_pose

from home_mjx.raycast_render.casting.cast import cast

N = 9000  # more than the `xla` backend takes at once, and no multiple of it


def closed_mesh():
    """A convex ball of uneven triangles: from inside every point of it is in sight, and no edge is a silhouette."""
    points = np.random.default_rng(2).normal(size=(600, 3))
    return trimesh.PointCloud(points / np.linalg.norm(points, axis=1, keepdims=True)).convex_hull


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("kind", ["still", "turned", "mirrored", "stretched", "moving"])
def test_rays_at_edges_and_corners_do_not_escape(backend, kind):
    rng = np.random.default_rng(7)
    mesh = closed_mesh()
    pose = {
        "still": np.eye(3, 4),
        "turned": random_pose(rng),
        "mirrored": random_pose(rng, mirrored=True, scale=3.0),
        "stretched": random_pose(rng, scale=np.array([0.01, 7.0, 1.0])),
        "moving": random_pose(rng),
    }[kind]
    soup = Soup([mesh.triangles.astype(np.float32)], [Placed(0, pose, 0, moves=kind == "moving")])
    corners = mesh.vertices.astype(np.float32).astype(float)
    edges = corners[mesh.edges_unique]
    share = rng.uniform(size=(len(edges), 1))
    share[::3] = 0.5
    targets = np.concatenate([corners, edges[:, 0] * share + edges[:, 1] * (1 - share)])
    targets = targets[rng.integers(0, len(targets), N)]
    inside = rng.uniform(-0.3, 0.3, size=(N, 3)) * (rng.uniform(size=(N, 1)) < 0.7)

    def to_world(points):
        return points @ pose[:, :3].T + pose[:, 3]

    origin = to_world(inside).astype(np.float32)
    direction = (to_world(targets) - origin).astype(np.float32)
    hit = in_jit(cast, soup.scene(), f32(origin), f32(direction), backend=backend)
    assert (hit.instance == 0).all()
    assert not hit.front.any(), "a ray got out and met the outside"
    np.testing.assert_allclose(hit.t, 1, atol=1e-3)


@pytest.mark.parametrize("backend", BACKENDS)
def test_rays_along_the_axes_and_in_planes_of_a_box(backend):
    """Zero direction components, origins on slab planes, hits on diagonals, edges and corners."""
    box = trimesh.creation.box(extents=(2, 2, 2))
    soup = Soup([box.triangles.astype(np.float32)], [Placed(0, np.eye(3, 4), 0)])
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * 2), axis=-1).reshape(-1, 2)
    cases = []
    for axis in range(3):
        origin = np.zeros((len(grid), 3))
        origin[:, [i for i in range(3) if i != axis]] = grid
        for sign in (-1.0, 1.0):
            direction = np.zeros((len(grid), 3))
            direction[:, axis] = sign
            cases.append((origin, direction))
    origin, direction = (np.concatenate(x) for x in zip(*cases, strict=True))
    hit = in_jit(cast, soup.scene(), f32(origin), f32(direction), backend=backend)
    np.testing.assert_array_equal(hit.t, 1.0)
