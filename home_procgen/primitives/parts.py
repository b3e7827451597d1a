"""Movable parts, attached to the solids of a shape."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import JointKind, Vector


@dataclass(frozen=True)
class MovablePart:
    """A drawer, a door or a lid; solids with equal parts move together.

    Args:
        name: Name without a number.
        kind: Kind of joint.
        axis: Unit vector: of rotation by the right-hand rule, or of translation.
        point: Point on a hinge's axis, or corner of a slide, which distinguishes equal drawers [m].
        travel: Range from the drawn position [rad] or [m].
    """

    name: str
    kind: JointKind
    axis: Vector
    point: Vector
    travel: float

    def transform(self, turn: Float[np.ndarray, "3 3"], shift: Float[np.ndarray, " 3"]) -> "MovablePart":
        """Return the part of solids that were rotated or mirrored about the origin, and then moved.

        Args:
            turn: An orthogonal matrix.
            shift: Translation [m].
        """
        sense = np.sign(np.linalg.det(turn)) if self.kind == "hinge" else 1.0  # a mirror reverses the sense of rotation
        return replace(self, axis=_triple(sense * turn @ self.axis), point=_triple(turn @ self.point + shift))


def _triple(values: Float[np.ndarray, " 3"]) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
