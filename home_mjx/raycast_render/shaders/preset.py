"""Presets of colour images and their options."""

import math
from dataclasses import dataclass, fields
from typing import Any

from home_mjx.core.checks import check_known, check_number
from home_mjx.raycast_render.shaders.daytime import sky_share, sun_position, sun_share
from home_mjx.schema.choices import PRESETS


@dataclass(frozen=True)
class LitShader:
    """Options of the lit preset: the lights of the house, with shadows.

    Rays per sample: at most 1 + bounces + num_lights + 1 (sun) + 1 (ambient occlusion).

    Attributes:
        num_lights: Lights per point, those with the highest unoccluded irradiance; lights of other rooms are weighted
            by 0.1. A shadow ray tests each light, so none shines through walls.
        max_specular_depth: Maximum number of specular events: glass, cut-out textures and mirrors.
        sun: Normal irradiance of the sun [W/m^2]; 0 disables the sun and its rays.
        sun_azimuth: Direction to the sun from +x towards +y [degrees].
        sun_elevation: Elevation of the sun above the horizon [degrees]; below 18 sunlight and horizon are redder.
        sky: Radiance of the sky [W/m^2/sr], outdoors and through windows; 0: night.
        ambient: Factor of the interreflected light.
        ao_radius: Ambient-occlusion radius [m]; 0 disables ambient occlusion. Noisy unless the lens takes several samples
            per pixel.
        exposure: Factor of all light before tone mapping. None: auto exposure, which maps the mean luminance of each
            image to middle grey.

    Raises:
        ConfigError: A value is invalid.
    """

    num_lights: int = 4
    max_specular_depth: int = 2
    sun: float = 9.0
    sun_azimuth: float = 250.0
    sun_elevation: float = 35.0
    sky: float = 3.0
    ambient: float = 1.0
    ao_radius: float = 0.0
    exposure: float | None = 2.3

    def __post_init__(self) -> None:
        for option in fields(self):
            if option.name == "exposure" and self.exposure is None:
                continue
            least = -math.inf if option.name.startswith("sun_") else 0
            check_number(option.name, getattr(self, option.name), least, integer=isinstance(option.default, int))

    @classmethod
    def from_hour(cls, hour: float, **options: Any) -> "LitShader":
        """Return options with the sun and sky of a time of day; other options as given.

        Args:
            hour: Solar time, 0 to 24. The sun rises at about 5, is highest at 12, and sets at about 19.
            options: Other fields.

        Raises:
            ConfigError: The hour or an option is invalid.

        Example:
            >>> Lit.at(23).sun, Lit.at(12).sun > Lit.at(18).sun
            (0.0, True)
        """
        check_number("hour", hour, 0, 24)
        azimuth, elevation = sun_position(hour)
        given: dict[str, Any] = {
            "sun": round(cls.sun * sun_share(elevation), 4),
            "sky": round(cls.sky * sky_share(elevation), 6),
            "sun_azimuth": round(azimuth, 3),
            "sun_elevation": round(elevation, 3),
        }
        return cls(**(given | options))


ShaderSpec = str | LitShader


def resolve_shader(preset: ShaderSpec) -> LitShader | None:
    """Return the options of the lit preset; None for the fast preset.

    Raises:
        ConfigError: The preset is unknown.
    """
    if isinstance(preset, LitShader):
        return preset
    check_known("preset", [preset], PRESETS)
    return LitShader() if preset == "lit" else None
