"""Noise of a diffuse field that is fixed to the world while the head turns."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import high_pass, octave_gains
from home_mjx.audio_jax.base.options import Ambisonics, Binaural, MicrophoneArray, Omni
from home_mjx.audio_jax.receivers.spherical_head import diffuse_coherence
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import quat_matrix
from home_mjx.schema.compiled import BANDS

NUM_NOISES = 5  # independent noises of receivers that depend on orientation: circular harmonics up to order 2
NUM_KNOTS = 3  # of amplitude in a bin: its start, middle and end


def num_noises(config: AudioConfig) -> int:
    """Return the number of noises: 4 for ambisonics, 1 if orientation has no effect, otherwise `NUM_NOISES`.

    It has none on `Omni` and on microphones on the vertical axis of the head.
    """
    if isinstance(config.receiver, Ambisonics):
        return 4
    return 1 if _turning_radius(config) == 0 else NUM_NOISES


def noise_mix(head_quat: Float[Array, "4"], config: AudioConfig) -> Float[Array, "e c"]:
    """Compute the gain of each noise in each channel: 1, cos φ, sin φ, cos 2φ, sin 2φ for an ear with world azimuth φ.

    With the levels of `noise_levels`, two ears of a rigid sphere have the coherence of a diffuse field. The same holds
    for one ear before and after turns of 90 and 180 degrees. An array turns as a whole, by the azimuth of its right
    axis; each microphone has separate noises, see `octave_noise`. In ambisonics, one noise is W, and three are along
    the world axes. A vertical axis has azimuth 0. With one noise all gains are 1. `head_quat` is wxyz.
    """
    if num_noises(config) == 1:
        return jnp.ones((config.num_channels, 1), jnp.float32)
    turn = quat_matrix(head_quat)
    if isinstance(config.receiver, Ambisonics):
        parts = jnp.stack([-turn[:, 0], turn[:, 1], -turn[:, 2]])
        return jnp.eye(4, dtype=jnp.float32).at[1:, 1:].set(parts)
    if isinstance(config.receiver, MicrophoneArray):
        ears = jnp.array([[1.0, 0.0, 0.0]], jnp.float32)
    else:
        angle = math.radians(config.binaural.ear_angle)
        side, back = math.sin(angle), -math.cos(angle)
        ears = jnp.array([[-side, 0.0, back], [side, 0.0, back]], jnp.float32)
    axes = jnp.matmul(ears, turn.T, precision="highest")
    flat = jnp.sqrt(axes[:, 0] ** 2 + axes[:, 1] ** 2)
    known = flat > 1e-3  # an ear that points straight up has no azimuth
    x, y = (jnp.where(known, axes[:, i] / jnp.maximum(flat, 1e-3), 1.0 - i) for i in (0, 1))
    mix = jnp.stack([jnp.ones_like(x), x, y, x * x - y * y, 2 * x * y], axis=1)
    return jnp.broadcast_to(mix, (config.num_channels, NUM_NOISES))


def _turning_radius(config: AudioConfig) -> float:
    """Return the RMS distance of microphones from the receiver's vertical axis [m], or the head radius of `Binaural`.

    It is 0 for `Omni` and `Ambisonics`.
    """
    if isinstance(config.receiver, Omni | Ambisonics):
        return 0.0
    if isinstance(config.receiver, Binaural):
        return config.receiver.head_radius
    places = config.receiver.positions
    return math.sqrt(sum(x * x + z * z for x, _, z in places) / len(places))


def free_coherence(frequency: Float[np.ndarray, " f"], distance: float, speed: float) -> Float[np.ndarray, " f"]:
    """Compute the coherence of the pressures at two free-field points in a diffuse field: sin(k d) / (k d).

    Frequencies are in Hz, the distance in m, the speed of sound in m/s. Cook, Waterhouse, Berendt, Edelman and
    Thompson, Measurement of correlation coefficients in reverberant sound fields, JASA 27 (1955).
    """
    return np.sinc(2 * frequency * distance / speed)


def noise_levels(frequency: Float[np.ndarray, " f"], config: AudioConfig) -> Float[np.ndarray, "c f"]:
    """Compute amplitudes of the noises at frequencies [Hz]; they are 1 unless there are `NUM_NOISES`.

    Otherwise each mix of `noise_mix` has power 1. Mixes of azimuths 90 and 180 degrees apart have the coherence of a
    diffuse field, unless that requires negative powers, which become 0.
    """
    if num_noises(config) != NUM_NOISES:
        return np.ones((num_noises(config), frequency.size))
    if isinstance(config.receiver, MicrophoneArray):
        radius = _turning_radius(config)
        ways = (2 * radius, math.sqrt(2) * radius)
        opposite, across = (free_coherence(frequency, way, config.speed_of_sound) for way in ways)
    else:
        head = config.binaural.head_radius, config.speed_of_sound
        opposite, across = (diffuse_coherence(frequency, angle, *head) for angle in (np.pi, np.pi / 2))
    even, odd = (1 + opposite) / 2, (1 - opposite) / 2
    twice = np.clip((even - across) / 2, 0, even)
    levels = np.sqrt(np.maximum(np.stack([even - twice, odd, odd, twice, twice]), 0))
    return levels


@functools.cache
def octave_noise(config: AudioConfig) -> Float[np.ndarray, "*own c bands n"]:
    """Generate noises with a fixed seed, float32: `num_noises` (c), octaves (bands), samples of a response (n).

    A channel's mix of the c noises by `noise_mix`, summed over octaves, is white, has power 1 per sample, and is
    high-passed at 20 Hz. An octave has its share of that power, 0 above half the sample rate. Single noises have the
    levels of `noise_levels`. Noises and octaves are independent, and periodic with the length of a response. A
    `MicrophoneArray` has a leading axis of microphones (`own`), whose noises have the coherence of a diffuse field. The
    array is cached: do not write to it.
    """
    length = config.response_length
    frequency = np.fft.rfftfreq(length, 1 / config.sample_rate)
    bands = octave_gains(frequency)
    rng, shape = np.random.default_rng(0), (num_noises(config), *bands.shape)
    if isinstance(config.receiver, MicrophoneArray):
        phase = rng.uniform(0, 2 * np.pi, (config.num_channels, *shape))
        whole = np.einsum(
            "fij,jcbf->icbf",
            _coherence_root(frequency, config.receiver, config.speed_of_sound),
            np.exp(1j * phase),
            optimize=True,
        )
    else:
        whole = np.exp(1j * rng.uniform(0, 2 * np.pi, shape))
    spectrum = whole * noise_levels(frequency, config)[:, None] * np.sqrt(bands) * high_pass(frequency)
    return (np.fft.irfft(spectrum, length) * np.sqrt(length)).astype(np.float32)


def _coherence_root(
    frequency: Float[np.ndarray, " f"], array: MicrophoneArray, speed: float
) -> Float[np.ndarray, "f e e"]:
    """Compute symmetric square roots of the matrices of `free_coherence` between microphones.

    Independent noises mixed with these weights have that coherence: Habets, Cohen and Gannot, Generating nonstationary
    multisensor signals under a spatial coherence constraint, JASA 124 (2008).
    """
    place = np.array(array.positions)
    apart = np.linalg.norm(place[:, None] - place[None], axis=-1)
    matrix = np.sinc(2 * frequency[:, None, None] * apart[None] / speed)
    value, vector = np.linalg.eigh(matrix)
    return np.einsum("fij,fj,fkj->fik", vector, np.sqrt(np.maximum(value, 0)), vector, optimize=True)


@functools.cache
def noise_bin_table(config: AudioConfig) -> Float[np.ndarray, "*own k m s"]:
    """Split `octave_noise` into bins (k) of samples (s), weighted with `amplitude_knot_weights`.

    Rows m are knots, noises and octaves, flattened in this order. Their sum, weighted with amplitudes at the start,
    middle and end of a bin, is noise with a piecewise linear amplitude. A response is therefore one matrix product.
    """
    knots, whole = amplitude_knot_weights(config), octave_noise(config)
    own = whole.shape[:-3]
    parts = whole.reshape(*own, -1, config.num_bins, config.bin_samples)
    table = np.moveaxis(parts, -2, -3)[..., None, :, :] * knots[:, None]
    return np.ascontiguousarray(table.reshape(*own, config.num_bins, -1, config.bin_samples), np.float32)


def amplitude_knot_weights(config: AudioConfig) -> Float[np.ndarray, "knots s"]:
    """Compute the linear interpolation weight of the knots (start, middle, end) at each sample's centre in a bin."""
    place = (np.arange(config.bin_samples) + 0.5) / config.bin_samples
    middle = 1 - np.abs(2 * place - 1)
    return np.stack([np.clip(1 - 2 * place, 0, 1), middle, np.clip(2 * place - 1, 0, 1)])


class NoiseDraw(Pytree):
    """Per-environment offset and signs into the shared noise table."""

    start_bin: Int[Array, ""]  # [bins], offset
    sign: Float[Array, "c bands"]  # -1 or 1, of each noise and octave


def draw_noise(key: Array, config: AudioConfig) -> NoiseDraw:
    """Sample a bin of the shared noise and signs of noises and octaves, both uniformly.

    Environments with different keys thus have different noises.
    """
    place, signs = jax.random.split(key)
    sign = jax.random.rademacher(signs, (num_noises(config), len(BANDS)), jnp.float32)
    return NoiseDraw(jax.random.randint(place, (), 0, config.num_bins, jnp.int32), sign)
