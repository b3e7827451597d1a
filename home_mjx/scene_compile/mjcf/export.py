"""Export of a compiled house as a full MJCF model, for MuJoCo's viewer and as the reference of the batched physics."""

import json
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.files import replace_folder
from home_mjx.errors import ConfigError
from home_mjx.geometry.boxes import box_inertia
from home_mjx.scene_compile.architecture.rooms import ground_floor_height
from home_mjx.scene_compile.collision.barriers import lot_bounds
from home_mjx.scene_compile.mjcf.assets import MjcfAssets, safe_name
from home_mjx.scene_compile.mjcf.initial_overlaps import resolve_overlaps
from home_mjx.scene_compile.mjcf.lights import add_lamps
from home_mjx.scene_compile.mjcf.room_file import room_file
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.categories import COARSE, COLLISIONS
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.contact_materials import DEFAULT_CONTACT, damping_ratio
from home_mjx.schema.mjcf import (
    COLLIDER_GROUP,
    COLLIDES_WITH_LEAVES,
    FRICTIONLESS_CONTACT,
    SOLREF,
    add_agent,
    add_box,
    add_leaf,
    add_motors,
    add_piece,
    body_contact_attributes,
    numbers,
    solimp,
)
from home_mjx.schema.semantic import Semantic

DEFAULT_FRICTION = f"{DEFAULT_CONTACT.friction} 0.005 0.0001"  # default friction of geoms
MJCF_FILE, ROOM_FILE, OVERLAPS_FILE = "house.xml", "house.rooms.json", "overlaps.json"
EYE_HEIGHT = AgentBody().eye_height  # [m], height of the room cameras above the floor
NYU40_CEILING_INDEX, ROOF_INDEX = 22, COARSE.index("roof")
VISUAL_GROUP, CEILING_GROUP = "2", "4"  # geom groups; the viewer shows groups 0 to 2 by default


def to_mjcf(
    house: CompiledHouse,
    *,
    agent: AgentBody | None = None,
    timestep: float = 0.005,
    friction: float | None = None,
    restitution: float | None = None,
    collision: str = "box",
) -> tuple[str, dict[str, bytes]]:
    """Return the MJCF of a house and the files that it refers to.

    Every object is a body `object<id>` with visual meshes in group 2. Ceilings and roofs are in group 4, so that they
    can be hidden to look in from above. Movable objects have a free joint, a mass and one box or convex pieces
    (group 3). A door leaf is a body `object<id>_leaf<instance>`, with a hinge or slide joint of the same name. Static
    boxes and the floor plane belong to the world. Cameras: `top`, `room<i>`, and `agent0_eye` with an agent. Lights:
    `lamp<i>`, and a faint directional one from above.

    Args:
        house: A compiled house.
        agent: Adds an agent at the first start point, with motors (see `schema.mjcf`) and a keyframe `start`.
        timestep: Length of a physics step [s].
        friction: Sliding friction of all movable objects; None: by material. Agents are frictionless.
        restitution: Restitution of all movable objects; None: by material.
        collision: `box` or `exact`, which has convex pieces in place of objects' boxes. Objects that then overlap
            others are moved by up to 5 cm, or their contact is excluded; the file `overlaps.json` lists them.

    Returns:
        The XML and file contents by relative path, as `mujoco.MjModel.from_xml_string` expects them.

    Raises:
        ConfigError: `exact` without the extra of that name, an unknown kind of collision, or an invalid timestep.
        DatasetError: A texture cannot be read.

    Example:
        >>> model = mujoco.MjModel.from_xml_string(*to_mjcf(house))  # doctest: +SKIP
    """
    check_known("collision", [collision], COLLISIONS)
    check_number("timestep", timestep, 1e-6)
    root = ET.Element("mujoco", model=safe_name(house.id))
    ET.SubElement(root, "option", timestep=str(timestep), integrator="implicitfast")
    bounds = _plot(house)
    center, extent = bounds.mean(axis=0), float(np.ptp(bounds, axis=0).max())
    ET.SubElement(root, "statistic", center=numbers(center), extent=f"{extent:.6g}")
    default = ET.SubElement(root, "default")
    ET.SubElement(default, "geom", condim="3", friction=DEFAULT_FRICTION, solref=SOLREF, solimp=solimp())
    world = ET.Element("worldbody")
    _add_surroundings(world, house)
    add_lamps(world, house)
    assets = MjcfAssets(house)
    exact = collision == "exact"
    bodies = zip(house.bodies.friction.tolist(), house.bodies.restitution.tolist(), strict=True)
    touches = [
        body_contact_attributes(
            mu if friction is None else friction, damping_ratio(e if restitution is None else restitution), timestep
        )
        for mu, e in bodies
    ]
    _add_static_boxes(world, house, exact)
    for instance in range(len(house.instances.model)):
        _add_instance(world, house, instance, assets, exact, touches)
    root.extend([assets.element, world])
    files = assets.files
    if exact:
        overlaps = resolve_overlaps(root, files)
        files = {**files, OVERLAPS_FILE: json.dumps(overlaps, indent=1).encode()}
    if agent is not None:
        _add_agent(root, world, house, agent)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode"), files


def export_mjcf(house: CompiledHouse, folder: Path, agent: AgentBody | None = None, collision: str = "box") -> Path:
    """Write the result of `to_mjcf` to `<folder>/<name>/house.xml`, with meshes and textures beside it, atomically.

    `house.rooms.json` beside it states rooms and categories, so that `mjcf:<folder>` reads the house again.
    The name is the house's id by `safe_name`. Options that are no argument here have their defaults.

    Args:
        house: A compiled house.
        folder: Created if missing. A folder of that name in it is replaced with all its files if it has a `house.xml`.
        agent: As in `to_mjcf`.
        collision: As in `to_mjcf`.

    Returns:
        Path of the MJCF file.

    Raises:
        ConfigError: The target exists and is not an export, or it cannot be written; or as in `to_mjcf`.
        DatasetError: A texture cannot be read.
    """
    xml, files = to_mjcf(house, agent=agent, collision=collision)
    target = Path(folder) / safe_name(house.id)
    if target.exists() and not (target / MJCF_FILE).is_file():
        raise ConfigError("folder exists and is not an exported house", file=target, hint="Choose another folder")
    try:
        replace_folder(target, {**files, ROOM_FILE: room_file(house), MJCF_FILE: xml.encode()})
    except OSError as error:
        raise ConfigError(f"cannot write: {error}", file=target, hint="Choose another folder") from error
    return target / MJCF_FILE


def split_linear(linear: Float[np.ndarray, "3 3"]) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3 3"]]:
    """Split a linear map into a rotation and a preceding diagonal stretch, negative in x for mirrored maps.

    A sheared or flat map is returned as the stretch, with the identity as the rotation.

    Example:
        >>> split_linear(np.diag([2.0, 1.0, -1.0]))[1]
        array([[-2.,  0.,  0.],
               [ 0.,  1.,  0.],
               [ 0.,  0.,  1.]])
    """
    scale = np.linalg.norm(linear, axis=0)
    if np.linalg.det(linear) < 0:
        scale[0] = -scale[0]
    if (scale == 0).any():
        return np.eye(3), linear
    rotation = linear / scale
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > 1e-6:
        return np.eye(3), linear
    return rotation, np.diag(scale)


def _quat(rotation: Float[np.ndarray, "3 3"]) -> str:
    """Return a rotation as an MJCF quaternion (wxyz)."""
    return numbers(Rotation.from_matrix(rotation).as_quat(scalar_first=True))


def _add_surroundings(world: ET.Element, house: CompiledHouse) -> None:
    """Add the plane `floor`, a directional light without shadows, and cameras `top` and `room<i>`.

    Rooms without an outline have no camera.
    """
    floor = ground_floor_height(house.rooms)
    ET.SubElement(world, "geom", name="floor", type="plane", size="0 0 1", pos=f"0 0 {floor:.9g}", group=COLLIDER_GROUP)
    # Without shadows, since ceilings would block the light.
    ET.SubElement(world, "light", type="directional", dir="0.3 0.2 -1", castshadow="false", diffuse="0.4 0.4 0.4")
    bounds = _plot(house)
    middle, size = bounds.mean(axis=0), np.ptp(bounds, axis=0)
    high = bounds[1, 2] + 1.3 * max(size[:2])  # with a fovy of 45 degrees
    ET.SubElement(world, "camera", name="top", pos=numbers(np.array([middle[0], middle[1], high])))
    for i, (polygon, height) in enumerate(zip(house.rooms.polygon, house.rooms.floor, strict=True)):
        if not len(polygon):
            continue
        pos = numbers(np.array([*polygon.mean(axis=0), height + EYE_HEIGHT]))
        ET.SubElement(world, "camera", _looking_along_x(), name=f"room{i}", pos=pos)


def _plot(house: CompiledHouse) -> Float[np.ndarray, "2 3"]:
    """Return the bounding box of the house [m], clipped in x and y to `lot_bounds`: no gardens and neighbours."""
    (x0, y0), (x1, y1) = lot_bounds(house.rooms)
    return np.clip(house.box, [x0, y0, -np.inf], [x1, y1, np.inf])


def _looking_along_x() -> dict[str, str]:
    """Return attributes of a camera that looks along +x of its body, up +z, with a fovy of 75 degrees."""
    return {"xyaxes": "0 -1 0 0 0 1", "fovy": "75"}


def _add_static_boxes(world: ET.Element, house: CompiledHouse, exact: bool) -> None:
    """Add collider rows i as geoms `static<i>`; with `exact` without those of objects, except the ramps of stairs."""
    boxes, ramps = house.colliders, set(house.ramps.collider.tolist())
    for i, (pos, quat, size) in enumerate(zip(boxes.pos, boxes.quat, boxes.size, strict=True)):
        if not exact or boxes.object_id[i] < 0 or i in ramps:
            add_box(world, f"static{i}", size, pos=numbers(pos), quat=numbers(quat))


def _add_instance(
    world: ET.Element,
    house: CompiledHouse,
    instance: int,
    assets: MjcfAssets,
    exact: bool,
    touches: Sequence[dict[str, str]],
) -> None:
    """Add the body of one instance with its visuals and colliders.

    A leaf has a box. A movable body has a box or, if `exact`, its convex pieces if any. Other instances have pieces if
    `exact` and their object is solid, else no colliders. `touches` has the contact attributes of each movable body, by
    its row.
    """
    body, leaf = int(house.instances.body[instance]), np.flatnonzero(house.doors.instance == instance)
    name = instance_name(house, instance)
    pose = house.instances.pose[instance]
    rotation, stretch = split_linear(pose[:, :3])
    if len(leaf):
        row, doors = int(leaf[0]), house.doors
        element, origin = add_leaf(world, doors, row, name, box_inertia(doors.mass, doors.size)[row])
        _add_visuals(element, house, instance, assets, stretch, pos=numbers(pose[:, 3] - origin), quat=_quat(rotation))
    elif body < 0:
        place = {"pos": numbers(pose[:, 3]), "quat": _quat(rotation)}
        element = ET.SubElement(world, "body", place, name=name)
        _add_visuals(element, house, instance, assets, stretch)
        if exact and house.instances.object_id[instance] in _solid_objects(house):
            _add_pieces(element, house, instance, assets, stretch)
    else:
        element = _add_movable(world, house, body, name)
        inner = house.bodies.from_model[body]
        rotation, stretch = split_linear(inner[:, :3])
        place = {"pos": numbers(inner[:, 3]), "quat": _quat(rotation)}
        _add_visuals(element, house, instance, assets, stretch, **place)
        touch = COLLIDES_WITH_LEAVES | touches[body]
        if not exact or not _add_pieces(element, house, instance, assets, stretch, **place, **touch):
            add_box(element, name, house.bodies.size[body], **touch)


def _solid_objects(house: CompiledHouse) -> set[int]:
    """Return the ids of objects with colliders, except stairs, on which agents climb ramps."""
    return set(house.colliders.object_id.tolist()) - set(house.ramps.object_id.tolist()) - {-1}


def instance_name(house: CompiledHouse, instance: int) -> str:
    """Return `architecture`, `object<id>` or, after an instance of the same object, `object<id>_leaf<instance>`."""
    owner = house.instances.object_id
    if instance == ARCHITECTURE:
        return "architecture"
    return f"object{owner[instance]}" + (f"_leaf{instance}" if owner[instance - 1] == owner[instance] else "")


def _add_movable(world: ET.Element, house: CompiledHouse, body: int, name: str) -> ET.Element:
    """Add the body of a movable object, with a free joint and the inertia of its box, and return it."""
    bodies = house.bodies
    place = {"pos": numbers(bodies.pos[body]), "quat": numbers(bodies.quat[body])}
    element = ET.SubElement(world, "body", place, name=name)
    ET.SubElement(element, "freejoint", name=name)
    mass = float(bodies.mass[body])
    inertia = numbers(box_inertia(bodies.mass[body : body + 1], bodies.size[body : body + 1]))
    ET.SubElement(element, "inertial", pos="0 0 0", mass=f"{mass:.9g}", diaginertia=inertia)
    return element


def _add_pieces(
    element: ET.Element,
    house: CompiledHouse,
    instance: int,
    assets: MjcfAssets,
    stretch: Float[np.ndarray, "3 3"],
    **more: str,
) -> int:
    """Add the convex pieces of an instance as collision geoms with the attributes `more`, and return their number."""
    meshes = assets.pieces(house.models[house.instances.model[instance]], stretch)
    for i, mesh in enumerate(meshes):
        add_piece(element, f"piece{instance}_{i}", mesh, **more)
    return len(meshes)


def _add_visuals(
    element: ET.Element,
    house: CompiledHouse,
    instance: int,
    assets: MjcfAssets,
    stretch: Float[np.ndarray, "3 3"],
    **place: str,
) -> None:
    """Add a mesh geom without contacts, with attributes `place`, per material slot; roofs get the ceilings' group."""
    model = house.models[house.instances.model[instance]]
    first = int(house.instances.material[instance])
    for slot in np.unique(model.slot).tolist():
        mesh = assets.mesh(model, slot, stretch)
        if mesh is not None:
            group = CEILING_GROUP if _is_ceiling(house, instance, slot) else VISUAL_GROUP
            look = {"group": group, "contype": "0", "conaffinity": "0", "mass": "0"}
            ET.SubElement(element, "geom", look | place, type="mesh", mesh=mesh, material=assets.material(first + slot))


def _is_ceiling(house: CompiledHouse, instance: int, slot: int) -> bool:
    """Return whether all parts with a material slot are ceilings or roofs."""
    model = house.models[house.instances.model[instance]]
    rows = house.instances.semantic[instance] + np.unique(model.part[model.slot == slot])
    table = house.semantics[rows]
    return bool(((table[:, Semantic.NYU40] == NYU40_CEILING_INDEX) | (table[:, Semantic.COARSE] == ROOF_INDEX)).all())


def _add_agent(root: ET.Element, world: ET.Element, house: CompiledHouse, shape: AgentBody) -> None:
    """Add an agent without friction, with camera and motors, and a keyframe with it at the first start point.

    The instances must be in `world` already, since the keyframe has their poses.
    """
    body = add_agent(world, shape, "agent0", group=COLLIDER_GROUP, **FRICTIONLESS_CONTACT, **COLLIDES_WITH_LEAVES)
    eye = f"0 0 {shape.eye_height - shape.height / 2:.9g}"
    ET.SubElement(body, "camera", _looking_along_x(), name="agent0_eye", pos=eye)
    add_motors(ET.SubElement(root, "actuator"), "agent0")
    doors, (x, y, z) = house.doors, house.navigation.start[0]
    names = {int(i): f"object{house.instances.object_id[i]}" for i in house.bodies.instance}
    start = {i: _pose_of(world, name) for i, name in names.items()}
    start |= {int(i): np.clip([0.0], *r) for i, *r in zip(doors.instance, doors.low, doors.high, strict=True)}
    joints = [start[i] for i in sorted(start)]  # in the order of their instances
    qpos = numbers(np.concatenate([*joints, [x, y, z + shape.height / 2, 0.0]]))
    ET.SubElement(ET.SubElement(root, "keyframe"), "key", name="start", qpos=qpos)


def _pose_of(world: ET.Element, name: str) -> Float[np.ndarray, "7"]:
    """Return the position and quaternion (wxyz) of the body `name`, as in `qpos`."""
    (body,) = world.iterfind(f"body[@name='{name}']")
    return np.array(f"{body.attrib['pos']} {body.attrib['quat']}".split(), float)
