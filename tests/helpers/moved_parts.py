"""How deep the parts of a model get into each other as one of them moves, by winding numbers of closed pieces."""

from collections.abc import Iterator

import numpy as np
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

STEP = 0.05  # [m], between the points of a surface that are looked at
NEAR = 0.004  # [m]: what is less deep need not be measured


def pieces(mesh) -> np.ndarray:
    """The number of the connected piece of each face."""
    a, b = mesh.faces[:, [0, 1, 2]].ravel(), mesh.faces[:, [1, 2, 0]].ravel()
    count = len(mesh.vertices)
    return connected_components(coo_array((np.ones(len(a)), (a, b)), (count, count)), False)[1][mesh.faces[:, 0]]


class Body:
    """Some closed pieces, and points on their surface [m]."""

    def __init__(self, mesh, chosen: np.ndarray) -> None:
        piece = pieces(mesh)
        self.corners = [mesh.vertices[mesh.faces[chosen & (piece == k)]] for k in np.unique(piece[chosen])]
        self.boxes = np.array([[c.min((0, 1)), c.max((0, 1))] for c in self.corners])
        self.points = np.concatenate([_points(c) for c in self.corners])

    def depth(self, points: np.ndarray) -> float:
        """The greatest depth of any of the points in any piece [m]; 0 if it is less than NEAR."""
        return max((float(_depth(points[near], corners)) for near, corners in self._near(points)), default=0.0)

    def _near(self, points: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for (low, high), corners in zip(self.boxes, self.corners, strict=True):
            near = ((points > low + NEAR) & (points < high - NEAR)).all(1)
            if near.any():
                yield near, corners


def _points(corners: np.ndarray) -> np.ndarray:
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    return np.unique(trimesh.remesh.subdivide_to_size(corners.reshape(-1, 3), faces, STEP)[0].round(6), axis=0)


def _depth(points: np.ndarray, corners: np.ndarray) -> float:
    inside = points[_inside(points, corners)]
    if not len(inside):
        return 0.0
    best = np.zeros(0)
    for chunk in np.array_split(inside, len(inside) * len(corners) // 200_000 + 1):
        pairs = np.repeat(chunk, len(corners), 0)
        closest = trimesh.triangles.closest_point(np.tile(corners, (len(chunk), 1, 1)), pairs)
        best = np.append(best, np.linalg.norm(closest - pairs, axis=1).reshape(len(chunk), -1).min(1))
    return best.max()


def _inside(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Whether the winding number of a closed piece is 1 at points, by solid angles (van Oosterom and Strackee)."""
    total = []
    for chunk in np.array_split(points, len(points) * len(corners) // 500_000 + 1):
        a, b, c = np.moveaxis(corners[None] - chunk[:, None, None], 2, 0)
        x, y, z = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
        above = np.einsum("pfi,pfi->pf", a, np.cross(b, c))
        below = x * y * z + (a * b).sum(-1) * z + (b * c).sum(-1) * x + (c * a).sum(-1) * y
        total.append(2 * np.arctan2(above, below).sum(1))
    return np.concatenate(total) > 2 * np.pi


def depths(mesh, joint, steps: int = 9) -> list[float]:
    """How deep a part is in the rest of its model, or the rest in it, from where it is drawn to the end of its range.

    The rest is as drawn; the list begins with the depth as drawn [m].
    """
    own = np.zeros(len(mesh.faces), bool)
    own[joint.faces] = True
    part, rest = Body(mesh, own), Body(mesh, ~own)
    found = []
    for value in np.linspace(0.0, joint.high, steps):
        motion = joint.matrix(float(value))
        turn, shift = motion[:3, :3], motion[:3, 3]
        found.append(max(rest.depth(part.points @ turn.T + shift), part.depth((rest.points - shift) @ turn)))
    return found
