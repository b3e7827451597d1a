"""Hinges and slides of scenes: parts of objects that move, and those that the package's own GLB export states."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.decode.scene import Matrix, PlacedMesh
from home_mjx.datasets.gltf.objects import FoundObject, upright
from home_mjx.datasets.gltf.scene_lights import to_vector
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE
from home_mjx.datasets.taxonomy import part_kind
from home_mjx.schema.house import Joint, JointKind

OWNER, JOINT = "object_id", "joint"  # entries of `extras` of the package's own export
OTHERS = frozenset(("category", "model"))  # its other entries, by which it is told from other programs' object ids
KINDS: Mapping[str, JointKind] = {"hinge": "hinge", "slide": "slide"}
MIN_RANGE = 1e-4  # [rad] or [m], minimum range of a joint that moves


@dataclass(frozen=True)
class SceneJoint:
    """A hinge or slide in the house; joint value 0 is the pose shown.

    Attributes:
        kind: Motion.
        axis: Unit vector.
        point: A point on the axis [m].
        low: Minimum [rad] or [m], at most 0.
        high: Maximum [rad] or [m], at least 0.
        closed: Value of the closed pose.
        names: Names of the joint and of its part, which tell the kind of the part.
    """

    kind: JointKind
    axis: Float[np.ndarray, "3"]
    point: Float[np.ndarray, "3"]
    low: float
    high: float
    closed: float = 0.0
    names: tuple[str, ...] = ()

    def joint(self, model_id: str, number: int, run: tuple[int, int], matrix: Matrix) -> Joint:
        """Return the joint of a model that moves the faces of a run.

        Args:
            model_id: Id of the model.
            number: Number of the part in its model.
            run: First and last face.
            matrix: House from model; mirrors reverse hinges, and scales change distances.
        """
        back = np.linalg.inv(matrix)
        axis, scale = back[:3, :3] @ self.axis, 1.0
        if self.kind == "slide":
            scale = float(np.linalg.norm(axis))
        elif np.linalg.det(matrix[:3, :3]) < 0:
            axis = -axis
        return Joint(
            model_id=model_id,
            part=f"{part_kind(self.kind, float(self.axis[1]), *self.names)}_{number}",
            kind=self.kind,
            axis=to_vector(axis / np.linalg.norm(axis)),
            point=to_vector(back[:3, :3] @ self.point + back[:3, 3]),
            low=self.low * scale,
            high=self.high * scale,
            face_ranges=(run,),
            closed=self.closed * scale,
        )


@dataclass
class JointedObject(FoundObject):
    """An object with parts that move; their meshes are the last ones of `meshes`.

    Attributes:
        parts: Each joint with the number of meshes that it moves, in their order.
    """

    parts: tuple[tuple[SceneJoint, int], ...] = ()

    @property
    def matrix(self) -> Matrix:
        """House from object: that of its node, or its origin alone if the node is stretched or has shear."""
        found, plain = upright(self.node.matrix), np.eye(4)
        square = found[:3, :3].T @ found[:3, :3]
        plain[:3, 3] = found[:3, 3]
        return found if np.allclose(square, square[0, 0] * np.eye(3), rtol=1e-6, atol=1e-9) else plain

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Movable parts of its mesh."""
        ends = np.cumsum([0, *(len(item.mesh.faces) for item in self.meshes)])
        first, found = len(self.meshes) - sum(count for _, count in self.parts), []
        for number, (joint, count) in enumerate(self.parts):
            run = int(ends[first]), int(ends[first + count]) - 1
            found.append(joint.joint(self.fine, number, run, self.matrix))
            first += count
        return tuple(found)


def with_parts(one: FoundObject, parts: Iterable[tuple[SceneJoint, Sequence[PlacedMesh]]]) -> FoundObject:
    """Return an object with parts that move, whose meshes it does not have yet; unchanged without any."""
    moving = [(joint, list(meshes)) for joint, meshes in parts if meshes]
    if not moving:
        return one
    meshes = [*one.meshes, *(mesh for _, own in moving for mesh in own)]
    counts = tuple((joint, len(own)) for joint, own in moving)
    return JointedObject(one.node, one.fine, meshes, extra=one.extra, parts=counts)


def join_exported_parts(objects: Sequence[FoundObject], frame: Matrix) -> list[FoundObject]:
    """Return objects of which those that the package's own export wrote as several nodes are one, with their joints.

    Such nodes have `object_id`, `category` and `model` in their `extras`, and those of leaves also `joint`. Other
    entries are ignored.

    Args:
        objects: The objects.
        frame: House from the document's frame.
    """
    bodies: dict[int, FoundObject] = {}
    parts: dict[int, list[tuple[SceneJoint, Sequence[PlacedMesh]]]] = {}
    found = []
    for one in objects:
        owner, joint = exported_owner(one.node.extras), exported_joint(one.node.extras, frame)
        body = bodies.get(owner)
        if body is None or body.fine != one.fine:
            found.append(one)
            if owner >= 0 and joint is None:
                bodies[owner] = one
        elif joint is None:
            body.meshes += one.meshes
        else:
            parts.setdefault(owner, []).append((joint, one.meshes))
    owners = {id(body): owner for owner, body in bodies.items()}
    return [with_parts(one, parts.get(owners.get(id(one), -1), ())) for one in found]


def exported_owner(extras: Any) -> int:
    """Return the object id in the `extras` of a node of the package's own export; -1 without one."""
    owner = extras.get(OWNER) if isinstance(extras, dict) and extras.keys() >= OTHERS else None
    return owner if type(owner) is int and owner >= 0 else -1


def exported_joint(extras: Any, frame: Matrix) -> SceneJoint | None:
    """Return the joint in the `extras` of a node, in the house; None without one, or for entries of another form.

    Its range is from the closed pose to the open one, and has the pose shown.
    """
    value = extras.get(JOINT) if isinstance(extras, dict) else None
    kind = KINDS.get(str(value.get("type"))) if isinstance(value, dict) else None
    if kind is None or not isinstance(value, dict):
        return None
    axis, point = (_numbers(value.get(key), 3) for key in ("axis", "point"))
    limits, closed, opened = (_numbers(value.get(k), n) for k, n in (("range", 2), ("closed", 0), ("open", 0)))
    if axis is None or point is None or limits is None or closed is None or not np.linalg.norm(axis) > 1e-6:
        return None
    ends = [0.0, *closed.tolist(), *(limits if opened is None else opened).tolist()]
    unit = float(np.linalg.norm(frame[:3, 0])) if kind == "slide" else 1.0
    axis = frame[:3, :3] @ axis
    low, high, closed = (unit * value for value in (min(ends), max(ends), ends[1]))
    if high - low <= MIN_RANGE:
        return None
    return SceneJoint(kind, axis / np.linalg.norm(axis), frame[:3, :3] @ point + frame[:3, 3], low, high, closed)


def _numbers(value: Any, count: int) -> Float[np.ndarray, " n"] | None:
    """Return a list of `count` finite numbers, or one number if `count` is 0, as an array; None for other values."""
    values = value if count else [value]
    if not isinstance(values, list) or len(values) != max(count, 1):
        return None
    if not all(type(number) in (int, float) and abs(number) <= MAX_COORDINATE for number in values):
        return None
    return np.array(values, float)
