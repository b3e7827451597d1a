"""Objects and boxes of a house, placed in the world frame."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.kept_results import find_model
from home_mjx.geometry.boxes import BoxSet, bounding_box, concat_boxes
from home_mjx.geometry.meshes import Z_UP, bounds, box_triangles, make_model, to_z_up, transform, triangles_z_up
from home_mjx.geometry.polygons import find_smallest_room, polygon_area, polygon_distance
from home_mjx.scene_compile.architecture.rooms import HouseFrame
from home_mjx.scene_compile.materials.surface import SurfaceMaterial, apply_override, surface_material
from home_mjx.scene_compile.objects.compartments import Pocket
from home_mjx.scene_compile.objects.doors import (
    JointedDoor,
    LeafPart,
    PlacedLeaf,
    is_hinge_preserving,
    moves_in_plan,
    place_leaf,
    split_door,
)
from home_mjx.scene_compile.objects.fronts import JointedFurniture, split_furniture
from home_mjx.schema.compiled import ARCHITECTURE, Model, RoomTable
from home_mjx.schema.house import BoxNode, House, Joint, Level, Material, Mesh, Metadata, ModelInfo, ObjectNode

MAX_TILT = 1e-3  # maximum tilt of an object that counts as rotated about the vertical axis only
MAX_ROOM_DISTANCE = 1.0  # [m], maximum distance of an object from a room that lists it
MIN_ROOM_HEIGHT = 1.0  # [m], minimum height of a room with a ceiling; the "ceiling" of a balcony is its floor
DEFAULT_BOX_MATERIAL = Material("box", diffuse=(0.8, 0.8, 0.8), opacity=1.0)
# Material slot of each face of a Box (-x, +x, -y, +y, -z, +z in the world); GAPS orders +y, -y, -x, +x, +z, -z in the
# file.
BOX_SLOTS = (2, 3, 4, 5, 1, 0)


@dataclass(frozen=True)
class PlacedObject:
    """One object in the world frame."""

    node: ObjectNode | BoxNode
    info: ModelInfo
    model: Model
    main_part: Model  # the whole object; for doors with known hinges, the frame; for furniture, all but its fronts
    leaf_parts: tuple[LeafPart, ...]  # door leaves, or fronts of furniture, in their model's frame
    slots: tuple[Material, ...]  # material slots of the mesh, after overrides
    pose: Float[np.ndarray, "3 4"]  # world from model [m]
    object_id: int
    level: int
    room: int  # room index; -1 if none
    instance: int  # instance of its first part; the others follow
    is_shut: bool = False  # leaves are closed and do not turn
    solid_part: Model | None = None  # the main part without its compartments; None: as it is
    pockets: tuple[Pocket, ...] = ()  # compartments of furniture behind its fronts, in its model's frame

    @cached_property
    def triangles(self) -> Float[np.ndarray, "t 3 3"]:
        """Surface of the whole model in the world frame [m]; leaves are as in the model, also if shut."""
        return transform(self.pose, self.model.triangle.astype(np.float64))

    @cached_property
    def limits(self) -> Float[np.ndarray, "2 3"]:
        """Minimum and maximum corner of the surface in the world frame [m]."""
        return bounds(self.triangles)

    @cached_property
    def upper_triangles(self) -> Float[np.ndarray, "u 3 3"]:
        """Triangles of the surface that face upwards, within 60 degrees [m]."""
        a, b, c = self.triangles.transpose(1, 0, 2)
        normal = np.cross(b - a, c - a) * np.sign(np.linalg.det(self.pose[:, :3]))  # a mirrored model is inside out
        return self.triangles[(normal[:, 2] > 0.5 * np.linalg.norm(normal, axis=1)) & (normal[:, 2] > 1e-12)]

    @cached_property
    def yaw(self) -> float:
        """Direction of the model's x axis in the plan [rad]; 0 if the object is tilted."""
        across, up = self.pose[:, 0], self.pose[:, 2]
        lean = max(np.hypot(*up[:2]) / np.linalg.norm(up), abs(across[2]) / np.linalg.norm(across))
        return 0.0 if lean > MAX_TILT else float(np.arctan2(across[1], across[0]))

    @cached_property
    def box(self) -> BoxSet:
        """Upright box around the object, aligned with its yaw."""
        return bounding_box(self.triangles.reshape(-1, 3), self.yaw)

    @cached_property
    def leaves(self) -> tuple[PlacedLeaf, ...]:
        """Leaves of a door, or fronts, that turn or slide, in the order of its parts; empty if they are shut."""
        return () if self.is_shut else self._leaves

    @cached_property
    def shut_leaves(self) -> BoxSet:
        """Boxes of its leaves in their closed pose if they are shut; empty otherwise."""
        return concat_boxes(leaf.box_at(leaf.closed) for leaf in self._leaves if self.is_shut)

    @cached_property
    def _leaves(self) -> tuple[PlacedLeaf, ...]:
        """All leaves in the world, also shut ones, in the initial pose."""
        return tuple(place_leaf(leaf, self.pose, self.instance + i) for i, leaf in enumerate(self.leaf_parts, 1))

    @property
    def parts(self) -> tuple[Model, ...]:
        """Rigid parts, one instance each: the main part, then leaves or fronts with known hinges, shut or not.

        A door without known hinges is its main part alone, as any other object.
        """
        return (self.main_part, *(leaf.model for leaf in self.leaf_parts))

    @property
    def poses(self) -> tuple[Float[np.ndarray, "3 4"], ...]:
        """Pose of each of `parts`, world from model [m]; shut leaves are closed, others as in the model."""
        angles = [leaf.closed if self.is_shut else 0.0 for leaf in self._leaves]
        return (self.pose, *(leaf.pose_at(a, self.pose) for leaf, a in zip(self._leaves, angles, strict=True)))

    @cached_property
    def surfaces(self) -> tuple[SurfaceMaterial, ...]:
        """Resolved surface of each material slot."""
        return tuple(surface_material(slot, self.info.fine, self.info.coarse) for slot in self.slots)


def place_objects(frame: HouseFrame, metadata: Metadata) -> list[PlacedObject]:
    """Place every object and box of a house in the world, in file order.

    Ids count the nodes of all levels, also rooms. Instances count the parts of objects and follow `ARCHITECTURE`.
    """
    house, rooms, offset = frame.house, frame.rooms, frame.offset
    models = {key: library_model(key, mesh) for key, mesh in house.models.items()}
    cube = unit_cube()
    placed: list[PlacedObject] = []
    first, instance = 0, ARCHITECTURE + 1
    for level in house.levels:
        for node in sorted((*level.objects, *level.boxes), key=lambda n: n.index):
            model = cube if isinstance(node, BoxNode) else models[node.model_key]
            info = ModelInfo("Box") if isinstance(node, BoxNode) else metadata.info(node.model_id)
            pose = _pose(node, offset)
            room = _room(node, level, rooms, transform(pose, model.box.astype(np.float64).mean(axis=0)))
            parts = _parts(node, info, model, pose, house.models)
            placed.append(
                PlacedObject(
                    node=node,
                    info=info,
                    model=model,
                    main_part=parts.body,
                    leaf_parts=parts.fronts,
                    slots=_slots(node, house.models),
                    pose=pose,
                    object_id=first + node.index,
                    level=level.index,
                    room=room,
                    instance=instance,
                    solid_part=parts.solid,
                    pockets=parts.pockets,
                )
            )
            instance += len(placed[-1].parts)
        first += num_nodes(level)
    return placed


def _parts(
    node: ObjectNode | BoxNode,
    info: ModelInfo,
    model: Model,
    pose: Float[np.ndarray, "3 4"],
    meshes: Mapping[str, Mesh],
) -> JointedFurniture:
    """Return an object's main part, and its leaves or fronts; only at `is_hinge_preserving` poses it has any."""
    if isinstance(node, BoxNode) or not node.joints or not is_hinge_preserving(pose):
        return JointedFurniture(model, model, ())
    jointed = JointedDoor(model.key, node.joints, model, meshes[node.model_key])
    if info.coarse != "door":
        return split_furniture(jointed)
    frame, leaves = split_door(jointed)
    return JointedFurniture(frame, frame, leaves, joints=tuple(filter(moves_in_plan, node.joints)) if leaves else ())


def leaf_joints(house: House, metadata: Metadata) -> dict[int, tuple[Joint, ...]]:
    """Return, by object id, the joints whose parts `place_objects` cuts out, in the order of their instances."""
    found: dict[int, tuple[Joint, ...]] = {}
    first = 0
    for level in house.levels:
        for node in filter(lambda node: node.joints, level.objects):
            key, info = node.model_key, metadata.info(node.model_id)
            parts = _parts(node, info, library_model(key, house.models[key]), _pose(node, np.zeros(3)), house.models)
            found[first + node.index] = parts.joints
        first += num_nodes(level)
    return found


def num_nodes(level: Level) -> int:
    """Return the length of a level's node list in the file: the highest index of a node that was read, plus 1."""
    nodes = (*level.rooms, *level.objects, *level.boxes, *level.grounds, *level.unknown)
    return max((node.index + 1 for node in nodes), default=0)


def library_model(key: str, mesh: Mesh) -> Model:
    """Convert a mesh, Y up, to a library model, Z up, with triangles in tree order; `key` begins the model's key."""
    normal = None if mesh.normal is None else to_z_up(mesh.normal)
    return make_model(key, triangles_z_up(mesh), mesh.uv, mesh.slot, normal=normal, find=find_model)


def unit_cube() -> Model:
    """Return the model of Box nodes: edges of 1 m around the origin, one slot and the whole texture per face.

    Textures of the four vertical faces are upright, and run left to right as seen from outside.
    """
    triangles = box_triangles(np.zeros(3), np.full(3, 0.5))
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    is_wall = np.abs(normal[:, 2:]) < 0.5
    right = np.where(is_wall, np.stack([-normal[:, 1], normal[:, 0], 0 * normal[:, 0]], -1), [1.0, 0.0, 0.0])
    uv = np.stack([np.einsum("tci,ti->tc", triangles, axis) for axis in (right, np.cross(normal, right))], -1) + 0.5
    return make_model("box", triangles, uv, np.repeat(BOX_SLOTS, 2))


def _pose(node: ObjectNode | BoxNode, offset: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 4"]:
    """Return world from model [m]; that of a Box includes its dimensions, since its model is a unit cube."""
    linear, shift = node.transform[:3, :3].astype(np.float64), node.transform[:3, 3].astype(np.float64)
    if isinstance(node, BoxNode):
        linear = linear * node.dimensions
    return np.concatenate([Z_UP @ linear @ Z_UP.T, (Z_UP @ shift + offset)[:, None]], axis=1)


def _slots(node: ObjectNode | BoxNode, models: Mapping[str, Mesh]) -> tuple[Material, ...]:
    """Return the material slots of a model or a Box, each changed by the override of the same index.

    An override changes only the properties that it has. Overrides beyond the last slot are ignored. A Box begins with
    `DEFAULT_BOX_MATERIAL`; its last override also applies to its further slots.
    """
    changes = node.materials
    if isinstance(node, BoxNode):
        last = len(changes) - 1
        return tuple(
            apply_override(DEFAULT_BOX_MATERIAL, changes[min(i, last)] if changes else None)
            for i in range(len(BOX_SLOTS))
        )
    base = models[node.model_key].materials
    return tuple(apply_override(slot, changes[i] if i < len(changes) else None) for i, slot in enumerate(base))


def _room(node: ObjectNode | BoxNode, level: Level, rooms: RoomTable, center: Float[np.ndarray, "3"]) -> int:
    """Return the smallest nearby room that lists the node, else the smallest room that contains its centre; -1 if none.

    Only rooms of its level count. Lists have priority, since the centre of an open door or of an object on a wall may
    be in the room behind. Objects above a room's ceiling, such as roofs, are not in it unless listed.
    """
    here = np.flatnonzero(rooms.level == level.index)
    listed = [int(r) for r, room in zip(here, level.rooms, strict=True) if node.index in room.members]
    near = [r for r in listed if polygon_distance(rooms.polygon[r], center[:2]) <= MAX_ROOM_DISTANCE]
    if near:
        return min(near, key=lambda r: polygon_area(rooms.polygon[r]))
    roofed = rooms.ceiling[here] > rooms.floor[here] + MIN_ROOM_HEIGHT
    return int(find_smallest_room(rooms, here[~roofed | (center[2] < rooms.ceiling[here])], center[:2]))
