"""MJCF fragments that exported houses and the physics template share: agents, boxes, door leaves, contacts.

Contacts in MuJoCo are damped springs. In half a period of a free oscillator, a damping ratio z results in the
restitution e = exp(-pi z / sqrt(1 - z^2)). A contact can only push, so in continuous time e would be slightly larger
(Schwager and Poeschel 2007, "Coefficient of restitution and linear-dashpot model revisited"). With steps of half the
inverse frequency it is e again: averaged over all phases of the step within 0.05, single bounces within 0.2, never
above 1.

In a physics step of 0.01 s gravity adds 0.1 m/s, so that a bouncing object would never come to rest. Therefore the
impedance of such contacts begins low: at small penetration they are soft and at least critically damped, so that slow
bounces decay.
"""

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import Doors

COLLIDER_GROUP = "3"  # geom group of colliders, hidden by default in the viewer
# Leaves collide with agents and movable objects, but not with each other or static geoms: their range prevents that.
COLLIDES_WITH_LEAVES = {"contype": "3", "conaffinity": "3"}
COLLIDES_WITH_MOVABLES = {"contype": "2", "conaffinity": "0"}
DOOR_DAMPING_RATE = 1.5  # [1/s], decay rate of a leaf's speed: damping of the hinge or rail per inertia or mass
BODY_PRIORITY = "1"  # contact priority of movable objects; above static geoms (0), below agents (2)
# An impact at speed v penetrates by v T / e, where T is the time constant: 4 cm at 5 m/s, resolved within a control
# step. With T = 0.05 s, thrown light objects stayed deep inside furniture for several steps. The price: the friction
# pyramid lifts sliding objects. A light box that is pushed at 1 m/s hops by 12 mm instead of 9 (friction 0.4).
TIME_CONSTANT = 0.02  # [s]
SOLREF = f"{TIME_CONSTANT} 1"  # for agents, door limits and contacts without restitution, see `contact_parameters`
# Impedance of all contacts and limits: minimum, maximum, and width of the transition [m]; MuJoCo's defaults.
SOLIMP = (0.9, 0.95, 0.001)
IMPEDANCE_WIDTH_RATE = 25.0  # [m/s^2], width of the impedance transition per squared length of a physics step


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

    The body's origin is the capsule's centre. Attributes in `capsule` do not replace name, type, size and mass.

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
    """Add motors for the x, y and yaw joints of agent `name`: force along world x and y [N], torque about z [N m].

    They have no limits.
    """
    for joint in ("x", "y", "yaw"):
        ET.SubElement(actuator, "motor", name=f"{name}_{joint}", joint=f"{name}_{joint}")


def contact_parameters(ratio: Any, timestep: float, xp: Any = np) -> tuple[Any, Any, Any, Any]:
    """Return contact parameters: stiffness [1/s^2], damping [1/s], minimum impedance and transition width [m].

    For a time constant T they are 1 / T^2 and 2 z / T, where z is the damping ratio. For z < 1, the minimum impedance
    is z^2 / 2 and the width `IMPEDANCE_WIDTH_RATE * timestep**2`, at least that of `SOLIMP`; otherwise both are those
    of `SOLIMP`.

    Each has the shape of `ratio`. Stiffness and damping, negated, are `solref` in MuJoCo's direct format. For a contact
    of two movable objects, MuJoCo mixes these by maximum damping, so the object with less restitution dominates. In its
    other format (time constant and damping ratio), it would take the means, and a ball would sink into a cushion.
    Impedances are always averaged.

    Args:
        ratio: Damping ratio as an array of floats, see `schema.contact_materials.damping_ratio`; 1: no restitution.
        timestep: Length of a physics step [s]; T is `max(TIME_CONSTANT, 2 * timestep)`.
        xp: `numpy` or `jax.numpy`.

    Example:
        >>> [float(x) for x in contact_parameters(np.ones(()), 0.01)]  # a time constant of 0.02 s
        [2500.0, 100.0, 0.9, 0.001]
    """
    constant = max(TIME_CONSTANT, 2 * timestep)  # the minimum that MuJoCo allows
    rate = xp.full_like(ratio, 1 / constant)  # natural frequency; equal for all ratios, stable up to damping 2 rate
    low = xp.where(ratio < 1, ratio * ratio / 2, SOLIMP[0])
    width = xp.where(ratio < 1, xp.full_like(ratio, max(IMPEDANCE_WIDTH_RATE * timestep**2, SOLIMP[2])), SOLIMP[2])
    return rate * rate, 2 * ratio * rate, low, width


def numbers(values: Float[np.ndarray, "..."]) -> str:
    """Return numbers as an MJCF attribute: row by row, nine significant digits, separated by spaces."""
    return " ".join(f"{x:.9g}" for x in np.ravel(values))


def body_contact_attributes(friction: float, ratio: float, timestep: float) -> dict[str, str]:
    """Return the contact attributes of a movable object's geoms, which take priority over static geoms.

    Coefficients of torsional and rolling friction are MuJoCo's defaults.

    Args:
        friction: Coefficient of sliding friction.
        ratio: Damping ratio, see `schema.contact_materials.damping_ratio`.
        timestep: Length of a physics step [s].
    """
    stiffness, damping, low, width = contact_parameters(np.array(ratio), timestep)
    solref, impedance = numbers(np.array([-stiffness, -damping])), numbers(np.array([low, SOLIMP[1], width]))
    sliding = f"{friction:.9g} 0.005 0.0001"
    return {"priority": BODY_PRIORITY, "solref": solref, "solimp": impedance, "friction": sliding}


def add_box(parent: ET.Element, name: str, size: Float[np.ndarray, "3"], **more: str) -> None:
    """Add a box geom of half extents `size` [m] in the group of colliders, green and translucent.

    `more` adds attributes, such as `pos`, or replaces `group` and `rgba`.
    """
    look = {"group": COLLIDER_GROUP, "rgba": "0.3 0.8 0.3 0.3"}
    ET.SubElement(parent, "geom", look | more, name=name, type="box", size=numbers(size))


def add_piece(parent: ET.Element, name: str, mesh: str, **more: str) -> None:
    """Add mesh asset `mesh`, a convex piece, as a massless geom in the group of colliders; `more` as in `add_box`."""
    look = {"group": COLLIDER_GROUP, "rgba": "0.3 0.8 0.3 0.3"}
    ET.SubElement(parent, "geom", look | more, name=name, type="mesh", mesh=mesh, mass="0")


def add_leaf(
    world: ET.Element, doors: Doors, row: int, name: str, inertia: Float[np.ndarray, "3"]
) -> tuple[ET.Element, Float[np.ndarray, "3"]]:
    """Add the body of a door leaf with its inertia and box geoms, on a hinge through its origin or on a rail.

    The joint is limited to the leaf's range and damped. The geom collides with agents and movable objects, not with
    static geoms and other leaves.

    Args:
        world: The `worldbody` element.
        doors: All leaves.
        row: Row of the leaf.
        name: Name of body, joint and geom.
        inertia: Principal moments of inertia of the leaf about its centre [kg m^2], see `geometry.boxes.box_inertia`.

    Returns:
        The body, and its origin in the world [m]: the `pivot`, at the height of the leaf's centre.
    """
    origin = np.array([*doors.pivot[row], doors.pos[row, 2]])
    element = ET.SubElement(world, "body", name=name, pos=numbers(origin))
    limits, arm = np.array([doors.low[row], doors.high[row]]), doors.pos[row] - origin
    moved = doors.mass[row]
    if doors.is_sliding[row]:
        joint = {"type": "slide", "axis": numbers(np.array([*doors.slide[row], 0.0])), "range": numbers(limits)}
    else:
        joint = {"type": "hinge", "axis": "0 0 1", "range": numbers(np.rad2deg(limits))}
        moved = inertia[2] + doors.mass[row] * (arm @ arm)  # parallel axis theorem
    damping = f"{DOOR_DAMPING_RATE * moved:.9g}"
    rest = np.rad2deg(doors.closed[row]) if joint["type"] == "hinge" else doors.closed[row]
    joint["springref"] = f"{rest:.9g}"  # without stiffness; tells readers the closed pose
    ET.SubElement(element, "joint", joint, name=name, limited="true", damping=damping, armature="0")
    place = {"pos": numbers(arm), "quat": numbers(doors.quat[row])}
    ET.SubElement(element, "inertial", place, mass=f"{doors.mass[row]:.9g}", diaginertia=numbers(inertia))
    add_box(element, name, doors.size[row], **COLLIDES_WITH_MOVABLES, **place)
    _add_tray(element, doors, row, name, arm)
    return element, origin


def _add_tray(element: ET.Element, doors: Doors, row: int, name: str, arm: Float[np.ndarray, "3"]) -> None:
    """Add the boxes `<name>_tray<t>` of a drawer to its body; none for other leaves. `arm` is its box's centre [m]."""
    if not doors.num_tray_boxes:
        return
    w, _, _, z = doors.quat[row]  # about z only
    turn = np.array([[w * w - z * z, -2 * w * z, 0], [2 * w * z, w * w - z * z, 0], [0, 0, 1]])
    for t, (pos, size) in enumerate(zip(doors.tray_pos[row], doors.tray_size[row], strict=True)):
        if size[0] >= 0:
            place = {"pos": numbers(arm + turn @ pos), "quat": numbers(doors.quat[row])}
            add_box(element, f"{name}_tray{t}", size, **COLLIDES_WITH_MOVABLES, **place)
