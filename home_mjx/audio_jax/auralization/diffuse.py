"""Noise of a diffuse field that stays where it is while a head turns in it."""

import functools
import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.hrtf import diffuse_coherence
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import high_pass, octave_gains
from home_mjx.core.transforms import quat_matrix

NOISE_LENGTH = 4  # the noise of all environments is this many responses long
NUM_CHANNELS = 5


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
    """White noise of unit variance in channels, split into octaves that are independent of each other."""
    length = NOISE_LENGTH * 2 ** math.ceil(math.log2(config.response_length))
    frequency = np.fft.rfftfreq(length, 1 / config.sample_rate)
    bands = octave_gains(frequency)
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, (num_channels(config), *bands.shape))
    spectrum = np.exp(1j * phase) * channel_levels(frequency, config)[:, None] * np.sqrt(bands) * high_pass(frequency)
    return (np.fft.irfft(spectrum, length) * np.sqrt(length)).astype(np.float32)
