"""Which light colour images are drawn in."""

import math
from dataclasses import dataclass, fields
from typing import Any

from home_mjx.core.checks import check_known, check_number
from home_mjx.raycast_render.shaders.daytime import sky_share, sun_position, sun_share
from home_mjx.schema.choices import PRESETS


@dataclass(frozen=True)
class Lit:
    """The lights of the house, with shadows: per sample at most 1 + bounces + num_lights + 1 (sun) + 1 (corners) rays.

    Attributes:
        num_lights: Lights that each point is lit by: those that would give it the most light if nothing stood between,
            lights of other rooms counting a tenth; each is tested by a shadow ray, so none shines through walls.
        bounces: How often a ray may go on through glass or cut-out leaves, or off a mirror.
        sun: Irradiance of the sun at right angles [W/m^2]; 0: no sun and no rays to it.
        sun_azimuth: Direction to the sun from +x towards +y [degrees].
        sun_elevation: Of the sun above the horizon [degrees]; below 18 its light, and the horizon, are redder.
        sky: Radiance of the sky [W/m^2/sr], outdoors and through windows; 0: night.
        ambient: Scales the light that surfaces reflect on each other.
        corners: Radius in which other surfaces keep that light out of corners [m]; 0: no rays for it. Noisy unless the
            lens takes several samples per pixel.
        exposure: Scales everything before tone mapping. None: so that the middle of each image is as bright as a
            surface of middle reflectance under full light, as a camera's meter chooses it.
    """

    num_lights: int = 4
    bounces: int = 2
    sun: float = 9.0
    sun_azimuth: float = 250.0
    sun_elevation: float = 35.0
    sky: float = 3.0
    ambient: float = 1.0
    corners: float = 0.0
    exposure: float | None = 2.3

    def __post_init__(self) -> None:
        for option in fields(self):
            if option.name == "exposure" and self.exposure is None:
                continue
            least = -math.inf if option.name.startswith("sun_") else 0
            check_number(option.name, getattr(self, option.name), least, whole=isinstance(option.default, int))

    @classmethod
    def at(cls, hour: float, **options: Any) -> "Lit":
        """The lights of a time of day, with sun and sky as they are then; other options as given.

        Args:
            hour: Solar time, 0 to 24: the sun rises at about 5, is highest at 12, and sets at about 19.
            options: Other fields.

        Raises:
            ConfigError: There is no such hour, or option.

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


Preset = str | Lit


def resolve(preset: Preset) -> Lit | None:
    """The options of the lit preset; None for the fast one.

    Raises:
        ConfigError: There is no such preset.
    """
    if isinstance(preset, Lit):
        return preset
    check_known("preset", [preset], PRESETS)
    return Lit() if preset == "lit" else None
