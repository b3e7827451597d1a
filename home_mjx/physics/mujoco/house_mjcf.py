"""MJCF of one house from its rows of a bank: collision geometry only, no visuals."""

import xml.etree.ElementTree as ET
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import box_inertia
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.mjx.template_mjcf import CORNER_RADIUS, CORNERS
from home_mjx.schema.compiled import Doors
from home_mjx.schema.contact_materials import damping_ratio
from home_mjx.schema.mjcf import (
    COLLIDES_WITH_LEAVES,
    FRICTIONLESS_CONTACT,
    SOLREF,
    add_agent,
    add_leaf,
    body_contact_attributes,
    numbers,
    solimp,
)

ITERATIONS, LS_ITERATIONS, TOLERANCE = 100, 50, 1e-12  # Newton's method converges before these limits
# As in the template, the floor touches agents and the corner spheres of bodies, not their boxes.
FLOOR = {"contype": "12", "conaffinity": "0"}
CORNER = {"contype": "0", "conaffinity": "4"}
AGENT = {"contype": "3", "conaffinity": "11"}


class HouseRows(NamedTuple):
    """One house's rows of `bank.records.Physics`, under the same names."""

    floor: Float[np.ndarray, ""]
    collider_pos: Float[np.ndarray, "c 3"]
    collider_quat: Float[np.ndarray, "c 4"]
    collider_size: Float[np.ndarray, "c 3"]  # negative: omitted
    body_valid: Bool[np.ndarray, " k"]
    body_size: Float[np.ndarray, "k 3"]
    body_mass: Float[np.ndarray, " k"]
    body_friction: Float[np.ndarray, " k"]
    body_damping_ratio: Float[np.ndarray, " k"]
    door_valid: Bool[np.ndarray, " h"]
    door_pivot: Float[np.ndarray, "h 2"]
    door_pos: Float[np.ndarray, "h 3"]
    door_quat: Float[np.ndarray, "h 4"]
    door_size: Float[np.ndarray, "h 3"]
    door_mass: Float[np.ndarray, " h"]
    door_low: Float[np.ndarray, " h"]
    door_high: Float[np.ndarray, " h"]
    door_slide: Float[np.ndarray, "h 2"]
    tray_pos: Float[np.ndarray, "s t 3"]  # of the sliding leaves, the last ones
    tray_size: Float[np.ndarray, "s t 3"]


def house_mjcf(config: PhysicsSetup, rows: HouseRows) -> str:
    """Return the MJCF of a house with its agents.

    Bodies are named `agent<a>`, `body<k>` and `door<h>`, geoms `floor` and `static<c>`, numbered as in the bank. Unused
    bodies and doors, and static boxes without three positive half extents, are omitted: see `half_above_floor`.

    Every static box can touch every agent and movable body. Agents and movable bodies are at the origin, since the
    state sets their poses; doors are as authored. There are no actuators. Of `config`, the agents' bodies, the length
    of a physics step, `friction` and `restitution` are used.
    """
    root = ET.Element("mujoco", model="house")
    _add_options(root, config)
    default = ET.SubElement(root, "default")
    ET.SubElement(default, "geom", condim="3", solref=SOLREF, solimp=solimp())
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "geom", FLOOR, name="floor", type="plane", size="0 0 1", pos=f"0 0 {rows.floor:.9g}")
    for c in np.flatnonzero((rows.collider_size > 0).all(axis=-1)).tolist():
        place = {"pos": numbers(rows.collider_pos[c]), "quat": numbers(rows.collider_quat[c])}
        ET.SubElement(world, "geom", place, name=f"static{c}", type="box", size=numbers(rows.collider_size[c]))
    for a, shape in enumerate(config.agents):
        add_agent(world, shape, f"agent{a}", **FRICTIONLESS_CONTACT, **AGENT)
    for k in np.flatnonzero(rows.body_valid).tolist():
        _add_body(config, world, rows, k)
    doors = _doors(rows)
    inertia = box_inertia(doors.mass, doors.size)
    for h in np.flatnonzero(rows.door_valid).tolist():
        add_leaf(world, doors, h, f"door{h}", inertia[h])
    return ET.tostring(root, encoding="unicode")


def _add_options(root: ET.Element, config: PhysicsSetup) -> None:
    """Add solver options: Newton to convergence with a dense Jacobian; disable `eulerdamp` and `autoreset`.

    Of `config`, only the length of a physics step is used: `iterations`, `ls_iterations` and `jacobian` are ignored.
    """
    solver = {"iterations": str(ITERATIONS), "ls_iterations": str(LS_ITERATIONS), "tolerance": str(TOLERANCE)}
    # MuJoCo 4.0.0 uses a sparse Jacobian from 60 DoFs on, with which Newton's method stalls in some heaps of bodies.
    option = ET.SubElement(root, "option", solver, timestep=str(config.timing.sim_dt), jacobian="dense")
    # `eulerdamp` as in the template. Without `autoreset`, an unstable state is not silently reset.
    ET.SubElement(option, "flag", eulerdamp="disable", autoreset="disable")


def _add_body(config: PhysicsSetup, world: ET.Element, rows: HouseRows, k: int) -> None:
    """Add movable body `k` with a free joint at the origin: its box; corner spheres touch the floor in its place.

    `k` is its row. `friction` and `restitution` of `config`, unless None, replace those of `rows`.
    """
    body = ET.SubElement(world, "body", name=f"body{k}")
    ET.SubElement(body, "freejoint")
    inertia = numbers(box_inertia(rows.body_mass[k : k + 1], rows.body_size[k : k + 1]))
    ET.SubElement(body, "inertial", pos="0 0 0", mass=f"{rows.body_mass[k]:.9g}", diaginertia=inertia)
    friction = rows.body_friction[k] if config.friction is None else config.friction
    ratio = damping_ratio(config.restitution) if config.restitution is not None else rows.body_damping_ratio[k]
    touch = body_contact_attributes(float(friction), float(ratio), config.timing.sim_dt)
    ET.SubElement(body, "geom", COLLIDES_WITH_LEAVES | touch, type="box", size=numbers(rows.body_size[k]))
    for corner in CORNERS * (rows.body_size[k] - CORNER_RADIUS):
        ET.SubElement(body, "geom", CORNER | touch, type="sphere", size=str(CORNER_RADIUS), pos=numbers(corner))


def _doors(rows: HouseRows) -> Doors:
    """Convert the rows' doors, with padding, to the compiler's record, closed at `low` and fully open at `high`.

    `instance` is the row, not the door's instance in the house.
    """
    names = ("pivot", "pos", "quat", "size", "mass", "low", "high", "slide")
    place = {name: getattr(rows, f"door_{name}") for name in names}
    count = len(rows.door_valid)
    place["is_front"] = np.zeros(count, bool)  # leaves of both kinds are the same there
    for name, fill in (("tray_pos", 0.0), ("tray_size", -1.0)):
        own = getattr(rows, name)
        place[name] = np.concatenate([np.full((count - len(own), *own.shape[1:]), fill), own])
    return Doors(instance=np.arange(count), closed=rows.door_low, fully_open=rows.door_high, **place)
