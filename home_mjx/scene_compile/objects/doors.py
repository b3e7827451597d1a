"""Doors taken apart: a frame that stays, and leaves that turn on their hinges or slide."""

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.box_fit import components, narrowest_box
from home_mjx.geometry.boxes import BoxSet, turned
from home_mjx.geometry.meshes import compose, make_model, transform
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.hinges import find_hinges
from home_mjx.schema.compiled import Model

WIDE = np.pi / 2  # [rad]: every door opens at least as far; SUNCG's stand half open
LEAN = 1e-3  # most that a hinge may lean, and that the plan may be stretched


@dataclass(frozen=True)
class HingedPart:
    """A leaf of a door in its model's frame: its hinge or its direction, and how far it turns or slides."""

    model: Model
    pivot: Float[np.ndarray, "2"]  # [m]
    closed: float  # [rad] or [m], from where it is shown
    wide: float
    slide: Float[np.ndarray, "2"]  # unit direction; 0: it turns


@dataclass(frozen=True)
class DoorModel:
    """A door as it is shown and its other state; equal keys have equal parts."""

    key: str
    other_path: Path
    is_closed: bool
    shown: Model = field(compare=False)
    other: Float[np.ndarray, "s 3 3"] = field(compare=False)  # [m], triangles, Z up


@lru_cache(maxsize=256)
def take_apart(door: DoorModel) -> tuple[Model, tuple[HingedPart, ...]]:
    """The frame and the leaves; the whole door and none where no hinge was found."""
    hinges = find_hinges(door.shown.triangle.astype(np.float64), door.other)
    frame = ~np.any([hinge.leaf for hinge in hinges], axis=0)
    if not hinges or not frame.any():
        return door.shown, ()
    leaves = []
    for hinge in hinges:
        closed = 0.0 if door.is_closed else hinge.turn
        opens = np.sign(hinge.turn) * (1 if door.is_closed else -1)
        wide = closed + opens * (abs(hinge.turn) if hinge.slide.any() else max(abs(hinge.turn), WIDE))
        model = _cut_out(door.shown, hinge.leaf, "leaf")
        leaves.append(HingedPart(model, hinge.pivot, closed, float(wide), hinge.slide))
    return _cut_out(door.shown, frame, "frame"), tuple(leaves)


def _cut_out(model: Model, kept: Bool[np.ndarray, " t"], name: str) -> Model:
    stem = model.key.split(":")[0]
    return make_model(f"{stem}/{name}", model.triangle[kept], model.uv[kept], model.slot[kept], model.part[kept])


def keeps_hinges(pose: Float[np.ndarray, "3 4"]) -> bool:
    """Whether vertical lines stay vertical and circles around them round."""
    linear = pose[:, :3] / np.linalg.norm(pose[:, 0])
    upright = np.abs([*linear[:2, 2], *linear[2, :2]]).max() <= LEAN
    return bool(upright and np.abs(linear[:2, :2].T @ linear[:2, :2] - np.eye(2)).max() <= LEAN)


@dataclass(frozen=True)
class Leaf:
    """A leaf in the world."""

    instance: int
    pivot: Float[np.ndarray, "2"]  # [m]
    closed: float  # [rad] about +z or [m], from where it stands
    wide: float
    box: BoxSet  # as it stands
    slide: Float[np.ndarray, "2"] = field(default_factory=lambda: np.zeros(2))  # unit direction; 0: it turns

    @property
    def slides(self) -> bool:
        """Whether it slides; or else it turns."""
        return bool(self.slide.any())

    def box_at(self, way: float) -> BoxSet:
        """Its box, moved from where it stands by an angle [rad] or, if it slides, a distance [m]."""
        if not self.slides:
            return turned(self.box, way, self.pivot)
        return replace(self.box, center=self.box.center + way * np.array([*self.slide, 0.0]))

    def pose_at(self, way: float, pose: Float[np.ndarray, "3 4"]) -> Float[np.ndarray, "3 4"]:
        """A pose of its instance, moved likewise."""
        if self.slides:
            return pose + np.c_[np.zeros((3, 3)), way * np.array([*self.slide, 0.0])]
        turn, line = yaw_matrix(way), np.array([*self.pivot, 0.0])
        return compose(np.c_[turn, line - turn @ line], pose)


def place_leaf(leaf: HingedPart, pose: Float[np.ndarray, "3 4"], instance: int) -> Leaf:
    """A leaf of an object at a pose; in a mirrored one it turns the other way round, in a larger one it slides farther.

    Args:
        leaf: In its model's frame.
        pose: World from model [m].
        instance: Its instance in the house.
    """
    box, slide = _leaf_box(leaf.model, pose), pose[:2, :2] @ leaf.slide
    if leaf.slide.any():
        scale = float(np.linalg.norm(slide))
        return Leaf(instance, box.center[0, :2], scale * leaf.closed, scale * leaf.wide, box, slide / scale)
    turn = float(np.sign(np.linalg.det(pose[:2, :2])))
    pivot = transform(pose, np.array([*leaf.pivot, 0.0]))[:2]
    return Leaf(instance, pivot, turn * leaf.closed, turn * leaf.wide, box)


def _leaf_box(leaf: Model, pose: Float[np.ndarray, "3 4"]) -> BoxSet:
    """The narrowest box around the largest piece of a leaf, so without its handles, in the world."""
    triangles = transform(pose, leaf.triangle.astype(np.float64))
    piece = components(triangles)
    boxes = [narrowest_box(triangles[piece == p].reshape(-1, 3)) for p in np.unique(piece)]
    return max(boxes, key=lambda box: float(box.half.prod()))
