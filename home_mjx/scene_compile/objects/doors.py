"""Doors split into a static frame and leaves that turn on hinges or slide on rails."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.kept_results import find_model
from home_mjx.geometry.box_fit import narrowest_box, triangle_components
from home_mjx.geometry.boxes import (
    BoxSet,
    bounding_box,
    concat_boxes,
    empty_boxes,
    make_boxes,
    rotate_boxes,
    thicken_boxes,
)
from home_mjx.geometry.meshes import compose, make_model, transform, tree_order, triangles_z_up
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.schema.compiled import Model
from home_mjx.schema.house import Joint, Mesh

MIN_LEAF_HALF = 1e-3  # [m], minimum half extent of a leaf's box, which has a mass
MAX_HINGE_TILT = 1e-3  # maximum tilt of a hinge, and maximum non-uniform stretch in the plan


@dataclass(frozen=True)
class LeafPart:
    """A door leaf in its model's frame: its hinge or rail, and its range."""

    model: Model
    pivot: Float[np.ndarray, "2"]  # [m]
    closed: float  # [rad] or [m], relative to the pose shown
    wide_open: float  # [rad] or [m], wide open, relative to the pose shown
    slide: Float[np.ndarray, "2"]  # unit direction; 0: the leaf turns
    is_front: bool = False  # of a piece of furniture
    board: Model | None = None  # of a drawer: its front alone
    tray: Float[np.ndarray, "n 2 3"] | None = None  # [m], minimum and maximum of the boxes of a drawer behind its front


@dataclass(frozen=True)
class JointedDoor:
    """A door with joints; equal keys and joints have equal parts."""

    key: str
    joints: tuple[Joint, ...]
    model: Model = field(compare=False)
    mesh: Mesh = field(compare=False)  # mesh of the model, whose faces the joints name


@lru_cache(maxsize=256)
def split_door(door: JointedDoor) -> tuple[Model, tuple[LeafPart, ...]]:
    """Return the frame and the leaves of a door; the whole door and no leaves if it cannot be split.

    That is so if no joint moves in the plan, or if all triangles belong to leaves. Leaves of joints that do not move in
    the plan stay in the frame.
    """
    order = tree_order(triangles_z_up(door.mesh))
    joints = [joint for joint in door.joints if moves_in_plan(joint)]
    faces = [np.isin(order, joint.faces) for joint in joints]
    if not joints or np.any(faces, axis=0).all():
        return door.model, ()
    return cut_leaves(door.model, joints, faces)


def cut_leaves(
    model: Model, joints: Sequence[Joint], faces: Sequence[Bool[np.ndarray, " t"]]
) -> tuple[Model, tuple[LeafPart, ...]]:
    """Return what remains of a model without its leaves, and the leaves.

    Args:
        model: The model.
        joints: Joint of each leaf, at least one.
        faces: Triangles of each leaf; some must belong to none.
    """
    parts = tuple(_leaf_part(j, _cut_out(model, own, "leaf")) for j, own in zip(joints, faces, strict=True))
    return _cut_out(model, ~np.any(faces, axis=0), "frame"), parts


def moves_in_plan(joint: Joint) -> bool:
    """Return whether a joint (Y up, as in the file) is a vertical hinge or a horizontal slide."""
    upright = abs(joint.axis[1])
    return upright <= MAX_HINGE_TILT if joint.kind == "slide" else upright >= 1 - MAX_HINGE_TILT


def _leaf_part(joint: Joint, model: Model) -> LeafPart:
    """Return a leaf with the hinge or slide of a joint, converted from Y up to Z up; angles become those about +z."""
    pivot = np.array([joint.point[0], -joint.point[2]])  # the file's axes are x and -z in the plan
    if joint.kind == "slide":
        return LeafPart(model, pivot, joint.closed, joint.open, np.array([joint.axis[0], -joint.axis[2]]))
    turn = float(np.sign(joint.axis[1]))
    return LeafPart(model, pivot, turn * joint.closed, turn * joint.open, np.zeros(2))


def _cut_out(model: Model, kept: Bool[np.ndarray, " t"], name: str) -> Model:
    """Return the model of some triangles, `<stem>/<name>`, with their normals; kept models are reused."""
    stem = model.key.split(":")[0]
    arrays = (values[kept] for values in (model.triangle, model.uv, model.slot, model.part, model.normal))
    return make_model(f"{stem}/{name}", *arrays, find=find_model)


def is_hinge_preserving(pose: Float[np.ndarray, "3 4"]) -> bool:
    """Return whether a pose keeps vertical lines vertical and horizontal circles circular."""
    linear = pose[:, :3] / np.linalg.norm(pose[:, 0])
    upright = np.abs([*linear[:2, 2], *linear[2, :2]]).max() <= MAX_HINGE_TILT
    return bool(upright and np.abs(linear[:2, :2].T @ linear[:2, :2] - np.eye(2)).max() <= MAX_HINGE_TILT)


@dataclass(frozen=True)
class PlacedLeaf:
    """A door leaf in the world frame."""

    instance: int
    pivot: Float[np.ndarray, "2"]  # [m]
    closed: float  # [rad] about +z or [m], relative to the initial pose
    wide_open: float  # [rad] or [m], wide open, relative to the initial pose
    box: BoxSet  # in the initial pose
    slide: Float[np.ndarray, "2"] = field(default_factory=lambda: np.zeros(2))  # unit direction; 0: the leaf turns
    is_front: bool = False  # of a piece of furniture
    tray: BoxSet = field(default_factory=empty_boxes)  # of a drawer, in the initial pose, with the yaw of `box`

    @property
    def slides(self) -> bool:
        """True if the leaf slides, False if it turns."""
        return bool(self.slide.any())

    def box_at(self, way: float) -> BoxSet:
        """Return its box moved from the initial pose by an angle [rad] or, for a sliding leaf, a distance [m]."""
        if not self.slides:
            return rotate_boxes(self.box, way, self.pivot)
        return replace(self.box, center=self.box.center + way * np.array([*self.slide, 0.0]))

    def boxes_at(self, ways: Float[np.ndarray, " w"]) -> BoxSet:
        """Return its boxes at several angles [rad] or distances [m], see `box_at`, up to rounding errors."""
        (x, y, z), (px, py) = self.box.center[0], self.pivot
        if self.slides:
            x, y, turn = x + ways * self.slide[0], y + ways * self.slide[1], 0.0 * ways
        else:
            turn, c, s = ways, np.cos(ways), np.sin(ways)
            x, y = px + c * (x - px) - s * (y - py), py + s * (x - px) + c * (y - py)
        return make_boxes(np.stack([x, y, np.full(len(ways), z)], axis=1), self.box.half, self.box.yaw + turn)

    def pose_at(self, way: float, pose: Float[np.ndarray, "3 4"]) -> Float[np.ndarray, "3 4"]:
        """Return its instance's initial pose moved by an angle [rad] or, for a sliding leaf, a distance [m]."""
        if self.slides:
            return pose + np.c_[np.zeros((3, 3)), way * np.array([*self.slide, 0.0])]
        turn, line = yaw_matrix(way), np.array([*self.pivot, 0.0])
        return compose(np.c_[turn, line - turn @ line], pose)


def place_leaf(leaf: LeafPart, pose: Float[np.ndarray, "3 4"], instance: int) -> PlacedLeaf:
    """Place a leaf in the world by the pose (world from model) of its door.

    Mirrored poses reverse its rotation, and scaled ones scale its sliding distance.
    """
    box, slide = (_front_box if leaf.is_front else _leaf_box)(leaf.board or leaf.model, pose), pose[:2, :2] @ leaf.slide
    if leaf.slide.any():
        scale = float(np.linalg.norm(slide))
        tray = empty_boxes() if leaf.tray is None else place_boxes(leaf.tray, pose, float(box.yaw[0]))
        ends, way = (scale * leaf.closed, scale * leaf.wide_open), slide / scale
        return PlacedLeaf(instance, box.center[0, :2], *ends, box, way, is_front=leaf.is_front, tray=tray)
    turn = float(np.sign(np.linalg.det(pose[:2, :2])))
    pivot = transform(pose, np.array([*leaf.pivot, 0.0]))[:2]
    closed, wide = turn * leaf.closed, turn * leaf.wide_open
    return PlacedLeaf(instance, pivot, closed, wide, box, is_front=leaf.is_front)


def place_boxes(boxes: Float[np.ndarray, "n 2 3"], pose: Float[np.ndarray, "3 4"], yaw: float) -> BoxSet:
    """Return boxes of yaw `yaw` [rad] around boxes of a model (minimum, maximum [m]), placed in the world by `pose`."""
    corner = np.indices((2, 2, 2)).reshape(3, -1).T
    return concat_boxes(bounding_box(transform(pose, box[corner, np.arange(3)]), yaw) for box in boxes)


def _leaf_box(leaf: Model, pose: Float[np.ndarray, "3 4"]) -> BoxSet:
    """Return the narrowest box, in the world, of the connected piece of a leaf whose box is largest, without handles.

    A leaf without thickness has a box of 2 mm.
    """
    return max((box for _, box in _piece_boxes(leaf, pose)), key=lambda box: float(box.half.prod()))


def _piece_boxes(leaf: Model, pose: Float[np.ndarray, "3 4"]) -> list[tuple[Float[np.ndarray, "n 3"], BoxSet]]:
    """Return the points of each connected piece of a leaf in the world, and their narrowest box."""
    triangles = transform(pose, leaf.triangle.astype(np.float64))
    piece = triangle_components(triangles)
    pieces = [triangles[piece == p].reshape(-1, 3) for p in np.unique(piece)]
    return [(points, thicken_boxes(narrowest_box(points), MIN_LEAF_HALF)) for points in pieces]


def _front_box(front: Model, pose: Float[np.ndarray, "3 4"]) -> BoxSet:
    """Return the box around the board of a front, in the world: frame and panel, without handles and what is on it.

    These are the pieces that overlap the largest one in thickness.
    """
    pieces = _piece_boxes(front, pose)
    board = max((box for _, box in pieces), key=lambda box: float(box.half.prod()))
    yaw = float(board.yaw[0])
    across = yaw_matrix(yaw)[:, int(board.half[0, :2].argmin())]
    middle, half = float(board.center[0] @ across), float(board.half[0, :2].min())
    depths = [points @ across - middle for points, _ in pieces]
    own = [p for (p, _), d in zip(pieces, depths, strict=True) if d.min() < half - 1e-3 and d.max() > 1e-3 - half]
    return thicken_boxes(bounding_box(np.concatenate(own), yaw), MIN_LEAF_HALF)
