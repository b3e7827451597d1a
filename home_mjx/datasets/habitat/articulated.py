"""Articulated furniture from URDF: one mesh, sorted by links, and the joints that move its parts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from home_mjx.datasets.gltf.decode.scene import Matrix
from home_mjx.datasets.gltf.objects import join_meshes, move_mesh
from home_mjx.datasets.gltf.scene_lights import to_vector
from home_mjx.datasets.habitat.assets import AssetStore
from home_mjx.datasets.habitat.plain.plain_assets import GREY, plain_mesh
from home_mjx.datasets.habitat.templates import path_below
from home_mjx.datasets.habitat.urdf import HINGES, UrdfJoint, UrdfLink, UrdfModel, UrdfShape
from home_mjx.datasets.shapes import Triangles, capsule_triangles, cylinder_triangles, sphere_triangles
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.taxonomy import part_kind
from home_mjx.errors import MissingFileError
from home_mjx.geometry.meshes import box_triangles
from home_mjx.schema.house import Fallback, Joint, JointKind, Material, Mesh

MIN_RANGE = 1e-4  # [rad] or [m], minimum range of a joint that moves
STRIP_WIDTH = 0.01  # [m], of the frame that doors without a frame get
Pose = Mapping[str, float]


@dataclass
class ArticulatedReader:
    """Reader of the meshes and joints of a URDF model.

    Attributes:
        model: The parsed file.
        root: Folder that contains all its meshes.
        assets: Assets of the house.
        strict: Whether a missing mesh is an error; else the link's collision shapes replace it.
        scale: Factor of all lengths.
        pose: Joint value by name of a joint [rad] or [m]; 0 for others.
        fallbacks: Meshes that were replaced.
    """

    model: UrdfModel
    root: Path
    assets: AssetStore
    strict: bool
    scale: float = 1.0
    pose: Pose = field(default_factory=dict)
    fallbacks: list[Fallback] = field(default_factory=list)

    def read(self, model_id: str) -> tuple[Mesh | None, tuple[Joint, ...]]:
        """Return the mesh in the frame of the root link, and its outermost joints; None if no link is visible.

        Raises:
            DatasetError: A mesh is broken, leads out of the root or, if strict, is missing.
        """
        parts: list[Mesh] = []
        faces: dict[str, tuple[int, int]] = {}
        frames = dict(self._frames())
        count = 0
        for name in self.model.subtree(self.model.root):
            own = [move_mesh(mesh, frames[name] @ place) for mesh, place in self._meshes(self.model.links[name])]
            parts += own
            faces[name] = count, count + sum(len(mesh.faces) for mesh in own)
            count = faces[name][1]
        if not count:
            return None, ()
        mesh, joints = join_meshes(parts), tuple(self._joints(model_id, frames, faces))
        covered = sum(last - first + 1 for joint in joints for first, last in joint.face_ranges)
        if model_id == "door" and covered == len(mesh.faces):  # the compiler moves leaves of frames alone
            mesh = join_meshes([mesh, hinge_strip(mesh, joints[0])])
        return mesh, joints

    def _frames(self) -> Iterator[tuple[str, Matrix]]:
        """Yield each link with its frame in the root link, carriers first."""
        frames = {self.model.root: np.eye(4)}
        for name in self.model.subtree(self.model.root):
            joint = self.model.joints.get(name)
            if joint is not None:
                frames[name] = frames[joint.parent] @ self._origin(joint) @ self._motion(joint)
            yield name, frames[name]

    def _origin(self, joint: UrdfJoint) -> Matrix:
        """Return the parent link from a joint, scaled."""
        matrix = joint.origin.copy()
        matrix[:3, 3] *= self.scale
        return matrix

    def _motion(self, joint: UrdfJoint) -> Matrix:
        """Return the motion of a joint to its value in the pose."""
        value = self._value(joint)
        if not joint.is_movable or value == 0:
            return np.eye(4)
        return self._record(joint, "", np.eye(4), (0, 0), -abs(value), abs(value)).matrix(value)

    def _value(self, joint: UrdfJoint) -> float:
        """Return the value of a joint in the pose [rad] or, scaled, [m]."""
        value = float(np.clip(self.pose.get(joint.name, 0.0), joint.low, joint.high))
        return value if joint.kind in HINGES else value * self.scale

    def _joints(
        self, model_id: str, frames: Mapping[str, Matrix], faces: Mapping[str, tuple[int, int]]
    ) -> Iterator[Joint]:
        """Yield the joints that move faces and that no other one moves."""
        moved: set[str] = set()
        for name in self.model.subtree(self.model.root):
            joint = self.model.joints.get(name)
            if joint is None or not joint.is_movable or name in moved:
                continue
            below = list(self.model.subtree(name))
            moved |= set(below)
            first, last = faces[name][0], max(faces[link][1] for link in below)
            factor = 1.0 if joint.kind in HINGES else self.scale
            value = self._value(joint)
            low, high = min(joint.low * factor - value, 0.0), max(joint.high * factor - value, 0.0)
            if last > first and high - low > MIN_RANGE:
                frame = frames[joint.parent] @ self._origin(joint)
                yield self._record(joint, model_id, frame, (first, last - 1), low, high)

    def _record(
        self, joint: UrdfJoint, model_id: str, frame: Matrix, run: tuple[int, int], low: float, high: float
    ) -> Joint:
        """Return the record of a joint whose frame in the root link is given; joint value 0 of the file is closed."""
        kind: JointKind = "hinge" if joint.kind in HINGES else "slide"
        axis, number = frame[:3, :3] @ joint.axis, list(self.model.joints).index(joint.child)
        return Joint(
            model_id=model_id,
            part=f"{part_kind(kind, float(axis[1]), joint.name, joint.child)}_{number}",
            kind=kind,
            axis=to_vector(axis),
            point=to_vector(frame[:3, 3]),
            low=low,
            high=high,
            face_ranges=(run,),
            closed=float(np.clip(-self._value(joint), low, high)),
        )

    def _meshes(self, link: UrdfLink) -> list[tuple[Mesh, Matrix]]:
        """Return the visible meshes of a link with their places; its collision shapes if one is missing."""
        try:
            return self._shapes(link.visuals)
        except MissingFileError as error:
            if self.strict:
                raise
            solids = tuple(shape for shape in link.collisions if shape.kind != "mesh")
            words = "its collision shapes" if solids else "left out"
            element = f"{self.model.path.name}: link[{link.name}]"
            self.fallbacks.append(Fallback("model", Path(str(error.file)).name, element, words, error.message))
            return self._shapes(solids)

    def _shapes(self, shapes: Sequence[UrdfShape]) -> list[tuple[Mesh, Matrix]]:
        """Return shapes as meshes with their places, scaled."""
        found = []
        for shape in shapes:
            mesh = self._mesh(shape)
            if mesh is not None and len(mesh.faces):
                factors = np.array(shape.size if shape.kind == "mesh" else (1.0, 1.0, 1.0)) * self.scale
                place = shape.origin.copy()
                place[:3, 3] *= self.scale
                place[:3, :3] = place[:3, :3] @ np.diag(factors)
                found.append((mesh, place))
        return found

    def _mesh(self, shape: UrdfShape) -> Mesh | None:
        """Return the mesh of a shape, not scaled; None for one without volume."""
        if shape.kind == "mesh":
            if not all(shape.size):
                raise shape.file.error("mesh is scaled by 0")
            mesh = self.assets.mesh(path_below(self.root, self.model.path.parent, shape.file))
            return None if mesh is None else replace(mesh, path=self.model.path, materials=_painted(mesh, shape))
        if min(shape.size) <= 0:
            return None
        mesh = plain_mesh(self.model.path, solid_triangles(shape), GREY)
        return replace(mesh, materials=_painted(mesh, shape))


def _painted(mesh: Mesh, shape: UrdfShape) -> tuple[Material, ...]:
    """Return the materials of a mesh, with the colour of its shape in place of `GREY`."""
    if shape.rgba is None:
        return mesh.materials
    red, green, blue, opacity = shape.rgba
    paint = Material("paint", (red, green, blue), None, opacity)
    return tuple(paint if material == GREY else material for material in mesh.materials)


def wall_frame(mesh: Mesh, joints: Sequence[Joint]) -> Matrix:
    """Return the model from the frame of a door: x along its closed first leaf, y up, the origin in its middle.

    The compiler takes that frame's x axis as the direction of the wall.
    """
    leaf = joints[0].move(mesh, joints[0].closed)
    plan = leaf.vertices[np.unique(leaf.faces[joints[0].faces])][:, [0, 2]]
    way = np.linalg.svd(plan - plan.mean(axis=0), full_matrices=False)[2][0]
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 2] = (way[0], 0, way[1]), (-way[1], 0, way[0])
    local = plan @ matrix[[0, 2]][:, [0, 2]]
    middle = matrix[[0, 2]][:, [0, 2]] @ ((local.min(axis=0) + local.max(axis=0)) / 2)
    matrix[[0, 2], 3] = middle
    return matrix


def move_joint(joint: Joint, matrix: Matrix) -> Joint:
    """Return a joint in another frame, by a rigid transform."""
    point = matrix[:3, :3] @ np.array(joint.point) + matrix[:3, 3]
    return replace(joint, axis=to_vector(matrix[:3, :3] @ np.array(joint.axis)), point=to_vector(point))


def hinge_strip(mesh: Mesh, joint: Joint) -> Mesh:
    """Return a strip along a joint's axis, as long as a mesh: the frame of a door that consists of leaves alone."""
    axis = np.array(joint.axis)
    along = (mesh.vertices - joint.point) @ axis
    low, high = float(along.min()), float(along.max())
    other = np.eye(3)[int(abs(axis).argmin())]
    side = np.cross(axis, other) / np.linalg.norm(np.cross(axis, other))
    turn = np.stack([side, np.cross(axis, side), axis], axis=1)
    box = box_triangles(np.array([0, 0, (low + high) / 2]), np.array([STRIP_WIDTH, STRIP_WIDTH, high - low]) / 2)
    return plain_mesh(mesh.path, box @ turn.T + joint.point, GREY)


def solid_triangles(shape: UrdfShape) -> Triangles:
    """Return the triangles of a box, cylinder, sphere or capsule in its frame [m]."""
    if shape.kind == "box":
        return box_triangles(np.zeros(3), np.array(shape.size) / 2)
    if shape.kind == "sphere":
        return sphere_triangles(shape.size[0])
    radius, length = shape.size
    return (cylinder_triangles if shape.kind == "cylinder" else capsule_triangles)(radius, length / 2)


def read_pose(value: JsonValue, model: UrdfModel) -> Pose:
    """Return the joint values of `initial_joint_pose`: a list in the order of the movable joints, or by name.

    Raises:
        DatasetError: It is neither, or a value is not finite.
    """
    if not value.has_value:
        return {}
    names = [joint.name for joint in model.joints.values() if joint.is_movable]
    if isinstance(value.data, dict):
        return {name: value.member(name).coordinate() for name in value.data if name in names}
    return {name: one.coordinate() for name, one in zip(names, value.entries(), strict=False)}
