"""Convex decomposition of models, for exact collision shapes; needs the extra `exact`.

The decomposition is by CoACD (Wei et al., 2022, "Approximate convex decomposition for 3D meshes with collision-aware
concavity and tree search"). It takes seconds per model, so pieces are stored in the cache folder.
"""

import hashlib
import logging
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from home_mjx.core.array_store import READ_ERRORS, read_entry, write_entry
from home_mjx.core.paths import cache_folder
from home_mjx.errors import ConfigError, install_hint
from home_mjx.geometry.meshes import bounds
from home_mjx.schema.compiled import Model

Piece = Float[np.ndarray, "f 3 3"]
CONVEX_CACHE_VERSION = 1  # increment whenever equal models would produce different pieces
MAX_CONCAVITY = 0.1  # maximum remaining concavity, as a share of the model's size (see CoACD)
MAX_PIECES = 16  # maximum number of pieces per model
MIN_PIECE_THICKNESS = 1e-3  # [m], minimum thickness of a piece; MuJoCo rejects thinner hulls

log = logging.getLogger(__name__)


def convex_pieces(model: Model) -> tuple[Piece, ...]:
    """Return the hulls of a model's convex pieces as triangles in its own frame [m]; empty for flat models.

    They are computed by CoACD and cached on disk. Flat pieces (`MIN_PIECE_THICKNESS`) are dropped.

    Raises:
        ConfigError: CoACD is not installed.

    Example:
        >>> len(convex_pieces(chair))  # doctest: +SKIP
        12
    """
    entry = _entry(model)
    try:
        arrays, notes = read_entry(entry)
        return tuple(arrays[str(i)] for i in range(notes["pieces"]))
    except FileNotFoundError:
        pass
    except READ_ERRORS as error:
        log.warning("broken cache entry %s is computed again: %s", entry, error)
    pieces = tuple(hull for hull in map(_hull, _decompose(model)) if hull is not None)
    try:
        write_entry(entry, {str(i): piece for i, piece in enumerate(pieces)}, {"pieces": len(pieces)})
    except OSError as error:
        log.warning("convex pieces are not cached: %s", error)
    return pieces


def _entry(model: Model) -> Path:
    """Return the path of a model's cached pieces, whether or not it exists."""
    name = hashlib.sha256(repr((CONVEX_CACHE_VERSION, model.key, MAX_CONCAVITY, MAX_PIECES)).encode()).hexdigest()
    return cache_folder() / "convex" / f"{name}.npz"


def _decompose(model: Model) -> list[Float[np.ndarray, "_ 3"]]:
    """Return the corners of the pieces; the whole model is one piece if it is flat or CoACD fails.

    Raises:
        ConfigError: CoACD is not installed.
    """
    try:
        import coacd
    except ImportError as error:
        hint = f"{install_hint('exact')}, or use boxes."
        raise ConfigError("convex pieces need the package `coacd`", hint=hint) from error
    vertices, corner = np.unique(model.triangle.reshape(-1, 3).astype(np.float64), axis=0, return_inverse=True)
    if np.ptp(vertices, axis=0).min() < MIN_PIECE_THICKNESS:
        return [vertices]
    coacd.set_log_level("off")
    try:
        found = coacd.run_coacd(
            coacd.Mesh(vertices, corner.reshape(-1, 3).astype(np.int32)),
            threshold=MAX_CONCAVITY,
            max_convex_hull=MAX_PIECES,
            # At most half of CoACD's defaults: equally many pieces, in 5 s per model instead of 30 s.
            resolution=1000,
            mcts_iterations=60,
            mcts_nodes=10,
            mcts_max_depth=2,
            seed=0,
        )
    except RuntimeError as error:
        log.warning("%s becomes a single convex piece: %s", model.key, error)
        return [vertices]
    return _squeeze([np.asarray(corners, float) for corners, _ in found], bounds(vertices)) or [vertices]


def _squeeze(pieces: list[Float[np.ndarray, "_ 3"]], box: Float[np.ndarray, "2 3"]) -> list[Float[np.ndarray, "_ 3"]]:
    """Return the pieces scaled together, by axis, to the model's bounding box: CoACD adds a skin of half a voxel."""
    if not pieces:
        return []
    skin = bounds(np.concatenate(pieces))
    return [box[0] + (corners - skin[0]) * np.ptp(box, axis=0) / np.ptp(skin, axis=0) for corners in pieces]


def _hull(corners: Float[np.ndarray, "v 3"]) -> Piece | None:
    """Return the triangles of the convex hull, counter-clockwise from outside; None if it is flat (below 1 mm)."""
    try:
        hull = ConvexHull(corners)
    except (QhullError, ValueError):
        return None
    triangles, normal = corners[hull.simplices], hull.equations[:, :3]
    # The minimum extent along the hull's face normals.
    across = (corners @ normal.T).max(axis=0) - (corners @ normal.T).min(axis=0)
    if across.min() < MIN_PIECE_THICKNESS:
        return None
    turned = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = (turned * normal).sum(axis=1) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return triangles
