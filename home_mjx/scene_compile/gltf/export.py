"""Export of a compiled house as a GLB file, with its rooms, objects, joints, lights and cameras."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from home_mjx.core.files import write_durably
from home_mjx.errors import ConfigError
from home_mjx.geometry.meshes import transform
from home_mjx.scene_compile.gltf.assets import FROM_Z_UP, GltfAssets
from home_mjx.scene_compile.gltf.document import DocumentWriter
from home_mjx.scene_compile.mjcf.room_file import room_file
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.categories import FINE, ROOM_TYPES
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.lighting import LUMENS_PER_WATT
from home_mjx.schema.semantic import Semantic

SUFFIX, ROOM_SUFFIX = ".glb", ".rooms.json"
CAMERA = {"yfov": np.deg2rad(75), "znear": 0.05, "aspectRatio": 4 / 3}
TO_PLUS_X = [0.0, -(0.5**0.5), 0.0, 0.5**0.5]  # quaternion (xyzw) that turns a camera from -z to +x


def to_glb(house: CompiledHouse) -> bytes:
    """Return a house as the content of a GLB file: glTF 2.0, y up, metres, (x, z, -y) of the world.

    Nodes are the house, its levels, their rooms, and in these the objects `<category>_<object id>`, with the mesh of
    their model. `extras` have the category, the model and, of door leaves, the joint. Lamps are lights of
    `KHR_lights_punctual` with `LUMENS_PER_WATT`. There is one camera for each room.

    Raises:
        DatasetError: A texture cannot be read.

    Example:
        >>> Path("house.glb").write_bytes(to_glb(house))  # doctest: +SKIP
    """
    document = DocumentWriter()
    writer = _NodeWriter(house, document)
    document.root |= {"scene": 0, "scenes": [{"name": house.id, "nodes": [writer.write()]}]}
    return document.glb()


def export_gltf(house: CompiledHouse, path: Path) -> Path:
    """Write the result of `to_glb` to a file, and return its path.

    `NAME.rooms.json` beside it states the rooms, which readers would have to find from the triangles.

    Raises:
        ConfigError: The name does not end in `.glb`, or the file cannot be written.
        DatasetError: A texture cannot be read.
    """
    path = Path(path)
    check_name(path)
    data = to_glb(house)
    with write_durably(path, "glTF file") as file:
        file.write(data)
    with write_durably(path.with_suffix(ROOM_SUFFIX), "room file") as file:
        file.write(room_file(house, has_objects=False))
    return path


def check_name(path: Path) -> None:
    """Raise `ConfigError` unless a path ends in `.glb`."""
    if path.suffix.lower() != SUFFIX:
        raise ConfigError("houses are exported as GLB files", file=path, hint="Name a file that ends in `.glb`.")


class _NodeWriter:
    """Writer of the nodes of a house."""

    def __init__(self, house: CompiledHouse, document: DocumentWriter) -> None:
        self._house, self._document = house, document
        self._assets = GltfAssets(house, document)
        self._rooms: dict[int, list[int]] = {}

    def write(self) -> int:
        """Write all nodes, and return the root."""
        for instance in range(len(self._house.instances.model)):
            room = -1 if instance == ARCHITECTURE else int(self._semantic(instance, Semantic.ROOM))
            self._rooms.setdefault(room, []).append(self._instance(instance))
        for room in range(len(self._house.rooms.polygon)):
            self._rooms.setdefault(room, []).extend(self._camera(room))
        levels: dict[int, list[int]] = {}
        for room, children in sorted(self._rooms.items()):
            if room >= 0 and children:
                levels.setdefault(int(self._house.rooms.level[room]), []).append(self._room(room, children))
        nodes = [self._document.add("nodes", {"name": f"level{n}", "children": c}) for n, c in sorted(levels.items())]
        nodes += [*self._rooms.get(-1, []), *self._lights()]
        return self._document.add("nodes", {"name": "house", "children": nodes, "extras": {"id": self._house.id}})

    def _semantic(self, instance: int, column: Semantic) -> int:
        """Return a value of the first row of an instance in the semantic table."""
        return int(self._house.semantics[self._house.instances.semantic[instance], column])

    def _room(self, room: int, children: list[int]) -> int:
        """Write the node of a room."""
        kind = int(self._house.rooms.type[room])
        extras = {"type": ROOM_TYPES[kind] if kind >= 0 else "", "floor": float(self._house.rooms.floor[room])}
        return self._document.add("nodes", {"name": f"room{room}", "children": children, "extras": extras})

    def _instance(self, instance: int) -> int:
        """Write the node of an instance."""
        table = self._house.instances
        owner, fine = int(table.object_id[instance]), self._semantic(instance, Semantic.FINE)
        model = self._house.models[table.model[instance]]
        category = FINE[fine] if fine >= 0 and instance != ARCHITECTURE else ""
        node: dict[str, Any] = {
            "name": "architecture" if instance == ARCHITECTURE else f"{category or 'object'}_{owner}",
            "mesh": self._assets.mesh(model, int(table.material[instance])),
            **placement(table.pose[instance]),
            "extras": {"category": category, "object_id": owner, "model": model.key},
        }
        row = np.flatnonzero(self._house.doors.instance == instance)
        if len(row):
            node["extras"]["joint"] = self._joint(int(row[0]))
        return self._document.add("nodes", node)

    def _joint(self, row: int) -> dict[str, Any]:
        """Return the hinge or rail of a door leaf in the house, from the pose shown [rad] or [m]."""
        doors = self._house.doors
        slides = bool(doors.is_sliding[row])
        axis = np.array([*doors.slide[row], 0.0]) if slides else np.array([0.0, 0.0, 1.0])
        point = np.array([*doors.pivot[row], doors.pos[row, 2]])
        return {
            "type": "slide" if slides else "hinge",
            "axis": (FROM_Z_UP @ axis).tolist(),
            "point": (FROM_Z_UP @ point).tolist(),
            "range": [float(doors.low[row]), float(doors.high[row])],
            "closed": float(doors.closed[row]),
            "open": float(doors.fully_open[row]),
        }

    def _camera(self, room: int) -> list[int]:
        """Write a camera at eye height in the middle of a room; none for rooms without an outline."""
        polygon, floor = self._house.rooms.polygon[room], float(self._house.rooms.floor[room])
        if not len(polygon):
            return []
        camera = self._document.add("cameras", {"type": "perspective", "perspective": CAMERA})
        place = FROM_Z_UP @ np.array([*polygon.mean(axis=0), floor + AgentBody().eye_height])
        node = {"name": f"camera{room}", "camera": camera, "translation": place.tolist(), "rotation": TO_PLUS_X}
        return [self._document.add("nodes", node)]

    def _lights(self) -> list[int]:
        """Write all lamps as point lights or spots; lines and panels are at their middles, daylight is left out."""
        lights, found, nodes = self._house.lights, [], []
        for i in np.flatnonzero(~lights.daylight & (lights.intensity.max(axis=1, initial=0) > 0)).tolist():
            pose, strength = self._house.instances.pose[lights.instance[i]], float(lights.intensity[i].max())
            light: dict[str, Any] = {
                "type": "point" if lights.cutoff[i] < -1 else "spot",
                "color": (lights.intensity[i] / strength).tolist(),
                "intensity": strength * LUMENS_PER_WATT,
            }
            if light["type"] == "spot":
                cone = float(np.clip(np.arccos(np.clip(lights.cutoff[i], -1, 1)), 0.01, np.pi / 2))
                light["spot"] = {
                    "innerConeAngle": _inner_angle(cone, float(lights.exponent[i])),
                    "outerConeAngle": cone,
                }
            found.append(light)
            aim = FROM_Z_UP @ pose[:, :3] @ lights.direction[i]
            nodes.append(
                {
                    "name": f"lamp{i}",
                    "translation": (FROM_Z_UP @ transform(pose, lights.pos[i])).tolist(),
                    "rotation": _turn_to(aim),
                    "extensions": {"KHR_lights_punctual": {"light": len(found) - 1}},
                }
            )
        if found:
            self._document.use_extension("KHR_lights_punctual")
            self._document.root["extensions"] = {"KHR_lights_punctual": {"lights": found}}
        return [self._document.add("nodes", node) for node in nodes]


def _inner_angle(outer: float, exponent: float) -> float:
    """Return the inner angle [rad] with which a spot has the flux of a cosine to an exponent within `outer`."""
    edge = float(np.cos(outer))
    share = (1 - edge ** (exponent + 1)) / (exponent + 1)
    return min(float(np.arccos(np.clip((1 - edge / 3 - share) * 1.5, edge, 1))), 0.999 * outer)


def placement(pose: Float[np.ndarray, "3 4"]) -> dict[str, list[float]]:
    """Return the entries of a node at a pose (Z up): its column-major matrix; none at the origin."""
    matrix = np.eye(4)
    matrix[:3, :3] = FROM_Z_UP @ pose[:, :3] @ FROM_Z_UP.T
    matrix[:3, 3] = FROM_Z_UP @ pose[:, 3]
    return {} if np.array_equal(matrix, np.eye(4)) else {"matrix": matrix.T.ravel().tolist()}


def _turn_to(aim: Float[np.ndarray, "3"]) -> list[float]:
    """Return the quaternion (xyzw) that turns -z to a direction."""
    found = Rotation.align_vectors(aim[None] / np.linalg.norm(aim), np.array([[0.0, 0.0, -1.0]]))
    return found[0].as_quat().tolist()
