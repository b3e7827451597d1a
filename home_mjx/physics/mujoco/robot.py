"""A robot of any MJCF in an exported house."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from home_mjx.errors import ConfigError
from home_mjx.mjcf.boxes import ONLY_MOVING
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.schema.compiled import CompiledHouse

PREFIX = "robot/"  # of all the robot's names
MEETS_LEAVES = 1 << 30  # bit of contact of doors' leaves and the robot; MJCF written by hand hardly uses it


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
    """A house with a robot in it, for C MuJoCo, MJX, and MuJoCo's viewer. Host only.

    Names of the robot's elements begin with `robot/`. It keeps its own defaults, actuators and sensors; options
    such as the timestep are the house's. Geoms of contact type 1, MuJoCo's default, meet the house; doors' leaves
    meet every geom of the robot that collides with anything.

    Args:
        house: A compiled house.
        robot: Its MJCF: a file, the text, or a `mujoco.MjSpec`, which is not changed.
        position: Of the robot's world frame [m]; None: the house's first start point, on the floor.
        yaw: Of that frame [rad], counter-clockwise from +x.
        timestep: [s]
        collision: `box` or `exact`, as in `to_mjcf`.
        movable: False: what could be moved stays in place, which is much quicker in MJX.
        visuals: False: leaves out all that is only seen, the robot's too.

    Returns:
        A `mujoco.MjSpec`, which can be changed further; its `compile()` gives the `mujoco.MjModel`.

    Raises:
        ConfigError: There is no such file, or it is no MJCF; what `to_mjcf` raises.
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
    _meet(spec, guest)
    x, y, z = house.navigation.start[0] if position is None else position
    quat = [np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]
    frame = spec.worldbody.add_frame(pos=[x, y, z], quat=quat)
    spec.attach(guest, prefix=PREFIX, frame=frame)
    return spec


def _read(robot: Any) -> Any:
    """A robot's `MjSpec`."""
    if isinstance(robot, mujoco.MjSpec):  # pyright: ignore[reportAttributeAccessIssue]
        return robot.copy()
    is_text = isinstance(robot, str) and robot.lstrip().startswith("<")
    if not is_text and not Path(robot).is_file():
        raise ConfigError("there is no such file", file=Path(robot), hint="Give an MJCF file, its text or an MjSpec")
    try:
        read = mujoco.MjSpec.from_string if is_text else mujoco.MjSpec.from_file  # pyright: ignore[reportAttributeAccessIssue]
        return read(str(robot))
    except ValueError as error:
        raise ConfigError(f"the robot is no MJCF: {error}", file=None if is_text else Path(robot)) from error


def _meet(house: Any, robot: Any) -> None:
    """Has leaves of doors, which meet only what moves, meet the robot."""
    for geom in house.geoms:
        if str(geom.contype) == ONLY_MOVING["contype"] and not geom.conaffinity:
            geom.contype |= MEETS_LEAVES
    for geom in robot.geoms:
        if geom.contype or geom.conaffinity:
            geom.conaffinity |= MEETS_LEAVES
