"""Lawn, street, paths and drives as slabs of ground."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from home_mjx.geometry.pieces import MeshPiece, join_pieces
from home_mjx.geometry.slabs import slab
from home_mjx.schema.house import GroundNode, Material
from home_procgen.floor_plan.rooms import Rect

UNDERSIDE_HEIGHT = -0.1  # [m], height of the undersides of all slabs


@dataclass(frozen=True)
class GroundPatch:
    """A rectangle of ground.

    Attributes:
        rect: The rectangle [m].
        top: Height of its surface [m]; walls begin at 0.
        material: Material of its surface.
    """

    rect: Rect
    top: float
    material: Material


def build_ground_node(patch: GroundPatch, index: int, folder: Path) -> GroundNode:
    """Return the node of a patch on the lowest level.

    Args:
        patch: The patch.
        index: Index of the node in its level.
        folder: Folder of the house's meshes.
    """
    x0, z0, x1, z1 = patch.rect
    outline = np.array([(x0, z0), (x1, z0), (x1, z1), (x0, z1)])
    stem = f"fr_0gd_{index}"
    piece = MeshPiece(f"Ground#0_{index}", *slab([outline], UNDERSIDE_HEIGHT, patch.top, 0.0), np.zeros(12, int))
    mesh = join_pieces(folder / f"{stem}f.obj", [piece], [patch.material])
    return GroundNode(
        id=f"0_{index}", index=index, path=f"levels[0].nodes[{index}]", bbox=None, model_id=stem, mesh=mesh
    )
