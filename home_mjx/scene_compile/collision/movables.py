"""Movable objects: categories, limits, and bodies with one box each."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.geometry.boxes import BoxSet, concat_boxes
from home_mjx.geometry.meshes import compose, invert, min_thickness
from home_mjx.geometry.rotations import yaw_matrix, yaw_quat
from home_mjx.scene_compile.objects.masses import object_contact
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import Bodies
from home_mjx.schema.house import ObjectNode

# Categories of objects that are not attached to the house.
MOVABLE_COARSE = {
    *("bed", "bench_chair", "books", "candle", "cart", "chair", "clock", "computer", "decoration", "desk", "dresser"),
    *("dressing_table", "kitchenware", "magazines", "music", "ottoman", "pillow", "plant", "shelving", "shoes"),
    *("shoes_cabinet", "sofa", "stand", "storage_bench", "table", "television", "toy", "trash_can", "trinket"),
    *("tripod", "tv_stand", "vase", "wardrobe_cabinet"),
}
MOVABLE_FINE = {
    *("amplifier", "beer", "bottle", "bread", "cake", "camera", "cellphone", "chessboard", "coffee_kettle"),
    *("coffee_machine", "container", "containers", "cooker", "cup", "cutting_board", "fishbowl", "floor_lamp", "food"),
    *("food_processor", "food_tray", "fruit_bowl", "glass", "hair_dryer", "hanger", "helmet", "ipad", "iron", "jug"),
    *("kettle", "keyboard", "knife_rack", "laptop", "loudspeaker", "microwave", "mortar_and_pestle", "pan"),
    *("pedestal_fan", "place_setting", "plates", "playstation", "soap_dish", "soap_dispenser", "stationary_container"),
    *("table_lamp", "teapot", "telephone", "toaster", "toiletries", "trash_can", "tricycle", "utensil_holder"),
    *("vacuum_cleaner", "weight_scale", "xbox"),
}
MIN_BODY_HALF = 1e-3  # [m], minimum half extent of a body; inertia of thinner boxes is lost in rounding
FIXED_FINE = {"bunker_bed", "chair_set", "drumset", "fish_tank", "piano"}


@dataclass(frozen=True)
class MovableOptions:
    """Criteria for objects that become bodies.

    Attributes:
        max_bodies: Maximum number of bodies per house; the lightest objects are selected first.
        max_support_gap: Maximum vertical gap between an object and the floor or object that supports it [m].
        max_shrink: Maximum reduction of each side of the object's box to avoid overlaps [m].
        min_lowered_height: Minimum height of a box whose top is lowered to fit under something, such as a chair under
            a table [m].
        max_edge: Maximum longest edge of a movable object [m].
        min_edge: Minimum thickness of a movable object in any direction [m]; sheets and plates stay fixed. Bodies
            thinner than 2 mm are never made.

    Raises:
        ConfigError: A value is not a number of its range.

    Example:
        >>> MovableOptions(max_bodies=0).max_bodies  # nothing moves
        0
    """

    max_bodies: int = 32
    max_support_gap: float = 0.05
    max_shrink: float = 0.05
    min_lowered_height: float = 0.35
    max_edge: float = 2.6
    min_edge: float = 0.01

    def __post_init__(self) -> None:
        for option in fields(self):
            check_number(f"movables.{option.name}", getattr(self, option.name), 0, integer=option.name == "max_bodies")


@dataclass(frozen=True)
class MovableCandidate:
    """An object that may become a body."""

    item: PlacedObject
    box: BoxSet
    mass: float  # [kg]
    floor: float | None  # [m], height of the supporting floor; None: another object supports it


def is_movable(item: PlacedObject, options: MovableOptions) -> bool:
    """Return whether an object is movable by category and size, and is inside a room; Box nodes never are.

    Furniture with fronts that open is fixed. Objects that hang on walls are excluded later: nothing supports them.
    """
    if not isinstance(item.node, ObjectNode) or item.room < 0 or item.info.fine in FIXED_FINE or item.leaf_parts:
        return False
    if item.info.coarse not in MOVABLE_COARSE and item.info.fine not in MOVABLE_FINE:
        return False
    if np.ptp(item.limits, axis=0).max() > options.max_edge:
        return False
    thickness = min(min_thickness(item.triangles), 2 * float(item.box.half.min()))
    return thickness >= max(options.min_edge, 2 * MIN_BODY_HALF)


def make_bodies(chosen: Sequence[MovableCandidate]) -> Bodies:
    """Return the table of bodies of the selected objects, one row each, in the same order.

    Pose and half extents are those of a candidate's box, not of its object.
    """
    box = concat_boxes(c.box for c in chosen)
    quat = yaw_quat(box.yaw)
    frames = [np.c_[yaw_matrix(y), c] for y, c in zip(box.yaw, box.center, strict=True)]
    inner = [compose(invert(f), c.item.pose) for f, c in zip(frames, chosen, strict=True)]
    contacts = np.array([object_contact(c.item, c.mass) for c in chosen], float).reshape(-1, 2)
    return Bodies(
        instance=np.array([c.item.instance for c in chosen], np.int32),
        pos=box.center,
        quat=quat,
        size=box.half,
        mass=np.array([c.mass for c in chosen], float),
        friction=contacts[:, 0],
        restitution=contacts[:, 1],
        from_model=np.array(inner).reshape(-1, 3, 4),
    )
