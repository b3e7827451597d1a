"""Collision boxes on a level of a house: walls around their openings, doors, furniture."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.core.checks import check_number
from home_mjx.datasets.kept_results import kept_result
from home_mjx.geometry.box_fit import fit_boxes, narrowest_box, triangle_components
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, footprint
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.architecture.shell import BuildingShell, WallPart
from home_mjx.scene_compile.architecture.slabs import wall_boxes
from home_mjx.scene_compile.objects.compartments import carve_boxes
from home_mjx.scene_compile.objects.doorways import PORTAL_CATEGORIES
from home_mjx.scene_compile.objects.placed_objects import PlacedObject

PASSABLE_CATEGORIES = ("curtain", "rug")  # categories without colliders: agents walk through or over them
MAX_FITTING_SIZE = 0.2  # [m], parts of a door up to this size are handles or hinges and get no box
MAX_SILL_HEIGHT = 0.04  # [m] above the floor; parts of a door below this are its sill, which agents step over
MIN_LEAF_HEIGHT = 1.0  # [m], minimum height of a door leaf
MIN_WALL_PIECE, MAX_BOXES_PER_OBJECT = 0.1, 256  # [m], minimum of `max_wall_length`; maximum of the boxes per object
MIN_OPEN_LEAF_ANGLE = np.deg2rad(3.0)  # minimum angle of an open leaf to its wall


@dataclass(frozen=True)
class ColliderOptions:
    """Options of collision boxes.

    Attributes:
        max_bottom_height: Boxes that begin higher above the level's floor are omitted [m].
        min_top_height: Boxes that end lower above the level's floor are omitted [m].
        max_wall_length: Maximum length of one piece of a wall [m].
        max_boxes_per_object: Maximum number of boxes per object.

    Raises:
        ConfigError: A value is out of range.
    """

    max_bottom_height: float = 2.0
    min_top_height: float = 0.03
    max_wall_length: float = 1.5
    max_boxes_per_object: int = 8

    def __post_init__(self) -> None:
        check_number("max_bottom_height", self.max_bottom_height, 0)
        check_number("min_top_height", self.min_top_height, 0)
        check_number("max_wall_length", self.max_wall_length, MIN_WALL_PIECE)
        check_number("max_boxes_per_object", self.max_boxes_per_object, 1, MAX_BOXES_PER_OBJECT, integer=True)


def wall_colliders(shell: BuildingShell, options: ColliderOptions) -> BoxSet:
    """Return the boxes of all walls of all levels in one set; each physical wall is solid except for its openings.

    Of `options` only `max_wall_length` counts; there are no height limits.
    """
    walls: dict[int, list] = {}
    for part, partition in zip(shell.parts, shell.partition, strict=True):
        if isinstance(part, WallPart):
            walls.setdefault(int(partition), []).append(part.slab)
    return concat_boxes(wall_boxes(slabs, options.max_wall_length) for slabs in walls.values())


def object_colliders(item: PlacedObject, floor: float, options: ColliderOptions) -> tuple[BoxSet, list[BoxSet]]:
    """Return the boxes of one fixed object, and one box for each of its open leaves without a known hinge.

    Compartments of furniture are cut out of its boxes, which may then be more than `options` allow. Leaves with a known
    hinge are not included unless shut. A window has one box. Objects of `PASSABLE_CATEGORIES`, or that begin above the
    height limit, have none. Boxes outside the height limits are dropped, except those of open leaves.

    Args:
        item: The object.
        floor: Height of the level's floor [m].
        options: Number and height limits of boxes.
    """
    boxes, leaves = empty_boxes(), []
    if item.info.coarse == "window":
        boxes = item.box
    elif item.info.coarse not in PASSABLE_CATEGORIES and item.limits[0, 2] < floor + options.max_bottom_height:
        sill = floor + MAX_SILL_HEIGHT - item.pose[2, 3] if item.info.coarse in PORTAL_CATEGORIES else None
        boxes, leaves = _fit_shape(_shape(item), sill, options.max_boxes_per_object)
        boxes = carve_boxes(boxes, _cutters(item)) if item.pockets else boxes
        boxes, leaves = _place(boxes, item), [_place(leaf, item) for leaf in leaves]
        boxes = concat_boxes([boxes, item.shut_leaves])
    return keep_reachable(boxes, floor, options), leaves


@dataclass(frozen=True)
class _Shape:
    """A model with its scale and tilt but without position and yaw; equal shapes have equal boxes."""

    key: str
    linear: bytes
    triangles: Float[np.ndarray, "t 3 3"] = field(compare=False)  # [m], around the origin, turned to yaw 0


def _shape(item: PlacedObject) -> _Shape:
    """Return the shape of an object's main part at yaw 0: without leaves whose hinges are known, nor compartments."""
    # The triangles use the rounded matrix too; otherwise cached boxes would depend on the order of nearly equal shapes.
    linear, solid = _linear(item), item.solid_part or item.main_part
    return _Shape(solid.key, linear.tobytes(), solid.triangle.astype(np.float64) @ linear.T)


def _linear(item: PlacedObject) -> Float[np.ndarray, "3 3"]:
    """Return scale and tilt of an object, rounded: its pose without position and yaw."""
    return np.round(yaw_matrix(-item.yaw) @ item.pose[:, :3], 6) + 0.0


def _cutters(item: PlacedObject) -> Float[np.ndarray, "n 2 3"]:
    """Return what compartments cut out of the boxes of a shape: minimum and maximum corners [m]."""
    corners = np.concatenate([pocket.cutters for pocket in item.pockets]) @ _linear(item).T
    return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)


@lru_cache(maxsize=1 << 12)
def _fit_shape(shape: _Shape, sill: float | None, most: int) -> tuple[BoxSet, tuple[BoxSet, ...]]:
    """Return at most `most` boxes of a shape, and one per open leaf, as `door_boxes`; `sill` None: not a door."""

    def fit() -> _FittedBoxes:
        """Compute the boxes of the frame and of the leaves."""
        if sill is None:
            return _FittedBoxes(fit_boxes(shape.triangles, 0.0, most), empty_boxes())
        frame, leaves = door_boxes(shape.triangles, sill, most)
        return _FittedBoxes(frame, concat_boxes(leaves))

    found = kept_result(_FittedBoxes, repr((shape.key, shape.linear, sill, most)).encode(), fit)
    return found.frame, tuple(found.leaves[i : i + 1] for i in range(len(found.leaves)))


@dataclass(frozen=True)
class _FittedBoxes:
    """Boxes of a shape and of its open leaves."""

    frame: BoxSet
    leaves: BoxSet


def _place(boxes: BoxSet, item: PlacedObject) -> BoxSet:
    """Move boxes of a shape (yaw 0, around the origin) to the position and yaw of an object."""
    return BoxSet(boxes.center @ yaw_matrix(item.yaw).T + item.pose[:, 3], boxes.half, boxes.yaw + item.yaw)


def door_boxes(triangles: Float[np.ndarray, "t 3 3"], sill: float, max_boxes: int) -> tuple[BoxSet, tuple[BoxSet, ...]]:
    """Return boxes of the frame and of the open leaves of a door.

    Each leaf gets one box along its own direction, so that the passage is as wide as it appears. A connected part is a
    leaf by `_is_open_leaf`, else a part of the frame. Fittings such as handles (`MAX_FITTING_SIZE`) have no box.

    Args:
        triangles: The door, its wall along x [m].
        sill: Height in the frame of the triangles; triangles that end lower are omitted [m].
        max_boxes: Maximum number of boxes for the frame.
    """
    part = triangle_components(triangles)
    frame, leaves = [], []
    for number in np.unique(part):
        piece = triangles[(part == number) & (triangles[..., 2].max(axis=1) > sill)]
        if len(piece) and np.ptp(piece.reshape(-1, 3), axis=0).max() > MAX_FITTING_SIZE:
            box = narrowest_box(piece.reshape(-1, 3))
            if _is_open_leaf(box):
                leaves.append(box)
            else:
                frame.append(piece)
    return fit_boxes(np.concatenate(frame), 0.0, max_boxes) if frame else empty_boxes(), tuple(leaves)


def _is_open_leaf(box: BoxSet) -> bool:
    """Return whether a box is as high as a leaf and oblique to its wall, which is along x: not at 0 or 90 degrees."""
    turn = (box.yaw[0] + np.pi / 4) % (np.pi / 2) - np.pi / 4
    return bool(box.half[0, 2] * 2 > MIN_LEAF_HEIGHT and abs(turn) > MIN_OPEN_LEAF_ANGLE)


def keep_reachable(boxes: BoxSet, floor: float, options: ColliderOptions) -> BoxSet:
    """Return, uncut, the boxes that reach into the height limits of `options` above a floor at height `floor` [m].

    Boxes that only touch a limit from outside are dropped.
    """
    return boxes[(boxes.top > floor + options.min_top_height) & (boxes.bottom < floor + options.max_bottom_height)]


def select_passable_leaves(
    leaves: Sequence[BoxSet], free_area: Callable[[BoxSet], float], min_gain: float = 0.5
) -> list[BoxSet]:
    """Return the open leaves that keep their boxes; leaves that cut off a part of the house are omitted one by one.

    The first such leaf in the order of `leaves` is omitted, then all that remain are tested again. The sets returned
    are those passed, in their order.

    SUNCG's open doors are half open and often blocked by furniture; a resident would push the leaf aside. An omitted
    leaf without a known hinge is visible and audible but has no collider, as all doors in HoME.

    Args:
        leaves: One box each.
        free_area: Function from leaf boxes to the area of the largest free region [m^2].
        min_gain: Minimum area that a leaf must cut off, besides its own footprint, to be omitted [m^2].
    """
    if not leaves:
        return []
    area = free_area(concat_boxes(leaves))
    for leaf in leaves:
        others = [other for other in leaves if other is not leaf]
        without = free_area(concat_boxes(others))
        if without > area + min_gain + 4 * float(leaf.half[0, 0] * leaf.half[0, 1]):
            return select_passable_leaves(others, free_area, min_gain)
    return list(leaves)


def exposed_mask(boxes: BoxSet) -> Bool[np.ndarray, " n"]:
    """Return a mask of the boxes that no other box contains, within 1e-6 m; the first of equal boxes is exposed."""
    kept = np.ones(len(boxes), bool)
    corners = np.array([footprint(boxes, i) for i in range(len(boxes))]).reshape(-1, 4, 2)
    bottom, top, (low, high) = boxes.bottom, boxes.top, (corners.min(axis=1), corners.max(axis=1))
    for i in range(len(boxes)):
        if not kept[i]:
            continue
        inside = (bottom >= bottom[i] - 1e-6) & (top <= top[i] + 1e-6)
        inside &= ((low >= low[i] - 1e-5) & (high <= high[i] + 1e-5)).all(axis=1)  # rules out most of the others
        inside[i] = False
        rows = np.flatnonzero(inside)
        local = (corners[rows] - boxes.center[i, :2]) @ yaw_matrix(boxes.yaw[i])[:2, :2]
        kept[rows[(abs(local) <= boxes.half[i, :2] + 1e-6).all(axis=(1, 2))]] = False
    return kept
