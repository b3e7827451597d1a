"""Sun and sky by time of day."""

import math

DEFAULT_LATITUDE = 48.0  # [degrees]
REFERENCE_TRANSMITTANCE = 0.595  # transmittance of the air at 35 degrees, the default elevation of `LitShader`
MAX_WARM_ELEVATION = 18.0  # [degrees], elevation of the sun below which its light reddens
SUNSET_SKY_SHARE, MIN_SKY_SHARE = 0.12, 1e-3  # radiance of the sky at sunset, and its minimum, over that at 35 degrees
TWILIGHT_DECADE = 4.5  # [degrees], depression of the sun per factor of 10 in the sky's radiance


def sun_position(hour: float, latitude: float = DEFAULT_LATITUDE, declination: float = 12.0) -> tuple[float, float]:
    """Compute the sun's azimuth, from +x (east) towards +y (north), and its elevation [degrees].

    `hour` is solar time; the sun is highest at 12. Its `declination` [degrees] is 0 at the equinoxes, 23.4 at
    midsummer. Source: J. Meeus, "Astronomical Algorithms", chapter 13.

    Example:
        >>> print(*(round(angle) for angle in sun_position(12.0)))
        270 54
    """
    turn, north, tilt = (math.radians(angle) for angle in (15 * (hour - 12), latitude, declination))
    up = math.sin(north) * math.sin(tilt) + math.cos(north) * math.cos(tilt) * math.cos(turn)
    east = -math.cos(tilt) * math.sin(turn)
    along = math.cos(north) * math.sin(tilt) - math.sin(north) * math.cos(tilt) * math.cos(turn)
    return math.degrees(math.atan2(along, east)) % 360, math.degrees(math.asin(max(-1.0, min(1.0, up))))


def sun_share(elevation: float) -> float:
    """Return the normal irradiance of the sun at an elevation [degrees] over that at 35; 0 at or below the horizon.

    Source: F. Kasten and A. T. Young, "Revised optical air mass tables", Applied Optics, 1989; A. B. Meinel and M. P.
    Meinel, "Applied Solar Energy", 1976: a transmittance of 0.7 ** (air mass ** 0.678).
    """
    if elevation <= 0:
        return 0.0
    mass = 1 / (math.sin(math.radians(elevation)) + 0.50572 * (elevation + 6.07995) ** -1.6364)
    return 0.7 ** (mass**0.678) / REFERENCE_TRANSMITTANCE


def sky_share(elevation: float) -> float:
    """Return the radiance of the sky at an elevation of the sun [degrees] over that at 35; at least `MIN_SKY_SHARE`.

    It is affine in the sine of the elevation by day and decays exponentially in twilight.
    """
    day = SUNSET_SKY_SHARE + (1 - SUNSET_SKY_SHARE) * math.sin(math.radians(max(elevation, 0.0))) / math.sin(
        math.radians(35.0)
    )
    return max(MIN_SKY_SHARE, day * 10 ** (min(elevation, 0.0) / TWILIGHT_DECADE))


def sun_redness(elevation: float) -> float:
    """Return the redness of sunlight: 1 at or below the horizon, falling linearly to 0 at `MAX_WARM_ELEVATION`, then 0.

    `elevation` is in degrees.
    """
    return max(0.0, 1 - max(elevation, 0.0) / MAX_WARM_ELEVATION)
