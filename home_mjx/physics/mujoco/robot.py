"""Robots from any MJCF in an exported house."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from home_mjx.errors import ConfigError
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.mjcf import COLLIDES_WITH_MOVABLES

PREFIX = "robot/"  # prefix of all names of the robot's elements
LEAF_CONTACT_BIT = 1 << 30  # contact bit of door leaves and the robot; hand-written MJCF rarely uses it


def robot_in_house(
    house: CompiledHouse,
    robot: Any,
    position: tuple[float, float, float] | None = None,
    yaw: float = 0.0,
    *,
    timestep: float = 0.005,
    collision: str = "box",
    movable: bool = True,
    visuals: bool = True,
) -> Any:
    """Return a house that contains a robot, for C MuJoCo, MJX, and MuJoCo's viewer. Host only.

    Names of the robot's elements get the prefix `robot/`. The robot keeps its own defaults, actuators and sensors;
    options such as the timestep are the house's. Geoms of contact type 1, MuJoCo's default, collide with the house.
    Door leaves collide with every geom of the robot that collides with anything.

    Args:
        house: A compiled house.
        robot: MJCF file, MJCF text, or a `mujoco.MjSpec`, which is copied.
        position: Position of the robot's world frame [m]. None: the house's first start point, on the floor.
        yaw: Yaw of that frame [rad], counter-clockwise from +x.
        timestep: [s]
        collision: `box` or `exact`, as in `to_mjcf`.
        movable: If False, movable objects are fixed, which is much faster in MJX; door leaves and the robot are not.
        visuals: If False, visual-only geoms are omitted, including the robot's.

    Returns:
        A `mujoco.MjSpec`, which can be edited further; its `compile()` returns the `mujoco.MjModel`.

    Raises:
        ConfigError: The file does not exist or is not valid MJCF, or `to_mjcf` raises it.
        DatasetError: A texture of the house cannot be read.

    Example:
        >>> model = robot_in_house(house, "robot.xml", (1.0, 2.0, 0.0)).compile()  # doctest: +SKIP
    """
    xml, files = to_mjcf(house, timestep=timestep, collision=collision)
    spec = mujoco.MjSpec.from_string(xml, assets=files)  # pyright: ignore[reportAttributeAccessIssue]
    spec.compiler.discardvisual = not visuals
    if not movable:
        for joint in [j for j in spec.joints if j.type == mujoco.mjtJoint.mjJNT_FREE]:  # pyright: ignore[reportAttributeAccessIssue]
            spec.delete(joint)
    guest = _read(robot)
    _enable_leaf_contacts(spec, guest)
    x, y, z = house.navigation.start[0] if position is None else position
    quat = [np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]
    frame = spec.worldbody.add_frame(pos=[x, y, z], quat=quat)
    spec.attach(guest, prefix=PREFIX, frame=frame)
    return spec


def _read(robot: Any) -> Any:
    """Read or copy a robot as `MjSpec`; `ConfigError` if the file is missing or not valid MJCF.

    A text that begins with `<`, after white space, is MJCF; any other text or path is a file.
    """
    if isinstance(robot, mujoco.MjSpec):  # pyright: ignore[reportAttributeAccessIssue]
        return robot.copy()
    is_text = isinstance(robot, str) and robot.lstrip().startswith("<")
    if not is_text and not Path(robot).is_file():
        raise ConfigError("file does not exist", file=Path(robot), hint="Pass an MJCF file, MJCF text or an MjSpec")
    try:
        read = mujoco.MjSpec.from_string if is_text else mujoco.MjSpec.from_file  # pyright: ignore[reportAttributeAccessIssue]
        return read(str(robot))
    except ValueError as error:
        raise ConfigError(f"robot is not valid MJCF: {error}", file=None if is_text else Path(robot)) from error


def _enable_leaf_contacts(house: Any, robot: Any) -> None:
    """Let door leaves, which otherwise collide with movable bodies only, collide with the robot; change both specs.

    Leaves are the geoms with the masks `COLLIDES_WITH_MOVABLES`; `house` must not contain the robot yet. They get
    `LEAF_CONTACT_BIT` in `contype`. Geoms of the robot get it in `conaffinity`, unless both their masks are 0.
    """
    for geom in house.geoms:
        if str(geom.contype) == COLLIDES_WITH_MOVABLES["contype"] and not geom.conaffinity:
            geom.contype |= LEAF_CONTACT_BIT
    for geom in robot.geoms:
        if geom.contype or geom.conaffinity:
            geom.conaffinity |= LEAF_CONTACT_BIT
