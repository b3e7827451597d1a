"""Speed of sound and absorption in air."""

import math

import numpy as np
from jaxtyping import Float


def speed_of_sound(temperature: float) -> float:
    """Return the speed of sound in dry air [m/s], 331.3 sqrt(1 + T / 273.15), at a temperature in degrees Celsius.

    Example:
        >>> round(speed_of_sound(20.0), 2)
        343.21
    """
    return 331.3 * math.sqrt(1 + temperature / 273.15)


def air_absorption(
    frequency: Float[np.ndarray, " f"], temperature: float = 20.0, humidity: float = 50.0, pressure: float = 101.325
) -> Float[np.ndarray, " f"]:
    """Compute the pure-tone absorption of air [dB/m] by ISO 9613-1:1993, equations 3 to 5.

    Args:
        frequency: [Hz].
        temperature: [degrees Celsius].
        humidity: Relative humidity [%].
        pressure: [kPa].

    Example:
        >>> round(float(air_absorption(np.array([1000.0]), 10.0, 70.0)[0]) * 1000, 2)  # [dB/km]
        3.66
    """
    kelvin = temperature + 273.15
    relative = kelvin / 293.15
    atmospheres = pressure / 101.325
    saturation = 10 ** (-6.8346 * (273.16 / kelvin) ** 1.261 + 4.6151)  # [atm]
    water = humidity * saturation / atmospheres  # molar concentration [%]
    oxygen = atmospheres * (24 + 4.04e4 * water * (0.02 + water) / (0.391 + water))  # relaxation frequencies [Hz]
    nitrogen = atmospheres * relative**-0.5 * (9 + 280 * water * math.exp(-4.170 * (relative ** (-1 / 3) - 1)))
    square = frequency**2
    classical = 1.84e-11 / atmospheres * math.sqrt(relative)
    relaxation = 0.01275 * math.exp(-2239.1 / kelvin) / (oxygen + square / oxygen) + 0.1068 * math.exp(
        -3352.0 / kelvin
    ) / (nitrogen + square / nitrogen)
    return 8.686 * square * (classical + relative**-2.5 * relaxation)


def energy_attenuation(absorption: Float[np.ndarray, " f"]) -> Float[np.ndarray, " f"]:
    """Convert absorption [dB/m] to the coefficient m [1/m] of the energy exp(-m r) left after r metres."""
    return absorption * math.log(10) / 10
