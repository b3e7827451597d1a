"""Fronts of furniture: doors of fridges, wardrobes and cabinets, and drawers, that open as leaves between rooms do."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.geometry.meshes import tree_order, triangles_z_up
from home_mjx.scene_compile.objects.compartments import Pocket, cut_pockets
from home_mjx.scene_compile.objects.doors import JointedDoor, LeafPart, cut_leaves, moves_in_plan
from home_mjx.scene_compile.objects.trays import add_tray, find_pocket
from home_mjx.schema.compiled import Model
from home_mjx.schema.house import House, Joint, Level, Metadata, ObjectNode

MAX_FRONTS = 256
BUILDING_CATEGORIES = ("door", "garage_door", "arch", "window", "stairs")  # coarse categories that have no fronts
CONTROL_PARTS = ("burner", "button", "handle", "knob", "lever", "light", "spout", "switch")  # parts that close nothing
MIN_TRAVEL = 0.05  # [m], minimum travel of a drawer


@dataclass(frozen=True)
class ArticulationOptions:
    """Articulation of furniture.

    Attributes:
        max_fronts: Maximum number of fronts per house that open, the largest ones; all others are shut for good. 0:
            furniture is rigid. Vertical hinges and drawers count: flaps, lids and knobs stay as they are. Drawers
            that have no compartment stay shut too, and no other front takes their place.

    Raises:
        ConfigError: The number is out of range.

    Example:
        >>> ArticulationOptions(max_fronts=24).max_fronts
        24
    """

    max_fronts: int = 0

    def __post_init__(self) -> None:
        check_number("max_fronts", self.max_fronts, 0, MAX_FRONTS, integer=True)


@dataclass(frozen=True)
class JointedFurniture:
    """Parts of a piece of furniture.

    Attributes:
        body: All but its fronts, hollow behind them.
        solid: The same without compartments.
        fronts: Its fronts.
        pockets: Compartments behind the fronts.
        joints: Joints of the fronts.
    """

    body: Model
    solid: Model
    fronts: tuple[LeafPart, ...]
    pockets: tuple[Pocket, ...] = ()
    joints: tuple[Joint, ...] = ()


def keep_largest_fronts(house: House, metadata: Metadata, max_fronts: int) -> tuple[House, int]:
    """Return the house with joints of doors and of the largest fronts only, and the number of all joints of furniture.

    Area is that of a front's bounding rectangle in the house; ties are kept in file order.
    """
    rows = [
        (-_front_area(house, node, joint), number, node.index, at)
        for number, level in enumerate(house.levels)
        for node in _furniture(level, metadata)
        for at, joint in enumerate(node.joints)
        if is_front(joint)
    ]
    kept = {row[1:] for row in sorted(rows)[:max_fronts]}
    levels = tuple(_with_fronts(level, number, kept, metadata) for number, level in enumerate(house.levels))
    total = sum(len(node.joints) for level in house.levels for node in _furniture(level, metadata))
    return replace(house, levels=levels), total


def is_front(joint: Joint) -> bool:
    """Return whether a joint closes something, by a vertical hinge or a level slide of at least `MIN_TRAVEL`."""
    if joint.part.partition("_")[0] in CONTROL_PARTS:
        return False
    return moves_in_plan(joint) and (joint.kind == "hinge" or abs(joint.open - joint.closed) >= MIN_TRAVEL)


def _furniture(level: Level, metadata: Metadata) -> Iterator[ObjectNode]:
    """Yield the objects of a level that have joints and are no part of the building."""
    for node in level.objects:
        if node.joints and metadata.info(node.model_id).coarse not in BUILDING_CATEGORIES:
            yield node


def _front_area(house: House, node: ObjectNode, joint: Joint) -> float:
    """Return the area of the rectangle around a front [m^2]: its height times its length in plan."""
    mesh = house.models[node.model_key]
    corners = mesh.vertices[mesh.faces[joint.faces]].reshape(-1, 3) @ node.transform[:3, :3].T
    length, height, width = np.ptp(corners, axis=0).tolist()
    return float(np.hypot(length, width) * height)


def _with_fronts(level: Level, number: int, kept: set[tuple[int, int, int]], metadata: Metadata) -> Level:
    """Return a level whose furniture has only the joints in `kept`: rows of level, node and joint."""
    changed = {
        node.index: replace(
            node, joints=tuple(j for at, j in enumerate(node.joints) if (number, node.index, at) in kept)
        )
        for node in _furniture(level, metadata)
    }
    return replace(level, objects=tuple(changed.get(node.index, node) for node in level.objects))


@lru_cache(maxsize=256)
def split_furniture(furniture: JointedDoor) -> JointedFurniture:
    """Return the body and the fronts of a piece of furniture; without fronts if all triangles belong to them.

    Drawers get trays. Those that do not slide out of a compartment stay in the body.
    """
    if not furniture.joints:
        return JointedFurniture(furniture.model, furniture.model, ())
    order = tree_order(triangles_z_up(furniture.mesh))
    faces = [np.isin(order, joint.faces) for joint in furniture.joints]
    if all(np.any(faces, axis=0)):
        return JointedFurniture(furniture.model, furniture.model, ())
    solid, leaves = cut_leaves(furniture.model, furniture.joints, faces)
    sliding = {i for i, leaf in enumerate(leaves) if leaf.slide.any()}
    body, pockets = cut_pockets(solid, [leaf.model for leaf in leaves], sliding)
    behind = {i: find_pocket(leaves[i], pockets) for i in sliding}
    shut = {i for i, pocket in behind.items() if pocket is None}
    if shut:
        rest = tuple(joint for i, joint in enumerate(furniture.joints) if i not in shut)
        return split_furniture(replace(furniture, joints=rest))
    fronts = (add_tray(leaf, pocket) if (pocket := behind.get(i)) else leaf for i, leaf in enumerate(leaves))
    opening = tuple(replace(leaf, is_front=True) for leaf in fronts)
    return JointedFurniture(body, solid, opening, pockets, furniture.joints)
