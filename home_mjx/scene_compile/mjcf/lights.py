"""Lamps of a house as MJCF lights."""

import xml.etree.ElementTree as ET

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.meshes import transform
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.mjcf import numbers

MAX_LAMPS = 64  # maximum number of lamps, strongest first; MuJoCo renders at most 100 lights
MAX_DIFFUSE = 0.7  # diffuse colour of the strongest lamp, since MuJoCo's lights have no unit
ATTENUATION = "1 0 0.15"  # half intensity at 2.6 m


def add_lamps(world: ET.Element, house: CompiledHouse) -> None:
    """Add the `MAX_LAMPS` strongest lamps as lights `lamp<i>`, i in the light table: spots or points without shadows.

    Daylight is omitted, and lights of movable lamps are static.
    """
    lights = house.lights
    scale = MAX_DIFFUSE / max(float(lights.intensity[~lights.daylight].max(initial=0)), 1e-9)
    for i in _strongest(house):
        pose = house.instances.pose[lights.instance[i]]
        aim = pose[:, :3] @ lights.direction[i]
        light = {
            "name": f"lamp{i}",
            "pos": numbers(transform(pose, lights.pos[i])),
            "diffuse": numbers(lights.intensity[i] * scale),
            "specular": "0.1 0.1 0.1",
            "attenuation": ATTENUATION,
            "castshadow": "false",
        }
        ET.SubElement(world, "light", light | _shape(aim, float(lights.exponent[i]), float(lights.cutoff[i])))


def _strongest(house: CompiledHouse) -> Int[np.ndarray, " n"]:
    """Return the rows of the `MAX_LAMPS` lamps of highest intensity, ascending."""
    lamps = np.flatnonzero(~house.lights.daylight)
    order = np.argsort(-house.lights.intensity[lamps].sum(axis=1), kind="stable")
    return np.sort(lamps[order[:MAX_LAMPS]])


def _shape(aim: Float[np.ndarray, "3"], exponent: float, cutoff: float) -> dict[str, str]:
    """Return the MJCF attributes of a spot; of a point light if `cutoff`, a cosine, is below -1."""
    if cutoff < -1:
        return {"type": "point"}
    angle = np.rad2deg(np.arccos(np.clip(cutoff, -1, 1)))
    spot = {"dir": numbers(aim / np.linalg.norm(aim)), "cutoff": f"{angle:.6g}", "exponent": f"{exponent:.6g}"}
    return {"type": "spot", **spot}
