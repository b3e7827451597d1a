"""Our own furniture for assets that are missing: of their category, and of the size of their colliders if known."""

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.furniture import Edges, FurniturePiece, FurnitureProvider
from home_mjx.datasets.gltf.decode.scene import Matrix
from home_mjx.datasets.procthor.assets import typical_sizes
from home_mjx.datasets.procthor.placing import UNKNOWN_SIZE, plain_box
from home_mjx.datasets.taxonomy import vocabulary
from home_mjx.schema.house import Mesh

MIN_EDGE = 0.005  # [m], minimum edge of a box
Box = Float[np.ndarray, "2 3"]


def stand_in(provider: FurnitureProvider, fine: str, box: Box | None, seed: str) -> tuple[str, Mesh, Matrix, str]:
    """Return our furniture in the box of a missing asset.

    Args:
        provider: Our furniture.
        fine: Fine category.
        box: Minimum and maximum corner of the oriented asset [m]; None: a typical size around its origin.
        seed: Name of the asset, which selects among models.

    Returns:
        Key of the mesh, the mesh, the oriented asset from the mesh, and a description.
    """
    if box is None:
        half = np.array(typical_size(fine)) / 2
        box = np.stack([-half, half])
    width, height, depth = np.maximum(box[1] - box[0], MIN_EDGE).tolist()
    size: Edges = (width, height, depth)
    piece = provider.piece(_word(fine), fine, size, seed) or plain_box(size)
    matrix = np.eye(4)
    matrix[:3, :3] = piece_turn(piece) @ np.diag(piece.scale)
    matrix[:3, 3] = (box[0, 0] + box[1, 0]) / 2, box[0, 1], (box[0, 2] + box[1, 2]) / 2
    mesh = replace(piece.mesh, materials=piece.materials) if piece.materials else piece.mesh
    look = hashlib.sha256(repr(mesh.materials).encode()).hexdigest()[:8]
    return f"{piece.key}_{look}", mesh, matrix, f"{piece.words} of {width:.2f} x {height:.2f} x {depth:.2f} m"


def piece_turn(piece: FurniturePiece) -> Float[np.ndarray, "3 3"]:
    """Return the quarter turns of a piece about +y."""
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    return np.linalg.matrix_power(turn, piece.quarter % 4)


@cache
def _sizes() -> Mapping[str, tuple[str, Edges]]:
    """Return AI2-THOR's word and its typical size by fine category; the first word of several."""
    found: dict[str, tuple[str, Edges]] = {}
    for word, size in typical_sizes().items():
        found.setdefault(vocabulary("ai2thor").get(word, ""), (word, size))
    return found


def typical_size(fine: str) -> Edges:
    """Return the typical size of a category [m]; that of unknown things if it has none."""
    return _sizes()[fine][1] if fine in _sizes() else UNKNOWN_SIZE


def _word(fine: str) -> str:
    """Return AI2-THOR's word for a category; the category's own if there is none."""
    return _sizes()[fine][0] if fine in _sizes() else fine
