"""Air attenuation of HoME (2017), see `propagation/home2017_paths.py`: for comparison with it only, not physical."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

TEMPERATURES, HUMIDITIES = (10.0, 20.0), (40.0, 60.0, 80.0)  # [degrees Celsius], [%]
# Coefficients per octave [1/1000 m]: Vorländer, Auralization, 2008. They are for energy; HoME applies them to pressure.
COEFFICIENTS = np.array(
    [
        [
            [0.1, 0.2, 0.5, 1.1, 2.7, 9.4, 29.0],
            [0.1, 0.2, 0.5, 0.8, 1.8, 5.9, 21.1],
            [0.1, 0.2, 0.5, 0.7, 1.4, 4.4, 15.8],
        ],
        [
            [0.1, 0.3, 0.6, 1.0, 1.9, 5.8, 20.3],
            [0.1, 0.3, 0.6, 1.0, 1.7, 4.1, 13.5],
            [0.1, 0.3, 0.6, 1.1, 1.7, 3.5, 10.6],
        ],
    ]
)
MIN_REMAINING_PRESSURE = 1e-7  # minimum remaining share of the pressure, so that levels stay finite


def home2017_air_level(
    distance: Float[Array, " p"], temperature: float = 20.0, humidity: float = 65.0
) -> Float[Array, "p bands"]:
    """Compute the level change by air over a distance d [dB] by HoME's rule 20 lg(1 - m d), m from the nearest row.

    Args:
        distance: [m].
        temperature: [degrees Celsius].
        humidity: Relative humidity [%].

    Example:
        >>> round(float(home_air_level(jnp.array([10.0]))[0, -1]), 2)  # at 8 kHz
        -1.26
    """
    row = COEFFICIENTS[_nearest(TEMPERATURES, temperature), _nearest(HUMIDITIES, humidity)] / 1000
    kept = 1 - distance[:, None] * jnp.asarray(row, jnp.float32)[None]
    return 20 * jnp.log10(jnp.clip(kept, MIN_REMAINING_PRESSURE, 1.0))


def _nearest(values: tuple[float, ...], value: float) -> int:
    return int(np.argmin(np.abs(np.array(values) - value)))
