"""Initial overlaps of movable objects: a small shift or an excluded contact, and a test that objects stay at rest."""

# MuJoCo defines its types lazily, where pyright does not find them.
# pyright: reportAttributeAccessIssue=false

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from jaxtyping import Float

from home_mjx.schema.mjcf import numbers

MAX_SHIFT = 0.05  # [m], maximum shift of an object
MIN_OVERLAP_DEPTH = 1e-3  # [m], contacts with a larger penetration are overlaps
MAX_SHIFT_STEPS = 20  # maximum number of shifts per object


def resolve_overlaps(root: ET.Element, files: Mapping[str, bytes]) -> list[dict[str, Any]]:
    """Move every free body onto the floor (at most 5 cm), then sideways out of overlaps (at most 5 cm).

    A move that would have to be longer is left out.

    Args:
        root: The `mujoco` element, changed in place: body positions, and contact exclusions for remaining overlaps.
        files: The files that it refers to.

    Returns:
        For each body that was moved or has exclusions: `object`, `shift` [m] and `excluded`, the names of other bodies.
    """
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"), dict(files))
    data = mujoco.MjData(model)
    bodies = [int(model.jnt_bodyid[j]) for j in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)]
    shift = {body: _onto_floor(model, data, body) for body in bodies}
    for body in bodies:
        shift[body] = _separate(model, data, body, shift[body])
    pairs = _overlaps(model, data)
    found = []
    for body in bodies:
        others = sorted({model.body(b if a == body else a).name for a, b in pairs if body in (a, b)})
        if others or np.abs(shift[body]).max() > 1e-6:
            name = model.body(body).name
            _move(root, name, shift[body])
            found.append({"object": name, "shift": np.round(shift[body], 6).tolist(), "excluded": others})
    contact = ET.SubElement(root, "contact")
    for a, b in sorted({(min(pair), max(pair)) for pair in pairs}):
        ET.SubElement(contact, "exclude", body1=model.body(a).name, body2=model.body(b).name)
    return found


def _onto_floor(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> Float[np.ndarray, "3"]:
    """Move a body in `data` vertically, its lowest point onto the floor plane, and return the shift [m].

    The shift is zero if it would exceed `MAX_SHIFT`.
    """
    mujoco.mj_kinematics(model, data)
    floor = model.geom("floor").pos[2]
    shift = np.array([0.0, 0.0, floor - _lowest(model, data, body)])
    shift[2] = shift[2] if abs(shift[2]) <= MAX_SHIFT else 0.0  # another object supports it
    _put(model, data, body, shift)
    return shift


def _lowest(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> float:
    """Return the height of the lowest vertex of a body's solid geoms, meshes or boxes [m]; inf without any."""
    low = np.inf
    for geom in _solid_geoms(model, body):
        turn, mesh = data.geom_xmat[geom].reshape(3, 3), model.geom_dataid[geom]
        if mesh >= 0:
            points = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        else:
            points = model.geom_size[geom] * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
        low = min(low, float((points @ turn[2]).min() + data.geom_xpos[geom, 2]))
    return low


def _solid_geoms(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the ids of a body's geoms that can have contacts."""
    first = model.body_geomadr[body]
    geoms = np.arange(first, first + model.body_geomnum[body])
    return geoms[model.geom_contype[geoms] > 0].tolist()


def _separate(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, shift: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    """Move a body horizontally out of all overlaps and return its total shift [m], including the earlier one, `shift`.

    If no such place within `MAX_SHIFT` is found in `MAX_SHIFT_STEPS` steps, move it back and return `shift`.
    """
    way = shift.copy()
    for _ in range(MAX_SHIFT_STEPS):
        mujoco.mj_forward(model, data)
        deepest = min(
            (c for c in data.contact if body in _bodies(model, c) and _is_overlap(model, c)),
            default=None,
            key=lambda c: c.dist,
        )
        if deepest is None:
            return way
        normal = deepest.frame[:2] * (1 if _bodies(model, deepest)[1] == body else -1)
        step = np.array([*normal, 0.0]) / max(float(np.hypot(*normal)), 1e-9) * (MIN_OVERLAP_DEPTH - deepest.dist)
        if np.hypot(*(way + step)[:2]) > MAX_SHIFT or np.hypot(*normal) < 0.5:
            break
        _put(model, data, body, step)
        way += step
    _put(model, data, body, shift - way)
    return shift


def _put(model: mujoco.MjModel, data: mujoco.MjData, body: int, step: Float[np.ndarray, "3"]) -> None:
    """Move a free body in `data` by `step` [m]; only `qpos` changes."""
    at = model.jnt_qposadr[model.body_jntadr[body]]
    data.qpos[at : at + 3] += step


def _bodies(model: mujoco.MjModel, contact: Any) -> tuple[int, int]:
    """Return the ids of the two bodies of a contact."""
    a, b = model.geom_bodyid[contact.geom]
    return int(a), int(b)


def _is_overlap(model: mujoco.MjModel, contact: Any) -> bool:
    """Return whether a contact is deeper than `MIN_OVERLAP_DEPTH`, and not with the floor plane."""
    return bool(contact.dist < -MIN_OVERLAP_DEPTH and model.geom("floor").id not in contact.geom)


def _overlaps(model: mujoco.MjModel, data: mujoco.MjData) -> list[tuple[int, int]]:
    """Return the pairs of bodies that overlap, with repetitions."""
    mujoco.mj_forward(model, data)
    return [_bodies(model, c) for c in data.contact if _is_overlap(model, c)]


def _move(root: ET.Element, name: str, shift: Float[np.ndarray, "3"]) -> None:
    """Move the body `name` of the MJCF by `shift` [m], in place."""
    (body,) = root.iterfind(f"worldbody/body[@name='{name}']")
    body.set("pos", numbers(np.array(body.attrib["pos"].split(), float) + shift))


def measure_rest_drift(xml: str, files: Mapping[str, bytes], seconds: float = 10.0) -> dict[str, float]:
    """Simulate the output of `to_mjcf` in MuJoCo for `seconds` [s], and measure the drift of its free bodies.

    Returns:
        Maximum distance of each free body from its initial position [m]; inf for all if the simulation diverged.

    Example:
        >>> measure_rest_drift(*to_mjcf(house))  # doctest: +SKIP
        {'object15': 9.8e-05, 'object16': 9.8e-05}
    """
    model = mujoco.MjModel.from_xml_string(xml, dict(files))
    data = mujoco.MjData(model)
    bodies = model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE]
    mujoco.mj_forward(model, data)
    start, farthest = data.xpos[bodies].copy(), np.zeros(len(bodies))
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        farthest = np.maximum(farthest, np.linalg.norm(data.xpos[bodies] - start, axis=1))
    if any(data.warning[kind].number for kind in (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQACC)):
        farthest[:] = np.inf
    return {model.body(body).name: float(d) for body, d in zip(bodies, farthest, strict=True)}
