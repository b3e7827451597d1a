"""Configuration files of Habitat for a compiled house: dataset, semantics, lights, and doors as URDF."""

from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from home_mjx.geometry.meshes import Z_UP, transform
from home_mjx.schema.categories import FINE, ROOM_TYPES
from home_mjx.schema.compiled import CompiledHouse

FROM_Z_UP = Z_UP.T  # Habitat has y up
FRAME = {"up": [0, 1, 0], "front": [0, 0, -1]}
DATASET = {
    "stages": {"paths": {".json": ["stages"]}},
    "objects": {"paths": {".json": ["objects"]}},
    "articulated_objects": {"paths": {".urdf": ["urdf"]}},
    "light_setups": {"paths": {".json": ["lights"]}},
    "scene_instances": {"paths": {".json": ["scenes"]}},
    "semantic_scene_descriptor_instances": {"paths": {".json": ["semantics"]}},
}


def semantic_id(fine: int) -> int:
    """Return the semantic id of a fine category's index; 0 for -1, unknown."""
    return fine + 1


def semantic_config(house: CompiledHouse) -> dict[str, Any]:
    """Return the classes of all fine categories, and the rooms as regions."""
    rooms = house.rooms
    regions = []
    for number, polygon in enumerate(rooms.polygon):
        if len(polygon):
            floor, kind = float(rooms.floor[number]), int(rooms.type[number])
            corners = np.insert(polygon * [1.0, -1.0], 1, floor, axis=1)
            label = ROOM_TYPES[kind].replace("_", " ").lower() if kind >= 0 else "unknown"
            regions.append(
                {
                    "name": f"room{number}",
                    "label": label,
                    "poly_loop": corners.tolist(),
                    "floor_height": floor,
                    "extrusion_height": float(rooms.ceiling[number]) - floor,
                    "min_bounds": corners.min(axis=0).tolist(),
                    "max_bounds": [*corners.max(axis=0)[:1], float(rooms.ceiling[number]), corners[:, 2].max()],
                }
            )
    classes = [{"id": semantic_id(fine), "name": name} for fine, name in enumerate(FINE)]
    return {"classes": classes, "region_annotations": regions}


def lighting_config(house: CompiledHouse) -> dict[str, Any]:
    """Return all lamps as point lights, whose intensities are those of the compiled house; daylight is left out."""
    lights, found = house.lights, {}
    for i in np.flatnonzero(~lights.daylight & (lights.intensity.max(axis=1, initial=0) > 0)).tolist():
        strength = float(lights.intensity[i].max())
        place = FROM_Z_UP @ transform(house.instances.pose[lights.instance[i]], lights.pos[i])
        color = (lights.intensity[i] / strength).tolist()
        found[str(i)] = {"type": "point", "position": place.tolist(), "intensity": strength, "color": color}
    return {"lights": found}


def to_place(pose: Float[np.ndarray, "3 4"]) -> dict[str, Any]:
    """Return a pose of the world as translation, rotation (w x y z) and scale of an instance."""
    turn, scale = split_linear(pose)
    x, y, z, w = Rotation.from_matrix(turn).as_quat().tolist()
    place = {"translation": (FROM_Z_UP @ pose[:, 3]).tolist(), "rotation": [w, x, y, z]}
    return place if np.allclose(scale, 1, rtol=0, atol=1e-9) else place | {"non_uniform_scale": scale.tolist()}


def split_linear(pose: Float[np.ndarray, "3 4"]) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3"]]:
    """Return the rotation and the scale, negative along x if mirrored, of a pose in the frame with y up."""
    linear = FROM_Z_UP @ pose[:, :3].astype(float) @ FROM_Z_UP.T
    scale = np.linalg.norm(linear, axis=0)
    if np.linalg.det(linear) < 0:
        scale[0] = -scale[0]
    return linear / scale, scale


def door_urdf(house: CompiledHouse, name: str, meshes: dict[int, str]) -> tuple[str, list[float], list[float]]:
    """Return a door as URDF, its place, and the joint values of the pose shown; joint value 0 is closed.

    Args:
        house: The house.
        name: Name of the robot.
        meshes: Path of the mesh of each instance of the door, relative to the URDF file.
    """
    rows = {int(house.doors.instance[row]): row for row in range(len(house.doors.instance))}
    base = FROM_Z_UP @ house.instances.pose[next(iter(meshes))][:, 3].astype(float)
    body = "".join(_visual(house, i, path, base) for i, path in meshes.items() if i not in rows)
    text, shown = f'<robot name="{name}">\n<link name="frame">{body}</link>\n', []
    for instance, path in meshes.items():
        if instance in rows:
            link, value = _leaf(house, rows[instance], path, base, len(shown))
            text += link
            shown.append(value)
    return text + "</robot>\n", base.tolist(), shown


def _leaf(house: CompiledHouse, row: int, path: str, base: Float[np.ndarray, "3"], number: int) -> tuple[str, float]:
    """Return the link and the joint of a leaf, and its joint value as shown."""
    doors, instance = house.doors, int(house.doors.instance[row])
    closed, slides = float(doors.closed[row]), bool(doors.is_sliding[row])
    pivot = FROM_Z_UP @ np.array([*doors.pivot[row], house.instances.pose[instance][2, 3]]).astype(float)
    axis = FROM_Z_UP @ np.array([*doors.slide[row], 0.0]) if slides else np.array([0.0, 1.0, 0.0])
    place = pivot - base + (closed * axis if slides else 0.0)
    turn = 0.0 if slides else closed
    limits = f'lower="{doors.low[row] - closed:.9f}" upper="{doors.high[row] - closed:.9f}"'
    kind = "prismatic" if slides else "revolute"
    joint = (
        f'<joint name="joint{number}" type="{kind}"><origin rpy="0 {turn:.9f} 0" xyz="{_text(place)}"/>'
        f'<parent link="frame"/><child link="leaf{number}"/><axis xyz="{_text(axis)}"/>'
        f'<limit {limits} effort="100" velocity="10"/></joint>\n'
    )
    return f'<link name="leaf{number}">{_visual(house, instance, path, pivot)}</link>\n{joint}', -closed


def _visual(house: CompiledHouse, instance: int, path: str, origin: Float[np.ndarray, "3"]) -> str:
    """Return the visual element of an instance relative to an origin."""
    pose = house.instances.pose[instance]
    turn, scale = split_linear(pose)
    rpy = fixed_angles(turn)
    place = FROM_Z_UP @ pose[:, 3].astype(float) - origin
    where = f'<origin rpy="{_text(rpy)}" xyz="{_text(place)}"/>'
    return f'<visual>{where}<geometry><mesh filename="{path}" scale="{_text(scale)}"/></geometry></visual>'


def fixed_angles(turn: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3"]:
    """Return roll, pitch and yaw [rad] about the fixed axes x, y, z; roll is 0 where only one of two is determined."""
    sine, cosine = -turn[2, 0], float(np.hypot(turn[2, 1], turn[2, 2]))
    pitch = np.arctan2(sine, cosine)
    if cosine > 1e-7:
        return np.array([np.arctan2(turn[2, 1], turn[2, 2]), pitch, np.arctan2(turn[1, 0], turn[0, 0])])
    return np.array([0.0, pitch, np.arctan2(-turn[0, 1], turn[1, 1])])


def _text(values: Float[np.ndarray, "3"]) -> str:
    """Return numbers with nine decimals, separated by spaces."""
    return " ".join(f"{value:.9f}" for value in values.tolist())
