"""Collision boxes, convex pieces and door leaves as MJCF."""

import xml.etree.ElementTree as ET

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.boxes import box_inertia
from home_mjx.mjcf.agent import SOLIMP
from home_mjx.mjcf.contact import contact_parameters
from home_mjx.schema.compiled import Doors

COLLIDER_GROUP = "3"  # geom group of colliders, hidden by default in the viewer
# Leaves collide with agents and movable objects, but not with each other or static geoms: their range prevents that.
COLLIDES_WITH_LEAVES = {"contype": "3", "conaffinity": "3"}
COLLIDES_WITH_MOVABLES = {"contype": "2", "conaffinity": "0"}
DOOR_DAMPING_RATE = 1.5  # [1/s], decay rate of a leaf's speed: damping of the hinge or rail per inertia or mass
BODY_PRIORITY = "1"  # contact priority of movable objects; above static geoms (0), below agents (2)


def numbers(values: Float[np.ndarray, "..."]) -> str:
    """Return numbers as the value of an MJCF attribute."""
    return " ".join(f"{x:.9g}" for x in np.ravel(values))


def body_contact_attributes(friction: float, ratio: float, timestep: float) -> dict[str, str]:
    """Return the contact attributes of a movable object's geoms, which take priority over static geoms.

    Args:
        friction: Coefficient of sliding friction.
        ratio: Damping ratio, see `sound_materials.contact.damping_ratio`.
        timestep: Length of a physics step [s].
    """
    stiffness, damping, low, width = contact_parameters(np.array(ratio), timestep)
    solref, impedance = numbers(np.array([-stiffness, -damping])), numbers(np.array([low, SOLIMP[1], width]))
    sliding = f"{friction:.9g} 0.005 0.0001"
    return {"priority": BODY_PRIORITY, "solref": solref, "solimp": impedance, "friction": sliding}


def add_box(parent: ET.Element, name: str, size: Float[np.ndarray, "3"], **more: str) -> None:
    """Add a collision box of half extents `size` [m]."""
    look = {"group": COLLIDER_GROUP, "rgba": "0.3 0.8 0.3 0.3"}
    ET.SubElement(parent, "geom", look | more, name=name, type="box", size=numbers(size))


def add_piece(parent: ET.Element, name: str, mesh: str, **more: str) -> None:
    """Add a convex piece as a collision geom."""
    look = {"group": COLLIDER_GROUP, "rgba": "0.3 0.8 0.3 0.3"}
    ET.SubElement(parent, "geom", look | more, name=name, type="mesh", mesh=mesh, mass="0")


def add_leaf(world: ET.Element, doors: Doors, row: int, name: str) -> tuple[ET.Element, Float[np.ndarray, "3"]]:
    """Add the body of a door leaf, on a hinge through the body's origin or on a rail.

    Args:
        world: The `worldbody` element.
        doors: All leaves.
        row: Row of the leaf.
        name: Name of body, joint and geom.

    Returns:
        The body and its origin [m].
    """
    origin = np.array([*doors.pivot[row], doors.pos[row, 2]])
    element = ET.SubElement(world, "body", name=name, pos=numbers(origin))
    limits, arm = np.array([doors.low[row], doors.high[row]]), doors.pos[row] - origin
    inertia, moved = box_inertia(doors.mass, doors.size)[row], doors.mass[row]
    if doors.is_sliding[row]:
        joint = {"type": "slide", "axis": numbers(np.array([*doors.slide[row], 0.0])), "range": numbers(limits)}
    else:
        joint = {"type": "hinge", "axis": "0 0 1", "range": numbers(np.rad2deg(limits))}
        moved = inertia[2] + doors.mass[row] * (arm @ arm)  # parallel axis theorem
    damping = f"{DOOR_DAMPING_RATE * moved:.9g}"
    ET.SubElement(element, "joint", joint, name=name, limited="true", damping=damping, armature="0")
    place = {"pos": numbers(arm), "quat": numbers(doors.quat[row])}
    ET.SubElement(element, "inertial", place, mass=f"{doors.mass[row]:.9g}", diaginertia=numbers(inertia))
    add_box(element, name, doors.size[row], **COLLIDES_WITH_MOVABLES, **place)
    return element, origin
