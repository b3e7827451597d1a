"""Doors split into a static frame and leaves that turn on hinges or slide on rails."""

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.box_fit import narrowest_box, triangle_components
from home_mjx.geometry.boxes import BoxSet, rotate_boxes
from home_mjx.geometry.meshes import compose, make_model, transform
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.hinges import find_hinges
from home_mjx.schema.compiled import Model

MIN_WIDE_ANGLE = np.pi / 2  # [rad], minimum opening angle of every door; SUNCG's open variants are only half open
MAX_HINGE_TILT = 1e-3  # maximum tilt of a hinge, and maximum non-uniform stretch in the plan


@dataclass(frozen=True)
class LeafPart:
    """A door leaf in its model's frame: its hinge or rail, and its range."""

    model: Model
    pivot: Float[np.ndarray, "2"]  # [m]
    closed: float  # [rad] or [m], relative to the pose shown
    wide_open: float  # [rad] or [m], wide open, relative to the pose shown
    slide: Float[np.ndarray, "2"]  # unit direction; 0: the leaf turns


@dataclass(frozen=True)
class DoorVariants:
    """A door in the variant that is shown and in the other one; equal keys have equal parts."""

    key: str
    other_path: Path
    is_closed: bool
    initial: Model = field(compare=False)
    other: Float[np.ndarray, "s 3 3"] = field(compare=False)  # [m], triangles, Z up


@lru_cache(maxsize=256)
def split_door(door: DoorVariants) -> tuple[Model, tuple[LeafPart, ...]]:
    """Return the frame and the leaves of a door; the whole door and no leaves if no hinge is found."""
    hinges = find_hinges(door.initial.triangle.astype(np.float64), door.other)
    frame = ~np.any([hinge.leaf for hinge in hinges], axis=0)
    if not hinges or not frame.any():
        return door.initial, ()
    leaves = []
    for hinge in hinges:
        closed = 0.0 if door.is_closed else hinge.displacement
        opens = np.sign(hinge.displacement) * (1 if door.is_closed else -1)
        wide = closed + opens * (
            abs(hinge.displacement) if hinge.slide.any() else max(abs(hinge.displacement), MIN_WIDE_ANGLE)
        )
        model = _cut_out(door.initial, hinge.leaf, "leaf")
        leaves.append(LeafPart(model, hinge.pivot, closed, float(wide), hinge.slide))
    return _cut_out(door.initial, frame, "frame"), tuple(leaves)


def _cut_out(model: Model, kept: Bool[np.ndarray, " t"], name: str) -> Model:
    stem = model.key.split(":")[0]
    return make_model(f"{stem}/{name}", model.triangle[kept], model.uv[kept], model.slot[kept], model.part[kept])


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

    @property
    def slides(self) -> bool:
        """True if the leaf slides, False if it turns."""
        return bool(self.slide.any())

    def box_at(self, way: float) -> BoxSet:
        """Return its box moved from the initial pose by an angle [rad] or, for a sliding leaf, a distance [m]."""
        if not self.slides:
            return rotate_boxes(self.box, way, self.pivot)
        return replace(self.box, center=self.box.center + way * np.array([*self.slide, 0.0]))

    def pose_at(self, way: float, pose: Float[np.ndarray, "3 4"]) -> Float[np.ndarray, "3 4"]:
        """Apply the same motion to a pose of its instance."""
        if self.slides:
            return pose + np.c_[np.zeros((3, 3)), way * np.array([*self.slide, 0.0])]
        turn, line = yaw_matrix(way), np.array([*self.pivot, 0.0])
        return compose(np.c_[turn, line - turn @ line], pose)


def place_leaf(leaf: LeafPart, pose: Float[np.ndarray, "3 4"], instance: int) -> PlacedLeaf:
    """Place a leaf in the world; mirrored poses reverse its rotation, and scaled ones scale its sliding distance.

    Args:
        leaf: Leaf in its model's frame.
        pose: World from model [m].
        instance: Its instance in the house.
    """
    box, slide = _leaf_box(leaf.model, pose), pose[:2, :2] @ leaf.slide
    if leaf.slide.any():
        scale = float(np.linalg.norm(slide))
        return PlacedLeaf(instance, box.center[0, :2], scale * leaf.closed, scale * leaf.wide_open, box, slide / scale)
    turn = float(np.sign(np.linalg.det(pose[:2, :2])))
    pivot = transform(pose, np.array([*leaf.pivot, 0.0]))[:2]
    return PlacedLeaf(instance, pivot, turn * leaf.closed, turn * leaf.wide_open, box)


def _leaf_box(leaf: Model, pose: Float[np.ndarray, "3 4"]) -> BoxSet:
    """Return the narrowest box around the largest connected piece of a leaf, without handles, in the world."""
    triangles = transform(pose, leaf.triangle.astype(np.float64))
    piece = triangle_components(triangles)
    boxes = [narrowest_box(triangles[piece == p].reshape(-1, 3)) for p in np.unique(piece)]
    return max(boxes, key=lambda box: float(box.half.prod()))
