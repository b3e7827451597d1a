"""Movable parts, as the code of a shape marks them on the solids that it draws."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.joints import JointKind, Vector


@dataclass(frozen=True)
class Part:
    """A drawer, a door or a lid; solids that bear an equal one move together.

    Args:
        name: What it is, without a number.
        kind: How it moves.
        axis: Unit vector: about it by the right hand, or along it.
        point: On a hinge's axis, or a slide's corner, by which equal drawers differ [m].
        reach: How far it goes from where it is drawn [rad] or [m].
    """

    name: str
    kind: JointKind
    axis: Vector
    point: Vector
    reach: float

    def mapped(self, turn: Float[np.ndarray, "3 3"], shift: Float[np.ndarray, " 3"]) -> "Part":
        """The part of solids that were turned or mirrored about the origin, and then moved.

        Args:
            turn: An orthogonal matrix.
            shift: [m].
        """
        sense = np.sign(np.linalg.det(turn)) if self.kind == "hinge" else 1.0  # mirrored, a left hand is a right one
        return replace(self, axis=_triple(sense * turn @ self.axis), point=_triple(turn @ self.point + shift))


def _triple(values: Float[np.ndarray, " 3"]) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
