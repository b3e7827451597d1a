"""Agents and their contacts as MJCF, shared by exported houses and the physics template."""

import xml.etree.ElementTree as ET

from home_mjx.schema.agent import AgentBody

# An impact at speed v penetrates by v T / e, where T is the time constant: 4 cm at 5 m/s, resolved within a control
# step. With T = 0.05 s, thrown light objects stayed deep inside furniture for several steps. The price: the friction
# pyramid lifts sliding objects. A light box that is pushed at 1 m/s hops by 12 mm instead of 9 (friction 0.4).
TIME_CONSTANT = 0.02  # [s]
SOLREF = f"{TIME_CONSTANT} 1"  # for agents, door limits and contacts without restitution, see `in_contact`
# Impedance of all contacts and limits: minimum, maximum, and width of the transition [m]; MuJoCo's defaults.
SOLIMP = (0.9, 0.95, 0.001)


def solimp() -> str:
    """Return `SOLIMP` as an MJCF attribute.

    Example:
        >>> solimp()
        '0.9 0.95 0.001'
    """
    return " ".join(map(str, SOLIMP))


# Geom attributes that make all contacts of an agent frictionless.
FRICTIONLESS_CONTACT = {"condim": "1", "priority": "2", "solref": SOLREF, "solimp": solimp()}


def add_agent(world: ET.Element, shape: AgentBody, name: str, **capsule: str) -> ET.Element:
    """Add an agent: a capsule on three slides and a yaw hinge, so its joint positions are x, y, z and yaw.

    Args:
        world: The `worldbody` element.
        shape: Size and mass of the agent.
        name: Name of body and capsule; joints are `<name>_x`, `_y`, `_z` and `_yaw`.
        **capsule: Additional attributes of the capsule.

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
    """Add an agent's motors: force along world x and y [N], torque about z [N m]."""
    for joint in ("x", "y", "yaw"):
        ET.SubElement(actuator, "motor", name=f"{name}_{joint}", joint=f"{name}_{joint}")
