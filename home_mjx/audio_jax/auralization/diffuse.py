"""Noise of a diffuse field that stays where it is while a head turns in it."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.auralization.hrtf import diffuse_coherence
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import high_pass, octave_gains
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import quat_matrix
from home_mjx.schema.compiled import BANDS

NUM_CHANNELS = 5
KNOTS = 3  # of amplitude in a bin: its start, middle and end


def num_channels(config: AudioConfig) -> int:
    """Independent noises that make up the field: one where both ears hear the same."""
    return 1 if config.receiver == "omni" else NUM_CHANNELS


def ear_mix(head_quat: Float[Array, "4"], config: AudioConfig) -> Float[Array, "2 c"]:
    """How much of each channel both ears hear: 1, cos φ, sin φ, cos 2φ, sin 2φ of the azimuth φ of an ear.

    The channels' own levels (`channel_levels`) make two ears of a rigid sphere as coherent as a diffuse field would,
    and so an ear with itself before and after turns by a right angle and by half a turn.

    Args:
        head_quat: Of the head, wxyz.
        config: Options.
    """
    if config.receiver == "omni":
        return jnp.ones((2, 1), jnp.float32)
    side, back = math.sin(math.radians(config.ear_angle)), -math.cos(math.radians(config.ear_angle))
    ears = jnp.array([[-side, 0.0, back], [side, 0.0, back]], jnp.float32)
    axes = jnp.matmul(ears, quat_matrix(head_quat).T, precision="highest")
    flat = jnp.sqrt(axes[:, 0] ** 2 + axes[:, 1] ** 2)
    known = flat > 1e-3  # an ear that points straight up has no azimuth
    x, y = (jnp.where(known, axes[:, i] / jnp.maximum(flat, 1e-3), 1.0 - i) for i in (0, 1))
    return jnp.stack([jnp.ones_like(x), x, y, x * x - y * y, 2 * x * y], axis=1)


def channel_levels(frequency: Float[np.ndarray, " f"], config: AudioConfig) -> Float[np.ndarray, "c f"]:
    """Amplitude of each channel over frequency; the squares that an ear hears add up to one."""
    if config.receiver == "omni":
        return np.ones((1, frequency.size))
    head = config.head_radius, config.speed_of_sound
    opposite, across = (diffuse_coherence(frequency, angle, *head) for angle in (np.pi, np.pi / 2))
    even, odd = (1 + opposite) / 2, (1 - opposite) / 2
    twice = np.clip((even - across) / 2, 0, even)
    levels = np.sqrt(np.maximum(np.stack([even - twice, odd, odd, twice, twice]), 0))
    return levels


@functools.cache
def noise(config: AudioConfig) -> Float[np.ndarray, "c bands n"]:
    """White noise of unit variance in channels, split into octaves that are independent of each other.

    As long as a response, and periodic: it goes on at its end as it began.
    """
    length = config.response_length
    frequency = np.fft.rfftfreq(length, 1 / config.sample_rate)
    bands = octave_gains(frequency)
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, (num_channels(config), *bands.shape))
    spectrum = np.exp(1j * phase) * channel_levels(frequency, config)[:, None] * np.sqrt(bands) * high_pass(frequency)
    return (np.fft.irfft(spectrum, length) * np.sqrt(length)).astype(np.float32)


@functools.cache
def noise_bins(config: AudioConfig) -> Float[np.ndarray, "k m s"]:
    """`noise` in the bins of a histogram, faded: m runs over `KNOTS`, channels and octaves.

    A sum of these with amplitudes at the start, the middle and the end of a bin is noise whose amplitude runs linearly
    between them; so a response is one product of matrices.
    """
    place = (np.arange(config.bin_samples) + 0.5) / config.bin_samples
    middle = 1 - np.abs(2 * place - 1)
    knots = np.stack([np.clip(1 - 2 * place, 0, 1), middle, np.clip(2 * place - 1, 0, 1)])
    parts = noise(config).reshape(-1, config.num_bins, config.bin_samples)
    table = np.moveaxis(parts, 1, 0)[:, None] * knots[None, :, None]
    return np.ascontiguousarray(table.reshape(config.num_bins, -1, config.bin_samples), np.float32)


class Draw(Pytree):
    """Which noise an environment hears: one table serves all, each begins at its own place with its own signs."""

    start: Int[Array, ""]  # [bins]
    sign: Float[Array, "c bands"]


def drawn(key: Array, config: AudioConfig) -> Draw:
    """What a key chooses."""
    place, signs = jax.random.split(key)
    sign = jax.random.rademacher(signs, (num_channels(config), len(BANDS)), jnp.float32)
    return Draw(jax.random.randint(place, (), 0, config.num_bins, jnp.int32), sign)
