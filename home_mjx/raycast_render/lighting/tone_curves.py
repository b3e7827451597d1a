"""Tone curves, which map light of any strength to linear display light in [0, 1]."""

from collections.abc import Callable

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.raycast_render.lighting.lights import LUMINANCE
from home_mjx.raycast_render.scene.vec import Vec

WHITE_LUMINANCE = 5.0  # luminance after exposure that `tone_map` maps to white
MIDDLE_GREY = 0.18  # light that AgX maps to its pivot
STOPS_BELOW, STOPS_ABOVE = 10.0, 6.5  # range of AgX's curve from middle grey, in factors of 2
MIN_LIGHT = 1e-6  # minimum light of AgX, below the darkest that it shows
SLOPE, TOE_POWER, SHOULDER_POWER = 2.0, 3.0, 3.25  # of AgX's curve at its pivot, and its bends below and above it
PIVOT = STOPS_BELOW / (STOPS_BELOW + STOPS_ABOVE)
DISPLAY_POWER = 2.2  # from display values of AgX to linear light
INSET = 0.2, (0.2117, 0.3921, 0.3962)  # share of a weighted mean of channels that AgX adds before its curve; weights


def tone_map(light: Vec, exposure: float | Float[Array, ""]) -> Vec:
    """Map light of any strength, times `exposure`, to linear display light in [0, 1].

    The luminance `WHITE_LUMINANCE`, after exposure, becomes 1; colours keep their hue until a channel saturates.

    Source: E. Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002, equation 4.
    """
    light = light * exposure
    luminance = light.dot(Vec(*LUMINANCE))
    return (light * ((1 + luminance / WHITE_LUMINANCE**2) / (1 + luminance))).map(lambda x: jnp.clip(x, 0.0, 1.0))


def agx(light: Vec, exposure: float | Float[Array, ""]) -> Vec:
    """Map light, times `exposure`, to display light in [0, 1] by a curve of its logarithm, per channel, as AgX does.

    Channels are mixed before the curve and separated after it, so that bright colours fade to white. Light that is not
    finite counts as white, and what is not a number as black.

    Source: T. Sobotka, "AgX", 2022: base look, whose mixing of channels is rounded to `INSET`.

    Example:
        >>> round(float(agx(Vec(*[jnp.float32(0.18)] * 3), 1.0).x), 3)
        0.218
    """
    share, weights = INSET
    light = light.map(lambda x: jnp.clip(jnp.nan_to_num(x * exposure), 0.0, 1e6))
    mean = light.dot(Vec(*weights)) * share
    shown = light.map(lambda x: _sigmoid(jnp.log2(jnp.maximum(x * (1 - share) + mean, MIN_LIGHT) / MIDDLE_GREY)))
    mean = shown.dot(Vec(*weights)) * share
    return shown.map(lambda x: jnp.clip((x - mean) / (1 - share), 0.0, 1.0) ** DISPLAY_POWER)


def _sigmoid(stops: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """Return AgX's display value in [0, 1] of light by its distance from middle grey in factors of 2."""
    place = jnp.clip((stops + STOPS_BELOW) / (STOPS_BELOW + STOPS_ABOVE), 0.0, 1.0) - PIVOT
    toe = _bend(jnp.maximum(-place, 0.0), PIVOT, TOE_POWER)
    return 0.5 - toe + _bend(jnp.maximum(place, 0.0), 1 - PIVOT, SHOULDER_POWER)


def _bend(place: Float[Array, "*rays"], end: float, power: float) -> Float[Array, "*rays"]:
    """Return a curve that leaves 0 with `SLOPE` and is 0.5 at `end`."""
    scale = ((SLOPE * end) ** -power * ((2 * SLOPE * end) ** power - 1)) ** (-1 / power)
    part = SLOPE / scale * place
    return scale * part / (1 + part**power) ** (1 / power)


TONE_CURVES: dict[str, Callable[[Vec, float | Float[Array, ""]], Vec]] = {"reinhard": tone_map, "agx": agx}
