"""The twelve edges of a box: their numbering, and detection of those exposed to air, for sound diffraction."""

import numpy as np
from jaxtyping import Bool, Float

PROBE_DISTANCE = 0.02  # [m], distance of the probe points from an edge
PROBE_POSITIONS = np.linspace(-0.9, 0.9, 5)  # probe positions along an edge, in half lengths
MIN_FREE_PROBES = 2  # minimum number of positions surrounded by air
NUM_EDGES = 12


def edge_rows() -> np.ndarray:
    """Return for each edge its axis and its side (-1 or 1) on the other two axes in ascending order: shape (12, 3).

    Example:
        >>> edge_rows()[[0, 11]].tolist()
        [[0, -1, -1], [2, 1, 1]]
    """
    return np.array([(along, a, b) for along in range(3) for a in (-1, 1) for b in (-1, 1)])


def edge_number(u: int, side_u: int, v: int, side_v: int) -> int:
    """Return the number of the edge between the faces on the given sides of axes `u` and `v`.

    Example:
        >>> edge_number(1, 1, 0, 1) == edge_number(0, 1, 1, 1) == 11
        True
    """
    first, second = (side_u, side_v) if u < v else (side_v, side_u)
    return 4 * (3 - u - v) + 2 * (first > 0) + (second > 0)


def find_exposed_edges(
    center: Float[np.ndarray, "n 3"],
    rotation: Float[np.ndarray, "n 3 3"],
    half: Float[np.ndarray, "n 3"],
    heights: Float[np.ndarray, "r 2"],
) -> Bool[np.ndarray, "n edges"]:
    """Return the mask of edges that diffract sound: exposed ones, not where boxes are coplanar, meet or overlap.

    Args:
        center: Box centres [m].
        rotation: Rotations from box to world.
        half: Half extents [m].
        heights: Floor and ceiling of each room [m].

    Example:
        >>> one = np.zeros((1, 3)), np.eye(3)[None], np.ones((1, 3))
        >>> int(find_exposed_edges(*one, np.array([[-2.0, 2.0]])).sum())
        12
        >>> int(find_exposed_edges(*one, np.array([[-2.0, 1.01]])).sum())  # up to the ceiling: no edges there
        8
    """
    exposed = np.zeros((len(center), NUM_EDGES), bool)
    radius = np.linalg.norm(half, axis=1)
    for box in range(len(center)):
        apart = np.linalg.norm(center - center[box], axis=1)
        others = np.flatnonzero((apart < radius + radius[box] + 2 * PROBE_DISTANCE) & (np.arange(len(center)) != box))
        points = _probes(half[box]) @ rotation[box].T + center[box]  # edge, along, probe
        air = ((points[..., 2, None] > heights[:, 0]) & (points[..., 2, None] < heights[:, 1])).any(axis=-1)
        for other in others:
            local = abs((points - center[other]) @ rotation[other])
            air &= ~(local <= half[other]).all(axis=-1)
        exposed[box] = air.all(axis=-1).sum(axis=-1) >= MIN_FREE_PROBES
    return exposed


def _probes(half: Float[np.ndarray, "3"]) -> Float[np.ndarray, "edges along 3 3"]:
    """Return points next to both faces and in front of each edge, in the box's frame."""
    found = np.zeros((NUM_EDGES, len(PROBE_POSITIONS), 3, 3))
    for number, (along, *sides) in enumerate(edge_rows()):
        others = [axis for axis in range(3) if axis != along]
        found[number, ..., along] = (PROBE_POSITIONS * half[along])[:, None]
        for axis, side, away in zip(others, sides, ([1, -1, 1], [-1, 1, 1]), strict=True):
            found[number, ..., axis] = side * (half[axis] + PROBE_DISTANCE * np.array(away))
    return found
