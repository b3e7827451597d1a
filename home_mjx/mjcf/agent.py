"""The agent and its contacts as MJCF: shared by exported houses and by the physics template."""

import xml.etree.ElementTree as ET

from home_mjx.schema.agent import Body

# What strikes at speed v goes v T / e deep, T the time constant: 4 cm at 5 m/s, and out again within a control step.
# With 0.05 s light things that were thrown stayed deep in furniture for several steps. The price: a friction pyramid
# lifts what slides, and a light box that is pushed at 1 m/s hops by 12 mm instead of 9 (friction 0.4).
TIME_CONSTANT = 0.02  # [s]
SOLREF = f"{TIME_CONSTANT} 1"  # of agents, of ends of doors' ways, and of what does not bounce, see `contact`
# Impedance of all contacts and limits: least, greatest, and width of the curve between [m]; MuJoCo's defaults.
SOLIMP = (0.9, 0.95, 0.001)


def solimp() -> str:
    """`SOLIMP` as an attribute.

    Example:
        >>> solimp()
        '0.9 0.95 0.001'
    """
    return " ".join(map(str, SOLIMP))


# What makes an agent's contacts frictionless, whatever it touches.
FRICTIONLESS = {"condim": "1", "priority": "2", "solref": SOLREF, "solimp": solimp()}


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
