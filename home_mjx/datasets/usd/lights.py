"""Lights of a USD scene (`UsdLux`) as lights of a house."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import encode_srgb
from home_mjx.datasets.gltf.scene_lights import SceneLight, to_vector
from home_mjx.datasets.usd.layers import at_start, pxr
from home_mjx.schema.house import Light
from home_mjx.schema.lighting import LUMENS_PER_WATT

LAMPS = ("SphereLight", "DiskLight", "RectLight", "CylinderLight")
MAX_EXPOSURE = 64.0
MAX_COLOR = 1e6  # maximum linear colour, that of broken files
MAX_POWER = 1e9  # [W]
FRONT_ANGLE = np.pi / 2  # [rad], cutoff of surfaces, which shine to their front

Matrix = Float[np.ndarray, "4 4"]


def read_lights(prims: Sequence[tuple[Any, Matrix]], unit: float, notes: dict[str, str]) -> list[SceneLight]:
    """Return the lights of prims with their places in the house.

    A light has the power of its surface, whose luminance in nits is intensity times two to the exposure, divided by
    the area in units of the scene if it is normalized.

    Args:
        prims: Prims with `LightAPI`, and house from prim.
        unit: Metres per unit of the scene.
        notes: Receives the lights that are not kept: domes, distant, and dark ones.
    """
    found = []
    for prim, matrix in prims:
        power = _power(prim, matrix, unit) if prim.GetTypeName() in LAMPS else 0.0
        if power > 0:
            found.append(SceneLight(str(prim.GetPath()), _light(prim, matrix, power)))
        else:
            notes[str(prim.GetPath())] = f"{prim.GetTypeName() or 'light'} is dark or of a kind that is not kept"
    return found


def _power(prim: Any, matrix: Matrix, unit: float) -> float:
    """Return the power of a light [W]; 0 unless it is positive and finite."""
    exposure = np.clip(_number(prim, "exposure", 0.0), -MAX_EXPOSURE, MAX_EXPOSURE)
    nits = _number(prim, "intensity", 1.0) * 2.0**exposure * float(_color(prim).max())
    flag = at_start(_attribute(prim, "normalize"))
    power = np.pi * nits * (unit**2 if flag else _area(prim, matrix)) / LUMENS_PER_WATT
    return float(min(power, MAX_POWER)) if np.isfinite(power) and power > 0 else 0.0


def _area(prim: Any, matrix: Matrix) -> float:
    """Return the area of a light's surface [m^2]."""
    scale, kind = float(np.cbrt(abs(np.linalg.det(matrix[:3, :3])))), str(prim.GetTypeName())
    radius, length = _number(prim, "radius", 0.5) * scale, _number(prim, "length", 1.0) * scale
    if kind == "RectLight":
        return _number(prim, "width", 1.0) * _number(prim, "height", 1.0) * scale**2
    return {"SphereLight": 4 * np.pi * radius**2, "DiskLight": np.pi * radius**2}.get(kind, 2 * np.pi * radius * length)


def _light(prim: Any, matrix: Matrix, power: float) -> Light:
    """Return the record of a light: a point, a line along x, or a surface that shines along -z."""
    place, linear = matrix[:3, 3], _color(prim)
    shade = to_vector(encode_srgb(linear / linear.max()))
    if prim.GetTypeName() == "SphereLight":
        return Light("point", power, shade, to_vector(place))
    if prim.GetTypeName() == "CylinderLight":
        half = matrix[:3, 0] * _number(prim, "length", 1.0) / 2
        return Light("line", power, shade, to_vector(place - half), end=to_vector(place + half))
    aim = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    return Light("spot", power, shade, to_vector(place), to_vector(aim), FRONT_ANGLE, dropoff=1.0)


def _color(prim: Any) -> Float[np.ndarray, "3"]:
    """Return the linear colour of a light, from its temperature if it enables that."""
    value = at_start(_attribute(prim, "color"))
    color = np.clip(np.nan_to_num(np.array(value if value is not None else (1, 1, 1), float)), 0, MAX_COLOR)
    if at_start(_attribute(prim, "enableColorTemperature")):
        kelvin = float(np.clip(_number(prim, "colorTemperature", 6500.0), 1000, 10000))
        color = color * np.array(pxr("UsdLux").BlackbodyTemperatureAsRgb(kelvin), float)
    return color


def _number(prim: Any, name: str, default: float) -> float:
    """Return a number of a light; the default if it is absent or not finite."""
    value = at_start(_attribute(prim, name))
    return float(value) if value is not None and np.isfinite(value) else default


def _attribute(prim: Any, name: str) -> Any:
    """Return an attribute of a light; that without `inputs:`, as before USD 21.02, if only it has a value."""
    found, old = prim.GetAttribute(f"inputs:{name}"), prim.GetAttribute(name)
    is_stated = old and old.HasAuthoredValue() and not found.HasAuthoredValue()
    return old if is_stated and old.GetTypeName() == found.GetTypeName() else found
