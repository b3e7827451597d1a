"""Closed mesh pieces with material slots, and their union as one mesh."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.wall_prisms import WallPrism, WallSegment, wall_prisms
from home_mjx.schema.house import Material, Mesh

CUT_MATERIAL = Material("cut", (0.5, 0.5, 0.5), None, 1.0)  # grey of cut faces


@dataclass(frozen=True)
class MeshPiece:
    """A closed part of a mesh; see `join_pieces` for its slots."""

    group: str
    vertices: Float[np.ndarray, "v 3"]
    faces: Int[np.ndarray, "f 3"]
    uv: Float[np.ndarray, "f 3 2"]
    slot: Int[np.ndarray, " f"]
    part: str = ""  # pieces of one part, such as the layers of a wall, share its name


def wall_pieces(wall: WallSegment, wall_id: str) -> list[MeshPiece]:
    """Build the inner and the outer layer of a wall, in this order, Y up [m].

    Vertices and texture coordinates are in metres, Y up. Both large sides of the inner layer have slot 0, those of the
    outer one 2. Cut faces of both have slot 1: ends, top, base and the sides of holes.

    Args:
        wall: The wall, see `wall_prisms`; start and end must differ.
        wall_id: Name of the wall, such as `0_1_3`: suffix of both group names, and their part.
    """
    layers = zip(("WallInside", "WallOutside"), wall_prisms(wall), (0, 2), strict=True)
    return [_wall_piece(f"{name}#{wall_id}", prism, slot, wall_id) for name, prism, slot in layers]


def _wall_piece(group: str, prism: WallPrism, slot: int, wall_id: str) -> MeshPiece:
    """Return a layer of a wall, with `slot` on its large faces and slot 1 on cut faces."""
    return MeshPiece(group, prism.vertices, prism.faces, prism.uv, np.where(prism.is_large_face, slot, 1), part=wall_id)


def join_pieces(path: Path, pieces: Sequence[MeshPiece], materials: Sequence[Material], scale: float = 1.0) -> Mesh:
    """Join pieces into one mesh without welding vertices; slots must already index `materials`, which is not checked.

    Args:
        path: `Mesh.path`; nothing is written.
        pieces: Pieces, at least one. Their groups and parts are numbered by first appearance.
        materials: One per slot; copies are named `material_0`, `material_1`, ...
        scale: Metres per unit of the vertices and the texture coordinates.
    """
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    names = tuple(dict.fromkeys(piece.group for piece in pieces))
    parts = tuple(dict.fromkeys(piece.part for piece in pieces))
    return Mesh(
        path=path,
        vertices=np.concatenate([piece.vertices for piece in pieces]) * scale,
        faces=np.concatenate([p.faces + start for p, start in zip(pieces, starts, strict=False)]).astype(np.int32),
        uv=(np.concatenate([piece.uv for piece in pieces]) * scale).astype(np.float32),
        slot=np.concatenate([piece.slot for piece in pieces]).astype(np.int32),
        group=np.concatenate([np.full(len(p.faces), names.index(p.group)) for p in pieces]).astype(np.int32),
        materials=tuple(replace(material, name=f"material_{i}") for i, material in enumerate(materials)),
        groups=names,
        part=np.concatenate([np.full(len(p.faces), parts.index(p.part)) for p in pieces]).astype(np.int32),
    )
