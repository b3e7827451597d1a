"""Areas covered by meshes in plan, on a grid."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.schema.house import Mesh

MIN_CELL_SIZE = 0.1  # [m], minimum edge of a cell
MAX_CELLS = 512  # maximum cells along one axis; levels of more than 51 m get a coarser grid
MAX_TRIANGLES = 2_000  # maximum triangles of one mesh; real floors and walls have a few dozen

Triangles = Float[np.ndarray, "_ 3 2"]  # (x, z) [m]


def upward_faces(mesh: Mesh) -> Triangles:
    """Return the first `MAX_TRIANGLES` faces of a mesh that face up within 45 degrees, in plan."""
    corners = mesh.vertices[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners[normal[:, 1] > 0.7 * np.linalg.norm(normal, axis=1)][:MAX_TRIANGLES, :, [0, 2]]


@dataclass(frozen=True)
class FootprintGrid:
    """A grid of square cells."""

    low: Float[np.ndarray, "2"]  # [m], corner of the first cell
    step: float  # [m]
    shape: tuple[int, int]

    @classmethod
    def around(cls, areas: Sequence[Triangles]) -> "FootprintGrid":
        """Create a grid around areas, at least one, with a margin of two cells."""
        corners = np.concatenate([area.reshape(-1, 2) for area in areas])
        low, high = corners.min(axis=0), corners.max(axis=0)
        step = max(MIN_CELL_SIZE, float((high - low).max()) / MAX_CELLS)
        columns, rows = (np.ceil((high - low) / step).astype(int) + 4).tolist()
        return cls(low - 2 * step, step, (columns, rows))

    def mask(self, area: Triangles) -> Bool[np.ndarray, "c r"]:
        """Return the mask of cells whose centre is in a triangle or on its edge; triangles must be inside the grid."""
        found = np.zeros(self.shape, bool)
        for triangle in (area - self.low) / self.step - 0.5:  # in cells, from the middle of the first
            (i, j), (k, m) = np.ceil(triangle.min(0)).astype(int), np.floor(triangle.max(0)).astype(int) + 1
            x, z = np.mgrid[i:k, j:m]
            sides = [
                (q[0] - p[0]) * (z - p[1]) - (q[1] - p[1]) * (x - p[0])
                for p, q in zip(triangle, np.roll(triangle, -1, axis=0), strict=True)
            ]
            found[i:k, j:m] |= (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
        return found

    def at(self, mask: Bool[np.ndarray, "c r"], point: Float[np.ndarray, "2"]) -> bool:
        """Return the value of a mask of this grid at a point (x, z) [m]; False outside the grid."""
        cell = np.floor((point - self.low) / self.step).astype(int)
        return bool((cell >= 0).all() and (cell < self.shape).all() and mask[tuple(cell)])
