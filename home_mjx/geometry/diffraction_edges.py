"""The twelve edges of a box: their numbering, and detection of those exposed to air, for sound diffraction."""

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.rotations import quat_matrix
from home_mjx.schema.compiled import Colliders, RoomTable

PROBE_DISTANCE = 0.02  # [m], distance of the probe points from an edge
PROBE_POSITIONS = np.linspace(-0.9, 0.9, 5)  # probe positions along an edge, in half lengths
MIN_FREE_PROBES = 2  # minimum number of positions surrounded by air
NUM_EDGES = 12
MAX_PAIRS = 1 << 18  # maximum number of pairs of boxes that are compared at once


def edge_rows() -> np.ndarray:
    """Return for each edge of a box, in its frame, one row: the axis of the edge and its sides on the other two axes.

    An axis is 0 to 2, a side -1 or 1. The other two axes are in ascending order.

    Example:
        >>> edge_rows()[[0, 11]].tolist()
        [[0, -1, -1], [2, 1, 1]]
    """
    return np.array([(along, a, b) for along in range(3) for a in (-1, 1) for b in (-1, 1)])


def edge_number(u: int, side_u: int, v: int, side_v: int) -> int:
    """Return the row in `edge_rows` of the edge between the faces on the sides (-1 or 1) of two axes `u` and `v`.

    The axes must differ, which is not checked; either may be the lower one.

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
    """Return the mask of edges, in the order of `edge_rows`, that are exposed to air and thus diffract sound.

    At `MIN_FREE_PROBES` or more positions along an edge, three points must be in air: one in front of each of its
    faces, and one outside both. Air is between the floor and ceiling of some room, wherever that room is in plan, and
    not inside or on another box. Without rooms no edge is exposed.

    Args:
        center: Box centres [m].
        rotation: Rotations of column vectors from box to world, Z up.
        half: Half extents [m].
        heights: Floor and ceiling of each room, world z [m].

    Example:
        >>> one = np.zeros((1, 3)), np.eye(3)[None], np.ones((1, 3))
        >>> int(find_exposed_edges(*one, np.array([[-2.0, 2.0]])).sum())
        12
        >>> int(find_exposed_edges(*one, np.array([[-2.0, 1.01]])).sum())  # up to the ceiling: no edges there
        8
    """
    points = _probes(half) @ rotation.swapaxes(1, 2)[:, None, None] + center[:, None, None, None]
    air = np.zeros(points.shape[:-1], bool)  # box, edge, along, probe
    for floor, ceiling in heights:
        air |= (points[..., 2] > floor) & (points[..., 2] < ceiling)
    for rows in np.array_split(np.arange(len(center)), 1 + len(center) ** 2 // MAX_PAIRS):
        box, other = _close_pairs(center, rotation, half, rows)
        local = abs((points[box] - center[other][:, None, None, None]) @ rotation[other][:, None, None])
        is_blocked = (local <= half[other][:, None, None, None]).all(axis=-1)
        first = np.flatnonzero(np.diff(box, prepend=-1))
        if len(first):
            air[box[first]] &= ~np.logical_or.reduceat(is_blocked, first, axis=0)
    return air.all(axis=-1).sum(axis=-1) >= MIN_FREE_PROBES


def exposed_edge_bits(boxes: Colliders, rooms: RoomTable) -> Int[np.ndarray, " c"]:
    """Return `find_exposed_edges` of static boxes in a house, as bits: bit i of a box is row i of `edge_rows`."""
    heights = np.stack([rooms.floor, rooms.ceiling], axis=1)
    exposed = find_exposed_edges(boxes.pos, quat_matrix(boxes.quat), boxes.size, heights)
    return (exposed @ (1 << np.arange(NUM_EDGES))).astype(np.int32)


def _close_pairs(
    center: Float[np.ndarray, "n 3"],
    rotation: Float[np.ndarray, "n 3 3"],
    half: Float[np.ndarray, "n 3"],
    rows: Int[np.ndarray, " m"],
) -> Int[np.ndarray, "2 p"]:
    """Return pairs of a box of `rows` (row 0) and another box that may contain one of its probe points (row 1).

    They are sorted by the first if `rows` are; boxes without such a neighbour are left out.
    """
    reach = half[rows] + 2 * PROBE_DISTANCE
    radius = np.linalg.norm(half, axis=1)
    apart = np.linalg.norm(center[rows, None] - center, axis=-1)
    near = (apart < radius + np.linalg.norm(reach, axis=1)[:, None]) & (rows[:, None] != np.arange(len(center)))
    first, other = np.nonzero(near)
    box = rows[first]
    turn = abs(rotation[other].swapaxes(1, 2) @ rotation[box])  # |axis of the other . axis of the box|
    away = abs(np.einsum("pi,pij->pj", center[box] - center[other], rotation[other]))
    meets = (away <= half[other] + np.einsum("pij,pj->pi", turn, reach[first])).all(axis=1)
    return np.stack([box[meets], other[meets]])


def _probes(half: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n edges along 3 3"]:
    """Return probe points [m] around the edges, in the boxes' frames, `PROBE_DISTANCE` from the planes of both faces.

    The last but one axis has three: in front of the face of the lower axis, of the higher axis, and outside both.
    """
    found = np.zeros((len(half), NUM_EDGES, len(PROBE_POSITIONS), 3, 3))
    for number, (along, *sides) in enumerate(edge_rows()):
        others = [axis for axis in range(3) if axis != along]
        found[:, number, ..., along] = (PROBE_POSITIONS * half[:, along, None])[..., None]
        for axis, side, away in zip(others, sides, ([1, -1, 1], [-1, 1, 1]), strict=True):
            found[:, number, ..., axis] = (side * (half[:, axis, None] + PROBE_DISTANCE * np.array(away)))[:, None]
    return found
