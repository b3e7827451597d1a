"""Low level of detail: the same solids with few facets, small ones as boxes, and the least of many left out."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from home_procgen.primitives.detail import build_coarsely
from home_procgen.primitives.solids import Solid, box

COARSENESS = (1.0, 2.0, 4.0)  # factors on tolerances, tried in turn
COARSE_TRIANGLES = 160  # number of triangles of a model that needs no coarser pieces
MAX_TRIANGLES = 200  # number of triangles of a model that keeps all pieces
MAX_OMITTED_DIAGONAL = 0.22  # of the diagonal of a model: larger pieces stay
MAX_BOXED_DIAGONAL = 0.04  # [m], below which a piece becomes a box; times the coarseness
MAX_BOXED_SHARE = 0.15  # of the diagonal of a model, below which a piece becomes a box
NUM_BOX_FACES = 12
OUTER_TOLERANCE = 1e-6  # [m], to which pieces reach the bounding box of their model
GOLDEN_RATIO = 0.618034


def reduce_solids(
    full: Sequence[Solid], build: Callable[[], Sequence[Solid]], rigid: bool
) -> tuple[float, list[Solid]]:
    """Return the coarseness and the coarse pieces of a model, in their order, with the bounding box of the model.

    Args:
        full: Its pieces at full detail.
        build: Builds them again.
        rigid: Keep shapes as they are built, so that they are equal in all states of a door.
    """
    coarseness, pieces, limit = 0.0, list(full), MAX_BOXED_SHARE * _diagonal(full)
    for coarseness in COARSENESS:
        with build_coarsely(coarseness):
            built = build()
        if not rigid:
            built = [
                _fit(piece, own, min(limit, MAX_BOXED_DIAGONAL * coarseness))
                for piece, own in zip(built, full, strict=True)
            ]
        pieces = [a if len(a.faces) < len(b.faces) else b for a, b in zip(built, pieces, strict=True)]
        if _count(pieces) <= COARSE_TRIANGLES:
            break
    return coarseness, pieces


def _count(pieces: Sequence[Solid]) -> int:
    return sum(len(piece.faces) for piece in pieces)


def _diagonal(pieces: Sequence[Solid]) -> float:
    boxes = np.stack([piece.box for piece in pieces])
    return _length(boxes[:, 1].max(0) - boxes[:, 0].min(0))


def _length(way: Float[np.ndarray, " 3"]) -> float:
    """Return the length of a vector; unlike `np.linalg.norm`, with the same bits on all CPUs."""
    return float(np.sqrt((way * way).sum()))


def _fit(piece: Solid, full: Solid, max_diagonal: float) -> Solid:
    """Return a coarse piece stretched to the bounding box of the full one, or that box if its diagonal is small."""
    (low, high), own = full.box, piece.box
    size = high - low
    if len(piece.faces) > NUM_BOX_FACES and _length(size) < max_diagonal and isinstance(full.material, str):
        (x, y, z), (at_x, _, at_z) = size.tolist(), ((low + high) / 2).tolist()
        made = box(full.material, (x, y, z), (at_x, float(low[1]), at_z))
        return replace(made, part=full.part, group=full.group)
    vertices = low + (piece.vertices - own[0]) * size / np.maximum(own[1] - own[0], 1e-9)
    return replace(piece, vertices=vertices, part=full.part)


def select_pieces(pieces: Sequence[Solid]) -> list[int]:
    """Return the numbers of the pieces that stay: all if they have few triangles, else without the smallest.

    The largest of every material and movable part stay, and one at each side of the bounding box.
    """
    size = np.array([_length(np.ptp(piece.box, axis=0)) for piece in pieces])
    # Equal pieces, such as books, leave evenly.
    order = sorted(range(len(pieces)), key=lambda i: (np.round(2 * np.log2(size[i])), i * GOLDEN_RATIO % 1))
    needed = {max(own, key=lambda i: size[i]) for own in _groups(pieces)} | _outer(pieces)
    limit = MAX_OMITTED_DIAGONAL * _diagonal(pieces)
    left, kept = _count(pieces), set(range(len(pieces)))
    for i in order:
        if left <= MAX_TRIANGLES or size[i] > limit:
            break
        if i not in needed:
            kept.remove(i)
            left -= len(pieces[i].faces)
    return sorted(kept)


def _groups(pieces: Sequence[Solid]) -> list[list[int]]:
    """Return the numbers of the pieces of each material and of each movable part."""
    found: dict[object, list[int]] = {}
    for i, piece in enumerate(pieces):
        for key in (piece.material, piece.part):
            if key is not None:
                found.setdefault(key, []).append(i)
    return list(found.values())


def _outer(pieces: Sequence[Solid]) -> set[int]:
    """Return the largest piece at each side of the bounding box."""
    boxes = np.stack([piece.box for piece in pieces])
    volume = np.ptp(boxes, axis=1).prod(axis=1)
    found = set()
    for end, bound in ((boxes[:, 0], boxes[:, 0].min(0)), (boxes[:, 1], boxes[:, 1].max(0))):
        for axis in range(3):
            touching = np.flatnonzero(np.abs(end[:, axis] - bound[axis]) < OUTER_TOLERANCE)
            found.add(int(touching[volume[touching].argmax()]))
    return found
