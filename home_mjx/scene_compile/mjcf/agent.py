"""The agent and its contacts as MJCF: shared by exported houses and by the physics template."""

import xml.etree.ElementTree as ET

from home_mjx.schema.agent import Body

AGENT_SOLREF = "0.02 1"
# Softer than MuJoCo's 0.02 s: a friction pyramid lifts what slides, more so with a shorter time constant, and a light
# box that is pushed at 1 m/s hops (7 mm with 0.05 s, 12 mm with 0.02 s, at friction 0.4).
BODY_SOLREF = "0.05 1"
# Impedance of all contacts and limits: least, greatest, and width of the curve between [m]; MuJoCo's defaults. With
# 0.95 and 0.98 an agent presses a light box a third as deep into a wall, but MJX, not converged, parts from C.
SOLIMP = (0.9, 0.95, 0.001)

# What makes an agent's contacts frictionless, whatever it touches.
FRICTIONLESS = {"condim": "1", "priority": "1", "solref": AGENT_SOLREF, "solimp": " ".join(map(str, SOLIMP))}


def solimp() -> str:
    """`SOLIMP` as an attribute.

    Example:
        >>> solimp()
        '0.9 0.95 0.001'
    """
    return " ".join(map(str, SOLIMP))


def add_agent(world: ET.Element, shape: Body, name: str, **capsule: str) -> ET.Element:
    """Adds an agent: a capsule on three slides and a yaw hinge, so its joint positions are x, y, z and yaw.

    Args:
        world: The `worldbody` element.
        shape: Its size and mass.
        name: Name of body and capsule; joints are `<name>_x`, `_y`, `_z` and `_yaw`.
        **capsule: More attributes of the capsule.

    Returns:
        The body element.
    """
    body = ET.SubElement(world, "body", name=name)
    for joint, axis in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")):
        ET.SubElement(body, "joint", name=f"{name}_{joint}", type="slide", axis=axis)
    ET.SubElement(body, "joint", name=f"{name}_yaw", type="hinge", axis="0 0 1")
    size = f"{shape.radius} {shape.half_length}"
    ET.SubElement(body, "geom", capsule, name=name, type="capsule", size=size, mass=str(shape.mass))
    return body


def add_motors(actuator: ET.Element, name: str) -> None:
    """Adds an agent's motors: force along world x and y [N], torque about z [N m]."""
    for joint in ("x", "y", "yaw"):
        ET.SubElement(actuator, "motor", name=f"{name}_{joint}", joint=f"{name}_{joint}")
