"""Light setups of Habitat as lights of a house."""

from collections.abc import Iterator

import numpy as np

from home_mjx.core.color import encode_srgb
from home_mjx.datasets.gltf.scene_lights import ROOM_POWER, SceneLight, to_vector
from home_mjx.datasets.habitat.templates import HabitatTemplate
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.schema.house import Light

MAX_STRENGTH = 1e9  # maximum intensity; the sum of larger ones may overflow
NO_LIGHTS = ("", "no_lights", "default")  # names of setups that have no files


def read_lights(setup: HabitatTemplate, floor_area: float, notes: dict[str, str]) -> list[SceneLight]:
    """Return the point lights of a setup; together they have `ROOM_POWER` times the floor area [m^2].

    Args:
        setup: The setup.
        floor_area: Area of all rooms [m^2].
        notes: Receives the lights that are not kept: directional and negative ones, and those that follow the camera.

    Raises:
        DatasetError: A value has another type, or a number is not finite.
    """
    found = list(_bright(setup, notes))
    total = sum(strength for _, strength in found)
    return [_light(value, ROOM_POWER * floor_area * strength / total) for value, strength in found]


def _bright(setup: HabitatTemplate, notes: dict[str, str]) -> Iterator[tuple[JsonValue, float]]:
    """Yield the lights that are kept, with their intensities; an override replaces lights of the same name."""
    scale = setup.member("positive_intensity_scale")
    factor = scale.number() if scale.has_value else 1.0
    lights: dict[str, JsonValue] = {}
    for value, _ in setup.sources:
        stated = value.member("lights")
        for name in stated.data if isinstance(stated.data, dict) else ():
            lights.setdefault(name, stated.member(name))
    for value in lights.values():
        kind, model, intensity = (value.member(key) for key in ("type", "position_model", "intensity"))
        strength = min((intensity.number() if intensity.has_value else 1.0) * factor, MAX_STRENGTH)
        if kind.has_value and kind.text().lower() != "point":
            notes[value.element] = f"light of the type `{kind.text()[:20]}` is not kept"
        elif model.has_value and model.text().lower() != "global":
            notes[value.element] = "light that follows the camera or an object is not kept"
        elif strength <= 0:
            notes[value.element] = "light of negative intensity is not kept"
        else:
            yield value, strength


def _light(value: JsonValue, power: float) -> SceneLight:
    """Return a point light; colours of the file are linear."""
    color = value.member("color")
    linear = np.clip(color.vector(3) if color.has_value else np.ones(3), 0, None)
    peak = float(linear.max())
    shade = encode_srgb(linear / peak) if peak > 0 else np.ones(3)
    return SceneLight(
        value.element, Light("point", power, to_vector(shade), to_vector(value.member("position").vector(3)))
    )
