"""Measured heads inside `jit`: interpolation of HRTF tables over directions."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.base.options import Binaural
from home_mjx.errors import ConfigError


def check_head(head: MeasuredHead, config: AudioConfig) -> None:
    """Validate that a measured head matches the options.

    Raises:
        ConfigError: The receiver is not `Binaural`, `pinna` is set, or the sample rate differs.
    """
    if not isinstance(config.receiver, Binaural):
        raise ConfigError(f"a measured head does not work with receiver={config.receiver}", hint="Use Binaural().")
    if config.receiver.pinna:
        raise ConfigError("a measured head already includes its outer ears", hint="Leave `pinna` at False.")
    if head.sample_rate != config.sample_rate:
        text = f"the head was read for {head.sample_rate} Hz, sound has {config.sample_rate} Hz"
        raise ConfigError(text, hint="Read it again with these options.")


def interpolate_directions(table: Float[Array, "v h *n"], toward: Float[Array, "*p 3"]) -> Float[Array, "..."]:
    """Interpolate a table over directions bilinearly between the four nearest entries; returns (*p, *n).

    Args:
        table: By elevation from below to above, and azimuth from ahead over the left around the head, see
            `MeasuredHead`.
        toward: Unit vectors towards the directions of incidence, in the head frame: +x right, +y up, looking along -z.

    Example:
        >>> table = jnp.arange(12.0).reshape(3, 4)  # every 90 degrees
        >>> interpolate_directions(table, jnp.array([[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])).tolist()  # left, ahead
        [5.0, 4.0]
    """
    rows, columns = table.shape[:2]
    elevation = jnp.arcsin(jnp.clip(toward[..., 1], -1.0, 1.0)) / math.pi + 0.5  # 0 .. 1
    azimuth = jnp.arctan2(-toward[..., 0], -toward[..., 2]) / (2 * math.pi)  # -0.5 .. 0.5
    high, around = elevation * (rows - 1), (azimuth - jnp.floor(azimuth)) * columns
    row = jnp.clip(high.astype(jnp.int32), 0, rows - 2)
    column = jnp.clip(around.astype(jnp.int32), 0, columns - 1)
    shape = toward.shape[:-1] + (1,) * (table.ndim - 2)
    up, on = ((x - y.astype(jnp.float32)).reshape(shape) for x, y in ((high, row), (around, column)))
    after = (column + 1) % columns
    below, above = (table[r, column] * (1 - on) + table[r, after] * on for r in (row, row + 1))
    return below * (1 - up) + above * up
