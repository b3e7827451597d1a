"""Grouping of a room's wall faces into walls, and the facing direction of a wall."""

import numpy as np
from jaxtyping import Float, Int

from home_mjx.schema.house import Mesh


def wall_faces(walls: Mesh) -> list[Int[np.ndarray, " _"]]:
    """Return the faces of each wall; inner and outer layer, WallInside#0_1_3 and WallOutside#0_1_3, are one wall.

    Args:
        walls: Wall mesh of one room. Faces without a group form one wall.
    """
    numbers = [name.rpartition("#")[2] for name in walls.groups]
    order = {number: i for i, number in enumerate(dict.fromkeys(numbers))}
    wall_of_group = np.array([*(order[n] for n in numbers), -1])
    wall = wall_of_group[walls.group]
    return [np.flatnonzero(wall == w) for w in np.unique(wall)]


def facing_axis(normal: Float[np.ndarray, "t 2"], area: Float[np.ndarray, " t"]) -> Float[np.ndarray, "2"]:
    """Return the horizontal axis, of either sign, that most of a wall's area faces.

    It is the first principal axis of the normals, weighted by area.

    Args:
        normal: Horizontal part of each triangle's normal, scaled by its area [m^2].
        area: Area of each triangle [m^2].
    """
    flat = normal / np.sqrt(np.maximum(area, 1e-12))[:, None]
    return np.linalg.eigh(flat.T @ flat)[1][:, -1]
