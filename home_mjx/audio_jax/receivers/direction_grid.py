"""A regular grid of directions around a head, and interpolation from scattered directions to its nodes."""

import logging

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from home_mjx.errors import ConfigError

GRID_STEP = 5  # [degrees]
NODES_PER_CHUNK = 64  # nodes processed at once, which bounds memory
MAX_GAP_ANGLE = 30.0  # [degrees], from a node to the nearest measured direction, beyond which a warning is logged

log = logging.getLogger(__name__)


def grid_directions() -> Float[np.ndarray, "v h 3"]:
    """Return unit vectors of all nodes in the head frame (x right, y up, z back), ordered as `MeasuredHead`."""
    elevation = np.radians(np.arange(-90, 91, GRID_STEP))[:, None]
    azimuth = np.radians(np.arange(0, 360, GRID_STEP))[None]
    ring = np.cos(elevation)
    parts = -ring * np.sin(azimuth), np.broadcast_to(np.sin(elevation), (len(elevation), azimuth.size))
    return np.stack([*parts, -ring * np.cos(azimuth)], axis=-1)


def grid_weights(direction: Float[np.ndarray, "m 3"]) -> tuple[np.ndarray, np.ndarray]:
    """Compute three measured directions per node and their weights, of sum 1: those of the triangle that contains it.

    Triangles are faces of the convex hull, which is the Delaunay triangulation of the sphere. Nodes outside all
    triangles take the nearest direction. Gaps above `MAX_GAP_ANGLE` are logged as a warning.

    Returns:
        Indices of directions and their weights (nodes, 3), nodes by elevation, then azimuth.

    Raises:
        ConfigError: The directions span no volume.
    """
    nodes = grid_directions().reshape(-1, 3)
    places = np.unique(np.round(direction, 6), axis=0, return_index=True)[1]  # poles are often listed repeatedly
    try:
        corners = places[ConvexHull(direction[places]).simplices]
    except (QhullError, ValueError) as error:
        hint = "At least four directions are needed, not all in one plane."
        raise ConfigError("the directions of a head do not surround it", hint=hint) from error
    alone = places[np.argmax(nodes @ direction[places].T, axis=1)]
    _warn_gaps(nodes, direction[alone])
    matrix = np.swapaxes(direction[corners], 1, 2)
    usable = np.abs(np.linalg.det(matrix)) > 1e-9
    corners, inverse = corners[usable], np.linalg.inv(matrix[usable])
    index, share = np.repeat(alone[:, None], 3, axis=1), np.tile([1.0, 0.0, 0.0], (len(nodes), 1))
    for begin in range(0, len(nodes), NODES_PER_CHUNK):
        part = slice(begin, begin + NODES_PER_CHUNK)
        inside = np.einsum("tij,nj->nti", inverse, nodes[part])
        best = np.argmax(inside.min(axis=2), axis=1)
        found = np.take_along_axis(inside, best[:, None, None], axis=1)[:, 0]
        meets = found.min(axis=1) > -1e-6  # nodes outside all triangles use the nearest direction
        index[part][meets] = corners[best[meets]]
        share[part][meets] = np.maximum(found[meets], 0) / np.maximum(found[meets], 0).sum(axis=1, keepdims=True)
    return index, share


def _warn_gaps(nodes: np.ndarray, nearest: np.ndarray) -> None:
    """Log a warning if a node is more than `MAX_GAP_ANGLE` from its nearest measured direction."""
    away = np.degrees(np.arccos(np.clip(np.sum(nodes * nearest, axis=1), -1, 1))).max()
    if away > MAX_GAP_ANGLE:
        log.warning("some directions are %.0f degrees from the nearest measured one: they are filled in", away)


def interpolate_to_grid(share: tuple[np.ndarray, np.ndarray], values: np.ndarray) -> np.ndarray:
    """Interpolate values (m, ...) of measured directions at the nodes, (v, h, ...); `share` is from `grid_weights`."""
    index, weight = share
    whole = sum(values[index[:, i]] * weight[:, i].reshape(-1, *(1,) * (values.ndim - 1)) for i in range(3))
    return np.asarray(whole).reshape(*grid_directions().shape[:2], *values.shape[1:])


def node_areas() -> Float[np.ndarray, "v h"]:
    """Return weights of the nodes for means over the sphere: cosines of elevations, not normalized."""
    ring = np.cos(np.radians(np.arange(-90, 91, GRID_STEP)))
    return np.repeat(ring[:, None], 360 // GRID_STEP, axis=1)
