"""Joints of library models: the faces of a drawer, door or lid, and their motion."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from home_mjx.errors import ConfigError
from home_mjx.schema.house import Mesh

JointKind = Literal["hinge", "slide"]
JOINT_KINDS: tuple[str, ...] = get_args(JointKind)
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Joint:
    """A movable part of a library model, in the model's own Y-up frame; joint value 0 is the pose in the OBJ.

    Example:
        >>> door = Joint("home_x_1", "door_1", "hinge", (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), 0.0, 1.5, ((0, 1), (4, 4)))
        >>> door.faces.tolist()
        [0, 1, 4]
    """

    model_id: str
    part: str  # such as `drawer_2`: kind of part, and a number unique in its model
    kind: JointKind
    axis: Vector  # unit vector; right-handed rotation of a hinge, direction of a slide
    point: Vector  # [m], a point on the axis of a hinge or on the front of a slide
    low: float  # hinge [rad], slide [m]; minimum, at most 0
    high: float
    face_ranges: tuple[tuple[int, int], ...]  # first and last face of each run, as 0-based `f` lines of the OBJ

    @cached_property
    def faces(self) -> Int[np.ndarray, " n"]:
        """Indices of its faces in a mesh read from the model's OBJ."""
        return np.concatenate([np.arange(first, last + 1) for first, last in self.face_ranges])

    def matrix(self, value: float) -> Float[np.ndarray, "4 4"]:
        """Return the rigid motion from the pose in the OBJ to a joint value.

        Args:
            value: Angle [rad] or displacement [m].

        Raises:
            ConfigError: The value is outside the joint's range.
        """
        if not self.low <= value <= self.high:
            hint = f"Its range is {self.low:g} to {self.high:g}."
            raise ConfigError(f"{self.model_id} {self.part} has no joint value {value!r:.40}", hint=hint)
        motion = np.eye(4)
        if self.kind == "slide":
            motion[:3, 3] = value * np.asarray(self.axis)
        else:
            motion[:3, :3] = _turn(np.asarray(self.axis), value)
            motion[:3, 3] = np.asarray(self.point) - motion[:3, :3] @ np.asarray(self.point)
        return motion

    def move(self, mesh: Mesh, value: float) -> Mesh:
        """Return the model with this part moved; call it once per part to move several parts.

        Args:
            mesh: The model as read from its OBJ, with faces in file order.
            value: Angle [rad] or displacement [m].

        Raises:
            ConfigError: The value is out of range, or the mesh lacks faces of the part.
        """
        if self.face_ranges[-1][1] >= len(mesh.faces):
            raise ConfigError(f"{self.model_id} {self.part} has faces that the mesh lacks", hint="Is it another model?")
        motion, vertices = self.matrix(value), mesh.vertices.copy()
        own = np.unique(mesh.faces[self.faces])
        vertices[own] = vertices[own] @ motion[:3, :3].T + motion[:3, 3]
        return replace(mesh, vertices=vertices, normal=_turned(mesh, self.faces, motion[:3, :3]))


Joints = Mapping[str, tuple[Joint, ...]]  # by model id


def _turn(axis: Float[np.ndarray, " 3"], angle: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation about a unit vector by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def _turned(mesh: Mesh, faces: Int[np.ndarray, " n"], turn: Float[np.ndarray, "3 3"]) -> np.ndarray | None:
    if mesh.normal is None:
        return None
    normal = mesh.normal.copy()
    normal[faces] = normal[faces] @ turn.T
    return normal
