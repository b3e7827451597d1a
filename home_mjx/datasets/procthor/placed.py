"""Record of a thing of a house, shown by our own furniture, in our frame."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.furniture import Edges, FurniturePiece
from home_mjx.datasets.procthor.assets import ThorAsset
from home_mjx.datasets.procthor.records import ThorObject

MIRROR = np.diag([1.0, 1.0, -1.0])  # Unity's left-handed frame to ours, and back
FACE_ABOUT = np.diag([-1.0, 1.0, -1.0])  # from our models, whose front is +z, to mirrored ones of Unity's
Turn = Float[np.ndarray, "3 3"]


@dataclass(frozen=True)
class PlacedPiece:
    """A thing in our frame."""

    source: ThorObject
    asset: ThorAsset
    fine: str
    piece: FurniturePiece
    turn: Turn  # from the upright model to the house, without scale
    position: Float[np.ndarray, " 3"]  # of the middle of its base [m]
    size: Edges
    room: int  # index; -1 if unknown
    parent: int = -1  # index of the thing that it is on or in

    @property
    def linear(self) -> Turn:
        """Linear part of its transform."""
        c, s = ((1.0, 0.0), (0.0, 1.0))[self.piece.quarter % 2]
        quarter = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return self.turn @ quarter @ np.diag(self.piece.scale)

    @property
    def transform(self) -> Float[np.ndarray, "4 4"]:
        """Scene from model."""
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = self.linear, self.position
        return found

    @property
    def corners(self) -> Float[np.ndarray, "4 2"]:
        """Corners (x, z) of its footprint [m], if it is upright."""
        half = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]) * np.array(self.size) / 2
        return (half @ self.turn.T + self.position)[:, [0, 2]]


def unity_turn(rotation: tuple[float, float, float]) -> Turn:
    """Return the rotation of our upright model that stands for a thing with Unity's angles about x, y and z [deg].

    Unity turns about z first, then x, then y, all about fixed axes.

    Example:
        >>> (unity_turn((0.0, 0.0, 0.0)) @ [0, 0, 1]).tolist()  # its front is +z in Unity, so -z here
        [0.0, 0.0, -1.0]
    """
    x, y, z = np.radians(rotation)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    return MIRROR @ about_y @ about_x @ about_z @ MIRROR @ FACE_ABOUT + 0.0
