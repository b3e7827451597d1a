"""Translation, rotation and copies of several solids at once."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import overload

import numpy as np

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.grid import round_shape
from home_procgen.primitives.solids import Solid, Vector, move, rotate

Piece = Solid | Bulb


def translate(pieces: Iterable[Piece], x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Iterator[Piece]:
    """Generate the pieces, translated by a vector [m]."""
    for piece in pieces:
        yield move(piece, (x, y, z)) if isinstance(piece, Solid) else _bulb(piece, np.eye(3), (x, y, z))


def rotate_pieces(pieces: Iterable[Piece], axis: int, angle: float, pivot: Vector = (0.0, 0.0, 0.0)) -> Iterator[Piece]:
    """Generate the pieces, rotated about axis 0, 1 or 2 (x, y, z) through `pivot` by the right-hand rule [rad]."""
    for piece in pieces:
        if isinstance(piece, Solid):
            yield rotate(piece, axis, angle, pivot)
        else:
            i, j = (axis + 1) % 3, (axis + 2) % 3
            turn = np.eye(3)
            turn[[i, i, j, j], [i, j, i, j]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
            yield _bulb(piece, turn, np.asarray(pivot) - turn @ np.asarray(pivot))


def _bulb(bulb: Bulb, turn: np.ndarray, by: Vector | np.ndarray) -> Bulb:
    x, y, z = round_shape(turn @ np.asarray(bulb.position) + np.asarray(by)).tolist()
    return replace(bulb, position=(x, y, z))


def add_mirror_images(pieces: Iterable[Solid]) -> Iterator[Solid]:
    """Yield the pieces, then their copies mirrored at x = 0."""
    kept = list(pieces)
    yield from kept
    for piece in kept:
        part = piece.part and piece.part.transform(np.diag([-1.0, 1.0, 1.0]), np.zeros(3))
        faces, uv = piece.faces[:, ::-1], piece.uv[:, ::-1]
        yield replace(piece, vertices=piece.vertices * (-1, 1, 1), faces=faces, uv=uv, part=part)


@overload
def repeat_around(pieces: Iterable[Solid], count: int, start: float = 0.0) -> Iterator[Solid]: ...
@overload
def repeat_around(pieces: Iterable[Piece], count: int, start: float = 0.0) -> Iterator[Piece]: ...
def repeat_around(pieces: Iterable[Piece], count: int, start: float = 0.0) -> Iterator[Piece]:
    """Yield `count` copies of pieces, rotated about the y axis in equal steps of one turn from a start angle [rad]."""
    kept = list(pieces)
    for i in range(count):
        yield from rotate_pieces(kept, 1, start + 2 * np.pi * i / count)
