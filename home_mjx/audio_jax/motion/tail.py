"""What rings on after a response has ended: convolution in partitions, each as long as a frame.

Beyond a response octaves fall exponentially. Its noise is cut into partitions whose spectra are constants, which all
environments share; only levels per octave and partition differ, and how a head is turned. So a long tail costs products
of spectra and no transform of a response.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float
from scipy.fft import next_fast_len

from home_mjx.audio_jax.auralization.diffuse import channel_levels, ear_mix
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import RINGING, high_pass, octave_gains

READ = 0.5  # share of a histogram, the last one, from which the decay is read
STEEPEST, FLATTEST = 0.5, 1e-4  # decay per bin, in natural logarithms of energy
LEAST = 1e-30


def continued(energy: Float[Array, "k 2 bands"], config: AudioConfig) -> Float[Array, "j 2 bands"]:
    """Energy in each frame after a histogram's end, falling on as over its second half.

    The decay is that of both ears together, by least squares of logarithms; the level is that of the second half.

    Args:
        energy: From `energy_histogram`.
        config: For the lengths.

    Returns:
        `config.num_tail` frames.

    Example:
        >>> config = AudioConfig(tail_seconds=0.2)
        >>> bins = jnp.exp(-0.05 * jnp.arange(config.num_bins))
        >>> tail = continued(jnp.broadcast_to(bins[:, None, None], (config.num_bins, 2, 7)), config)
        >>> tail.shape, round(float(tail[1, 0, 0] / tail[0, 0, 0]), 4) == round(float(jnp.exp(-0.05 * 25)), 4)
        ((2, 2, 7), True)
    """
    count = max(round(READ * config.num_bins), 2)
    last = energy[-count:]
    level = jnp.log(jnp.maximum(jnp.sum(last, axis=1), LEAST))
    place = jnp.arange(count, dtype=jnp.float32) - (count - 1) / 2
    slope = jnp.sum(place[:, None] * level, axis=0) / jnp.sum(place**2)
    decay = jnp.clip(-slope, FLATTEST, STEEPEST)
    falling = jnp.exp(-decay[None] * (place + (count - 1) / 2)[:, None])
    begin = jnp.sum(last, axis=0) / jnp.sum(falling, axis=0)[None]  # energy per bin where the second half starts
    bins = config.frame / config.bin_samples  # per frame
    ago = count + bins * jnp.arange(config.num_tail, dtype=jnp.float32)
    lived = (1 - jnp.exp(-decay * bins)) / (1 - jnp.exp(-decay))
    return begin[None] * (jnp.exp(-decay[None] * ago[:, None]) * lived[None])[:, None]


def tail_frame(
    source: Float[Array, " n"],
    past: int,
    energy: Float[Array, "j 2 bands"],
    head_quat: Float[Array, "4"],
    signs: Float[Array, "j c"],
    config: AudioConfig,
) -> Float[Array, "2 m"]:
    """What both ears hear in a frame of what left the source before a response's length.

    Args:
        source: What leaves the source at 1 m.
        past: Its samples before the frame's first one, at least `config.memory_length` - 1.
        energy: From `continued`.
        head_quat: Of the head, wxyz.
        signs: Of the noise in each partition and channel, by which environments differ.
        config: Options.
    """
    if config.num_tail == 0:
        return jnp.zeros((2, config.frame), jnp.float32)
    size, spread, frame = _size(config), _spread(config), config.frame
    width = frame + spread + frame + spread - 1  # of what one partition hears
    begins = [past - config.response_length - (j + 1) * frame - spread + 1 for j in range(config.num_tail)]
    padded = jnp.pad(source, (max(-begins[-1], 0), 0))
    offset = max(-begins[-1], 0)
    windows = jnp.stack([padded[offset + b : offset + b + width] for b in begins])
    mix = ear_mix(head_quat, config)[None] * signs[:, None]  # (j, ear, channel)
    table = _partitions(config)
    fields = [jnp.asarray(part, jnp.float32) for part in (np.real(table), np.imag(table))]
    real, imag = (jnp.einsum("jec,jcf->jef", mix, f, precision="highest") for f in fields)
    level = jnp.sqrt(energy / frame) @ jnp.asarray(_octaves(config))
    spectrum = jnp.fft.rfft(windows, size)[:, None]
    heard = jnp.sum(spectrum * (level * jax.lax.complex(real, imag)), axis=0)
    first = frame + spread - 1
    return jnp.fft.irfft(heard, size)[:, first : first + frame]


def _spread(config: AudioConfig) -> int:
    """Samples by which octave filters ring on both sides."""
    return round(RINGING * config.sample_rate)


def _size(config: AudioConfig) -> int:
    return int(next_fast_len(2 * (config.frame + _spread(config)), real=True) or 0)


@functools.cache
def _octaves(config: AudioConfig) -> Float[np.ndarray, "bands f"]:
    """Gains of octaves, smooth enough that their filters end after `_spread` samples."""
    size, spread = _size(config), _spread(config)
    kernel = np.fft.irfft(octave_gains(np.fft.rfftfreq(8 * size, 1 / config.sample_rate)), 8 * size)
    place = np.minimum(np.arange(size), size - np.arange(size))
    near = np.where(place == np.arange(size), place, -place)  # samples before time 0 stand at the end
    fade = np.cos(np.pi / 2 * np.clip(place / spread, 0, 1)) ** 2
    return np.fft.rfft(kernel[:, near] * fade).real.astype(np.float32)


@functools.cache
def _partitions(config: AudioConfig) -> Complex[np.ndarray, "j c f"]:
    """Spectra of white noise of unit variance in each partition and channel; see `channel_levels`."""
    frame, count = config.frame, config.num_tail
    long = int(next_fast_len(count * frame, real=True) or 0)
    frequency = np.fft.rfftfreq(long, 1 / config.sample_rate)
    levels = channel_levels(frequency, config) * high_pass(frequency)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, levels.shape)
    noise = np.fft.irfft(levels * np.exp(1j * phase), long) * np.sqrt(long)
    parts = noise[:, : count * frame].reshape(-1, count, frame)
    return np.moveaxis(np.fft.rfft(parts, _size(config)), 1, 0).astype(np.complex64)
