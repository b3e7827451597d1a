"""Which light colour images are drawn in."""

import math
from dataclasses import dataclass, fields

from home_mjx.core.checks import check_known, check_number
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
        sun_elevation: Of the sun above the horizon [degrees].
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
