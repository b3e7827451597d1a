"""Hinges and slides of `UsdPhysics` as movable parts of the objects that carry them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.decode.scene import Matrix, PlacedMesh
from home_mjx.datasets.gltf.house import SceneObject
from home_mjx.datasets.gltf.joints import MIN_RANGE, SceneJoint, with_parts
from home_mjx.datasets.gltf.objects import FoundObject, MeshObject, join_meshes, move_mesh
from home_mjx.datasets.habitat.articulated import hinge_strip, move_joint, wall_frame
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, printable
from home_mjx.datasets.usd.layers import at_start, located_errors
from home_mjx.geometry.rotations import quat_matrix
from home_mjx.schema.house import JointKind

KINDS: Mapping[str, JointKind] = {"PhysicsRevoluteJoint": "hinge", "PhysicsPrismaticJoint": "slide"}
FIXED = "PhysicsFixedJoint"
AXES = {"X": 0, "Y": 1, "Z": 2}


@dataclass(frozen=True)
class UsdJoint:
    """A joint between two bodies.

    Attributes:
        path: Its prim.
        carrier: Prim of the body that carries the other; "" for the world.
        moved: Prim of the body that it moves.
        joint: The hinge or slide; None if the bodies are fixed to each other, are unknown, or if it has no range.
        is_fixed: Whether the file fixes the bodies to each other.
    """

    path: str
    carrier: str
    moved: str
    joint: SceneJoint | None
    is_fixed: bool = False


def read_joint(prim: Any, places: Mapping[str, Matrix], unit: float) -> UsdJoint | None:
    """Return the joint of a prim; None for other prims, for joints that are not enabled and fixed unknown bodies.

    A joint of one body with the world moves that body, whichever of both the file names first.

    Args:
        prim: The prim.
        places: House from prim of all prims, by path; that of the world is "".
        unit: Metres per unit.
    """
    kind = str(prim.GetTypeName())
    if kind not in (*KINDS, FIXED) or not _value(prim, "physics:jointEnabled", True):
        return None
    bodies = [_body(prim, f"physics:body{side}") for side in (0, 1)]
    sides = (0, 1) if bodies[1] else (1, 0)
    path, carrier, moved = str(prim.GetPath()), *(bodies[side] for side in sides)
    is_known, is_fixed = bool(moved) and {carrier, moved} <= places.keys(), kind == FIXED
    if is_fixed or not is_known:
        return UsdJoint(path, carrier, moved, None, is_fixed) if is_known or not is_fixed else None
    names = printable(prim.GetName()[:100]), moved.rpartition("/")[2]
    frames = _frame(prim, places[carrier], sides[0]), _frame(prim, places[moved], sides[1])
    return UsdJoint(path, carrier, moved, _scene_joint(prim, KINDS[kind], frames, sides, unit, names))


def _body(prim: Any, name: str) -> str:
    """Return the path of the body that a relationship names; "" without one."""
    with located_errors(Path(prim.GetStage().GetRootLayer().realPath), str(prim.GetPath())):
        targets = prim.GetRelationship(name).GetTargets()
    return str(targets[0]) if targets else ""


def _value(prim: Any, name: str, default: Any) -> Any:
    """Return the value of an attribute; the default if it has none."""
    found = prim.GetAttribute(name)
    value = at_start(found) if found else None
    return default if value is None else value


def _scene_joint(
    prim: Any,
    kind: JointKind,
    frames: tuple[Matrix, Matrix],
    sides: tuple[int, int],
    unit: float,
    names: tuple[str, ...],
) -> SceneJoint | None:
    """Return a joint in the house; its value in the file is 0 where the frames of both bodies coincide.

    Args:
        prim: The prim.
        kind: Motion.
        frames: House from the joint's frame at the body that carries the other, and at the other.
        sides: Numbers of both bodies in the file, whose limits are for motions of body 1 from body 0.
        unit: Metres per unit.
        names: Names of the joint and of its part.
    """
    first, second = frames
    number = AXES.get(str(_value(prim, "physics:axis", "X")), 0)
    axis = first[:3, number]
    if kind == "hinge":
        side, up = first[:3, (number + 1) % 3], first[:3, (number + 2) % 3]
        turned = second[:3, (number + 1) % 3]
        shown, factor = math.atan2(float(turned @ up), float(turned @ side)), math.pi / 180
    else:
        shown, factor = float((second[:3, 3] - first[:3, 3]) @ axis), unit
    free = (-math.pi, math.pi) if kind == "hinge" else (0.0, 0.0)
    stated = [factor * float(_value(prim, f"physics:{end}Limit", math.nan)) for end in ("lower", "upper")]
    stated = stated if sides == (0, 1) else [-value for value in reversed(stated)]
    low, high = (v - shown if abs(v) <= MAX_COORDINATE else f for v, f in zip(stated, free, strict=True))
    low, high = min(low, 0.0), max(high, 0.0)
    if not (np.isfinite(first).all() and np.isfinite(second).all()) or high - low <= MIN_RANGE:
        return None
    return SceneJoint(kind, axis, first[:3, 3], low, high, min(max(-shown, low), high), names)


def _frame(prim: Any, body: Matrix, side: int) -> Matrix:
    """Return house from the joint's frame at one of its bodies, without scale; its position is in the body's units."""
    place = np.array(_value(prim, f"physics:localPos{side}", (0, 0, 0)), float)
    turn = _value(prim, f"physics:localRot{side}", None)
    quat = np.array([1.0, 0, 0, 0] if turn is None else [turn.GetReal(), *turn.GetImaginary()])
    linear = body[:3, :3] / np.linalg.norm(body[:3, :3], axis=0)
    matrix = np.eye(4)
    matrix[:3, :3] = linear @ quat_matrix((quat / max(np.linalg.norm(quat), 1e-9))[None])[0]
    matrix[:3, 3] = body[:3, :3] @ place + body[:3, 3]
    return matrix


def attach_joints(
    objects: Sequence[FoundObject], architecture: Sequence[PlacedMesh], joints: Sequence[UsdJoint]
) -> tuple[list[SceneObject], list[PlacedMesh], list[UsdJoint]]:
    """Return objects with the parts that joints move, the architecture without them, and joints that move nothing.

    A part belongs to the object that contains the body that carries it, else to that of its own meshes, else to the
    only object below that body. Joints on parts that another joint moves are not kept.
    """
    outer = _outermost(joints)
    moved = {joint.path: _carried(joint.moved, joints) for joint in outer}
    everything = [*(mesh for one in objects for mesh in one.meshes), *architecture]
    taken = {
        id(mesh): joint
        for mesh in everything
        for joint in outer
        if moved[joint.path] & {node.element for node in mesh.chain}
    }
    parts: dict[int, list[tuple[SceneJoint, list[PlacedMesh]]]] = {}
    lost = [joint for joint in joints if joint not in outer and not joint.is_fixed]
    for joint in outer:
        owner = _owner(objects, joint, taken)
        meshes = [mesh for mesh in everything if taken.get(id(mesh)) is joint]
        if owner is None or joint.joint is None or not meshes:
            lost.append(joint)
            taken = {key: own for key, own in taken.items() if own is not joint}
        else:
            parts.setdefault(id(owner), []).append((joint.joint, meshes))
    found: list[SceneObject] = []
    for one in objects:
        one.meshes = [mesh for mesh in one.meshes if id(mesh) not in taken]
        whole = with_parts(one, parts.get(id(one), ()))
        if whole.meshes:
            found.append(_framed(whole))
    return found, [mesh for mesh in architecture if id(mesh) not in taken], lost


def _outermost(joints: Sequence[UsdJoint]) -> list[UsdJoint]:
    """Return the joints with a motion whose carrier no other such joint moves."""
    moving = [joint for joint in joints if joint.joint is not None]
    carried = {joint.path: _carried(joint.moved, joints) for joint in moving}
    inner = {one.path for one in moving for other in moving if one is not other and one.carrier in carried[other.path]}
    return [joint for joint in moving if joint.path not in inner]


def _carried(body: str, joints: Sequence[UsdJoint]) -> set[str]:
    """Return a body and all that joints attach to it."""
    found, left = {body}, [body]
    while left:
        carrier = left.pop()
        new = {joint.moved for joint in joints if joint.carrier == carrier} - found
        found |= new
        left += new
    return found


def _owner(objects: Sequence[FoundObject], joint: UsdJoint, taken: Mapping[int, UsdJoint]) -> FoundObject | None:
    """Return the object that contains the body that carries a joint, else another, see `attach_joints`; None without.

    A body above several objects, such as the whole scene, says nothing about the object of the part.
    """
    left = [one for one in objects if any(id(mesh) not in taken for mesh in one.meshes)] if joint.carrier else []
    around = (one for one in left if f"{joint.carrier}/".startswith(f"{one.node.element}/"))
    own = (one for one in objects if any(taken.get(id(mesh)) is joint for mesh in one.meshes))
    inside = [one for one in left if one.node.element.startswith(f"{joint.carrier}/")]
    return next(around, None) or next(own, None) or (inside[0] if len(inside) == 1 else None)


def _framed(one: FoundObject) -> SceneObject:
    """Return an object; a door with joints has a frame, and x along its wall, which the compiler needs."""
    mesh, joints = one.mesh(), one.joints
    if one.fine != "door" or not joints:
        return one
    if sum(len(joint.faces) for joint in joints) == len(mesh.faces):
        mesh = join_meshes([mesh, hinge_strip(mesh, joints[0])])
    frame = wall_frame(mesh, joints)
    back = np.linalg.inv(frame)
    moved = tuple(move_joint(joint, back) for joint in joints)
    return MeshObject(one.fine, one.key, one.matrix @ frame, move_mesh(mesh, back), moved, one.extra)


def unit_of(frame: Float[np.ndarray, "4 4"]) -> float:
    """Return the metres per unit of a scene's frame."""
    return float(np.linalg.norm(frame[:3, 0]))
