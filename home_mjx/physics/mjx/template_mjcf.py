"""MJCF shared by all houses of one capacity."""

import itertools
import math
import xml.etree.ElementTree as ET

import numpy as np

from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.surfaces import default_surface
from home_mjx.schema.mjcf import DOOR_DAMPING_RATE, SOLREF, add_agent, add_motors, solimp

PARKED_HEIGHT = 500.0  # [m], height of unused bodies above the house, and depth of unused slots below it
PARKED_SIZE = 0.1  # [m], half extent
PARKED_MASS = 1.0  # [kg]
CORNER_RADIUS = 1e-3  # [m], of the corner spheres of bodies
PARKED_RANGE = (-1.0, 1.0)  # [rad] or [m], joint range
PARKED_ARM, PARKED_YAW = (0.4, 0.1), 0.5  # [m], [rad], of leaves; nonzero to avoid `geom_sameframe`, as with slots
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)), np.float32)


def template_mjcf(config: PhysicsSetup, layout: Layout, jacobian: str) -> str:
    """Return the MJCF of an empty house with every body, door and slot parked; `jacobian` is MuJoCo's option.

    `jacobian`, `friction` and `restitution` of `config` are ignored; numbers of slots are those of `layout`.

    Door leaves collide with agents and bodies only, since the house defines their ranges. The joint type of a leaf
    cannot differ between houses: the last leaves slide.

    All contacts are explicit pairs. A slot therefore touches only its owner, and each kind of contact has its own
    dimension. Contacts of agents are frictionless (1 row per point instead of 4), hence agents slide along walls.

    Bodies touch the floor with tiny spheres at their corners. MJX's own plane-box contact ignores all corners more than
    1 mm above the lowest one, so that a tilted box would rock forever.
    """
    root = ET.Element("mujoco", model="home_mjx")
    ET.SubElement(root, "compiler", angle="radian")
    _add_options(root, config, layout, jacobian)
    world = ET.SubElement(root, "worldbody")
    # Offset and rotated, so that the compiler does not mark the geoms for shortcuts (`geom_sameframe`).
    plane, pos = _no_mask("floor"), f"0 0 {-PARKED_HEIGHT}"
    ET.SubElement(world, "geom", plane, type="plane", size="0 0 1", pos=pos, material="default")
    for name in slot_names(layout):
        ET.SubElement(world, "geom", _no_mask(name), type="box", size=_parked_size(), pos=pos, quat="0.8 0 0 0.6")
    for a in range(layout.num_agents):
        _add_agent(world, config, a)
    for k in range(layout.num_bodies):
        _add_body(world, k)
    for h in range(layout.num_doors):
        _add_door(world, h, layout.num_tray_boxes, slides=_slides(layout, h))
    _add_pairs(ET.SubElement(root, "contact"), config, layout)
    actuator = ET.SubElement(root, "actuator")
    for a in range(layout.num_agents):
        add_motors(actuator, f"agent{a}")
    return ET.tostring(root, encoding="unicode")


def slot_names(layout: Layout) -> list[str]:
    """Return the names of the slot geoms in order: `agent<a>_slot<s>` of all agents, then `body<k>_slot<s>`."""
    agents = [f"agent{a}_slot{s}" for a in range(layout.num_agents) for s in range(layout.agent_slots)]
    return agents + [f"body{k}_slot{s}" for k in range(layout.num_bodies) for s in range(layout.body_slots)]


def _add_agent(world: ET.Element, config: PhysicsSetup, a: int) -> None:
    """Add an agent without contacts: `_add_pairs` pairs its foot with the floor plane, its capsule with all else."""
    shape = config.agents[a]
    body = add_agent(world, shape, f"agent{a}", contype="0", conaffinity="0")
    foot, pos = _no_mask(f"agent{a}_foot"), f"0 0 {-shape.half_length}"
    ET.SubElement(body, "geom", foot, type="sphere", size=str(shape.radius), pos=pos, mass="0")


def _add_pair(contact: ET.Element, config: PhysicsSetup, first: str, second: str, agent: bool) -> None:
    """Add the contact pair of two geoms, given by name; frictionless if `agent`, else with `default_surface`.

    Friction and restitution of `config` are ignored: `with_surfaces` replaces those of movable bodies.
    """
    friction, stiffness, damping, _, _ = default_surface(config).tolist()  # of unused bodies
    body = {"condim": "3", "solref": f"{-stiffness} {-damping}", "friction": f"{friction} {friction}"}
    kind = {"condim": "1", "solref": SOLREF} if agent else body
    ET.SubElement(contact, "pair", kind, geom1=first, geom2=second, solimp=solimp())


def _add_options(root: ET.Element, config: PhysicsSetup, layout: Layout, jacobian: str) -> None:
    """Add solver options, MJX's limits of geom pairs and contact points as custom numerics, and a default material.

    Limits that are None in `config` are those that `PhysicsConfig` documents. `config.jacobian` is ignored in favour of
    `jacobian`. Damping is explicit (`eulerdamp` disabled).
    """
    option = ET.SubElement(
        root,
        "option",
        timestep=str(config.timing.sim_dt),
        iterations=str(config.iterations),
        ls_iterations=str(config.ls_iterations),
        jacobian=jacobian,
    )
    ET.SubElement(option, "flag", eulerdamp="disable")  # door damping is explicit; else MJX would factor M twice
    custom = ET.SubElement(root, "custom")
    boxes = 2 * layout.num_bodies + layout.num_doors + layout.num_slides * layout.num_tray_boxes
    pairs = config.max_geom_pairs or max(boxes, 4 * layout.num_agents, 8)
    points = config.max_contact_points or max(6 * layout.num_bodies, 8 * layout.num_agents, 16)
    ET.SubElement(custom, "numeric", name="max_geom_pairs", data=str(pairs))
    ET.SubElement(custom, "numeric", name="max_contact_points", data=str(points))
    # MJX's ray caster fails on models without a material.
    ET.SubElement(ET.SubElement(root, "asset"), "material", name="default")


def _add_body(world: ET.Element, k: int) -> None:
    """Add the parked movable body `body<k>` with a free joint: a box and eight spheres `body<k>_corner<c>`.

    Its geoms touch nothing before `_add_pairs`.
    """
    # Explicit inertia keeps the inertial frame equal to the body frame for all proportions of the box.
    body = ET.SubElement(world, "body", name=f"body{k}", pos=f"{2 * k} 0 {PARKED_HEIGHT}")
    ET.SubElement(body, "freejoint", name=f"body{k}")
    inertia = PARKED_MASS * 2 / 3 * PARKED_SIZE**2
    diagonal = f"{inertia} {inertia} {inertia}"
    ET.SubElement(body, "inertial", pos="0 0 0", mass=str(PARKED_MASS), diaginertia=diagonal)
    ET.SubElement(body, "geom", _no_mask(f"body{k}"), type="box", size=_parked_size())
    for c, corner in enumerate(CORNERS * (PARKED_SIZE - CORNER_RADIUS)):
        name, pos = f"body{k}_corner{c}", " ".join(str(float(x)) for x in corner)
        ET.SubElement(body, "geom", _no_mask(name), type="sphere", size=str(CORNER_RADIUS), pos=pos)


def _slides(layout: Layout, h: int) -> bool:
    """Return whether leaf `h` slides."""
    return h >= layout.num_doors - layout.num_slides


def _add_door(world: ET.Element, h: int, num_tray_boxes: int, slides: bool) -> None:
    """Add the parked door leaf `door<h>` with one limited joint: it slides along x if `slides`, else turns about z.

    Sliding ones have further boxes `door<h>_tray<t>`, parked below the house.
    """
    body = ET.SubElement(world, "body", name=f"door{h}", pos=f"{2 * h} 4 {PARKED_HEIGHT}")
    low, high = PARKED_RANGE
    kind, axis = ("slide", "1 0 0") if slides else ("hinge", "0 0 1")
    joint = {"name": f"door{h}", "type": kind, "axis": axis, "limited": "true", "range": f"{low} {high}"}
    x, y = PARKED_ARM
    inertia = PARKED_MASS * 2 / 3 * PARKED_SIZE**2
    moved = PARKED_MASS if slides else inertia + PARKED_MASS * (x * x + y * y)
    damping = DOOR_DAMPING_RATE * moved
    ET.SubElement(body, "joint", joint, damping=str(damping), solreflimit=SOLREF, solimplimit=solimp())
    at = {"pos": f"{x} {y} 0", "quat": f"{math.cos(PARKED_YAW / 2)} 0 0 {math.sin(PARKED_YAW / 2)}"}
    diagonal = f"{inertia} {inertia} {inertia}"
    ET.SubElement(body, "inertial", at, mass=str(PARKED_MASS), diaginertia=diagonal)
    ET.SubElement(body, "geom", _no_mask(f"door{h}") | at, type="box", size=_parked_size())
    below = at | {"pos": f"{x} {y} {-2 * PARKED_HEIGHT}"}
    for t in range(num_tray_boxes if slides else 0):
        ET.SubElement(body, "geom", _no_mask(f"door{h}_tray{t}") | below, type="box", size=_parked_size())


def _add_pairs(contact: ET.Element, config: PhysicsSetup, layout: Layout) -> None:
    """Add contact pairs: agents and bodies with their slots, doors and one another; feet and corners with the floor.

    Agents and bodies touch only their own slots. An agent's capsule and a body's box do not touch the floor; feet and
    corners touch nothing else. Doors touch neither one another nor slots nor the floor. Pairs with an agent are
    frictionless.
    """
    for a in range(layout.num_agents):
        others = [f"agent{a}_slot{s}" for s in range(layout.agent_slots)]
        others += [f"body{k}" for k in range(layout.num_bodies)] + [f"agent{b}" for b in range(a)]
        _add_pair(contact, config, f"agent{a}_foot", "floor", agent=True)
        for other in others:
            _add_pair(contact, config, f"agent{a}", other, agent=True)
    for k in range(layout.num_bodies):
        for c in range(len(CORNERS)):
            _add_pair(contact, config, f"body{k}_corner{c}", "floor", agent=False)
        others = [f"body{k}_slot{s}" for s in range(layout.body_slots)] + [f"body{j}" for j in range(k)]
        for other in others:
            _add_pair(contact, config, f"body{k}", other, agent=False)
    for h in range(layout.num_doors):
        trays = [f"door{h}_tray{t}" for t in range(layout.num_tray_boxes if _slides(layout, h) else 0)]
        for name in (f"door{h}", *trays):
            for a in range(layout.num_agents):
                _add_pair(contact, config, f"agent{a}", name, agent=True)
            for k in range(layout.num_bodies):
                _add_pair(contact, config, f"body{k}", name, agent=False)


def _no_mask(name: str) -> dict[str, str]:
    """Return attributes of a geom that touches nothing except by explicit pairs."""
    return {"name": name, "contype": "0", "conaffinity": "0"}


def _parked_size() -> str:
    """Return the half extents of a parked box as an MJCF attribute."""
    return f"{PARKED_SIZE} {PARKED_SIZE} {PARKED_SIZE}"
