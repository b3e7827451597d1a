"""Stability test of a house: drift of its movable objects without external forces."""

# MuJoCo defines its types lazily, where pyright does not find them.
# pyright: reportAttributeAccessIssue=false

from collections.abc import Mapping

import mujoco
import numpy as np


def measure_rest_drift(xml: str, files: Mapping[str, bytes], seconds: float = 10.0) -> dict[str, float]:
    """Simulate a model in MuJoCo and measure the drift of its free bodies.

    Args:
        xml: XML from `to_mjcf`.
        files: Files from `to_mjcf`.
        seconds: Simulated time [s].

    Returns:
        Maximum distance of each free body from its initial position [m]; inf if the simulation diverged.

    Example:
        >>> rest_drift(*to_mjcf(house))  # doctest: +SKIP
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
