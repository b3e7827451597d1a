"""An even grid of directions around a head, and scattered ones between which its nodes lie."""

import logging

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from home_mjx.errors import ConfigError

STEP = 5  # [degrees]
CHUNK = 64  # nodes that are handled at once
FARTHEST = 30.0  # [degrees], from a node to the nearest measured direction

log = logging.getLogger(__name__)


def grid_directions() -> Float[np.ndarray, "v h 3"]:
    """The nodes of a head's grid, in its frame."""
    elevation = np.radians(np.arange(-90, 91, STEP))[:, None]
    azimuth = np.radians(np.arange(0, 360, STEP))[None]
    ring = np.cos(elevation)
    parts = -ring * np.sin(azimuth), np.broadcast_to(np.sin(elevation), (len(elevation), azimuth.size))
    return np.stack([*parts, -ring * np.cos(azimuth)], axis=-1)


def grid_weights(direction: Float[np.ndarray, "m 3"]) -> tuple[np.ndarray, np.ndarray]:
    """For each node of the grid, three measured directions and their shares: those of the triangle in which it lies.

    The triangles are those of the convex hull, which is Delaunay's triangulation of a sphere.

    Raises:
        ConfigError: The directions span no volume.
    """
    nodes = grid_directions().reshape(-1, 3)
    places = np.unique(np.round(direction, 6), axis=0, return_index=True)[1]  # poles are often written more than once
    try:
        corners = places[ConvexHull(direction[places]).simplices]
    except (QhullError, ValueError) as error:
        hint = "At least four are needed, not all in one plane."
        raise ConfigError("the directions of a head do not surround it", hint=hint) from error
    alone = places[np.argmax(nodes @ direction[places].T, axis=1)]
    _tell_of_gaps(nodes, direction[alone])
    matrix = np.swapaxes(direction[corners], 1, 2)
    usable = np.abs(np.linalg.det(matrix)) > 1e-9
    corners, inverse = corners[usable], np.linalg.inv(matrix[usable])
    index, share = np.repeat(alone[:, None], 3, axis=1), np.tile([1.0, 0.0, 0.0], (len(nodes), 1))
    for begin in range(0, len(nodes), CHUNK):
        part = slice(begin, begin + CHUNK)
        inside = np.einsum("tij,nj->nti", inverse, nodes[part])
        best = np.argmax(inside.min(axis=2), axis=1)
        found = np.take_along_axis(inside, best[:, None, None], axis=1)[:, 0]
        meets = found.min(axis=1) > -1e-6  # where nothing was measured all around, the nearest one counts
        index[part][meets] = corners[best[meets]]
        share[part][meets] = np.maximum(found[meets], 0) / np.maximum(found[meets], 0).sum(axis=1, keepdims=True)
    return index, share


def _tell_of_gaps(nodes: np.ndarray, nearest: np.ndarray) -> None:
    away = np.degrees(np.arccos(np.clip(np.sum(nodes * nearest, axis=1), -1, 1))).max()
    if away > FARTHEST:
        log.warning("some directions are %.0f degrees from any that was measured: they are filled in", away)


def mixed(share: tuple[np.ndarray, np.ndarray], values: np.ndarray) -> np.ndarray:
    """Values of measured directions at the nodes of the grid, (v, h, ...)."""
    index, weight = share
    whole = sum(values[index[:, i]] * weight[:, i].reshape(-1, *(1,) * (values.ndim - 1)) for i in range(3))
    return np.asarray(whole).reshape(*grid_directions().shape[:2], *values.shape[1:])


def areas() -> Float[np.ndarray, "v h"]:
    """Of the sphere, the share of each node."""
    ring = np.cos(np.radians(np.arange(-90, 91, STEP)))
    return np.repeat(ring[:, None], 360 // STEP, axis=1)
