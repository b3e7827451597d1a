"""Lights of an MJCF scene."""

import numpy as np

from home_mjx.datasets.gltf.scene_lights import ROOM_POWER, SceneLight, to_vector
from home_mjx.datasets.mjcf.model import LEVEL_LINEAR, MjcfScene
from home_mjx.schema.house import Light

SPOT, POINT = 0, 2  # `mujoco.mjtLightType`


def read_lights(scene: MjcfScene, floor_area: float) -> list[SceneLight]:
    """Return the point lights and spots of a scene; together they have `ROOM_POWER` times the floor area [m^2]."""
    model, data = scene.model, scene.data
    rows = [i for i in range(model.nlight) if model.light_type[i] in (SPOT, POINT) and model.light_diffuse[i].max() > 0]
    strength = {i: float(model.light_diffuse[i].mean()) for i in rows}
    found = []
    for i in rows:
        position, aim = (LEVEL_LINEAR @ values[i] for values in (data.light_xpos, data.light_xdir))
        spot = model.light_type[i] == SPOT
        light = Light(
            kind="spot" if spot else "point",
            power=ROOM_POWER * floor_area * strength[i] / sum(strength.values()),
            color=to_vector(model.light_diffuse[i] / model.light_diffuse[i].max()),
            position=to_vector(position),
            direction=to_vector(aim) if spot else None,
            cutoff=float(np.deg2rad(np.clip(model.light_cutoff[i], 1, 90))) if spot else None,
            dropoff=float(np.clip(model.light_exponent[i], 0, 128)) if spot else 0.0,
        )
        found.append(SceneLight(f"light[{model.light(i).name or i}]", light))
    return found
