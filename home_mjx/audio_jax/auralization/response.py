"""Impulse responses of two ears, from paths and an energy histogram."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.auralization.hrtf import EarTable, ear_angles, ear_energy, ear_spectrum, ear_table, to_head
from home_mjx.audio_jax.baked.reading import baked_sound
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.base.filters import high_pass, octave_gains
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.propagation.tracing import Trace, spread, trace
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

EVERYWHERE = 64  # directions whose mean stands for all
KERNEL_SECONDS = 0.032  # resolves the octaves at 125 and 250 Hz
NOISE_LENGTH = 4  # the noise of all environments is this many responses long


def impulse_response(
    scene: Scene, source: Source, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "2 l"]:
    """What the left and right ear hear of a pulse from a point source.

    Args:
        scene: The environment, whose `executor` casts the rays.
        source: Who sounds.
        listener: Who hears.
        key: Random key, typed or raw. Keep it while a listener moves, so that successive responses are coherent.
        config: Options.

    Returns:
        Pressure re the source's free field at 1 m, `config.response_length` samples per ear.

    Example:
        >>> source, listener = Source(radio), Listener(ears, quat, body=agent)  # doctest: +SKIP
        >>> response = impulse_response(scene, source, listener, jax.random.key(0), config)  # doctest: +SKIP
        >>> response.shape  # doctest: +SKIP
        (2, 8000)
    """
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    energy = late_energy(scene, source, listener, trace_key, config)
    return with_late(paths, energy, listener.quat, noise_key, config)


def late_energy(
    scene: Scene, source: Source, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "k 2 bands"]:
    """Late energy per time bin, ear and octave, re the free field of the source at 1 m: traced or baked.

    Args:
        scene: The environment.
        source: Who sounds.
        listener: Who hears.
        key: Of the rays; of no use if late sound is baked.
        config: `late` says which.
    """
    if config.late == "baked":
        return baked_histogram(scene, source, listener, config)[0]
    rays = trace(scene, source, listener, key, config)
    return energy_histogram(rays, ear_gains(rays.direction, listener.quat, config), config)


def baked_histogram(
    scene: Scene, source: Source, listener: Listener, config: AudioConfig
) -> tuple[Float[Array, "k 2 bands"], Float[Array, "3"]]:
    """Baked late energy per time bin, ear and octave, as `energy_histogram` gives it; and where it comes from.

    As much of it as its mean direction is long comes from there, the rest from everywhere.
    """
    late = baked_sound(scene, source.pos, listener.pos, config)
    length = jnp.linalg.norm(late.comes_from)
    toward = late.comes_from / jnp.maximum(length, 1e-6)
    around = jnp.mean(ear_gains(jnp.asarray(spread(EVERYWHERE)), listener.quat, config), axis=0)
    gain = (1 - length) * around + length * ear_gains(toward[None], listener.quat, config)[0]
    return late.energy[:, None] * gain[None], late.comes_from


def assembled(
    paths: Paths, traced: Trace, head_quat: Float[Array, "4"], key: Array, config: AudioConfig
) -> Float[Array, "2 l"]:
    """The response that paths and rays make at a head, see `impulse_response`; `key` chooses the noise."""
    energy = energy_histogram(traced, ear_gains(traced.direction, head_quat, config), config)
    return with_late(paths, energy, head_quat, key, config)


def with_late(
    paths: Paths, energy: Float[Array, "k 2 bands"], head_quat: Float[Array, "4"], key: Array, config: AudioConfig
) -> Float[Array, "2 l"]:
    """Paths, and noise that follows a histogram of energy from the direct sound on."""
    late = late_response(energy, key, config)
    onset = (paths.distance[0] - config.head_radius) * jnp.float32(config.sample_rate / config.speed_of_sound)
    # nothing overtakes the direct sound
    heard = jnp.arange(config.response_length, dtype=jnp.int32) >= onset.astype(jnp.int32)
    return early_response(paths, head_quat, config) + jnp.where(heard[None], late, 0.0)


def ear_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "n 2 bands"]:
    """Energy gain per octave of both ears for sound from each direction in the world."""
    if config.receiver == "omni":
        return jnp.ones((direction.shape[0], 2, len(BANDS)), jnp.float32)
    return ear_energy(_ears(config), ear_angles(to_head(direction, head_quat), config.ear_angle))


def early_response(paths: Paths, head_quat: Float[Array, "4"], config: AudioConfig) -> Float[Array, "2 l"]:
    """Paths as pulses with fractional delays, octave gains and the filters of both ears."""
    taps = _taps(config)
    samples = paths.distance * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    kernels = _kernels(paths, samples - whole, head_quat, config)
    length = config.response_length
    start = jnp.minimum(whole.astype(jnp.int32), length)
    kernels = jnp.where((start < length)[:, None, None], kernels, 0.0)

    def add(response: Array, path: tuple[Array, Array]) -> tuple[Array, None]:
        begin, kernel = path
        there = jax.lax.dynamic_slice_in_dim(response, begin, taps, axis=1)
        return jax.lax.dynamic_update_slice_in_dim(response, there + kernel, begin, axis=1), None

    # One path after the other: a scatter would add overlapping kernels in no fixed order on a GPU.
    response, _ = jax.lax.scan(add, jnp.zeros((2, length + taps), jnp.float32), (start, kernels))
    return response[:, taps // 2 : taps // 2 + length]


def late_response(energy: Float[Array, "k 2 bands"], key: Array, config: AudioConfig) -> Float[Array, "2 l"]:
    """Noise that follows an energy histogram in each octave and ear.

    The energy runs linearly from the middle of one bin to that of the next. One long noise serves everybody, each
    environment from its own place on.
    """
    noise = jnp.asarray(_noise(config))
    start = jax.random.randint(key, (), 0, noise.shape[-1] - config.response_length, jnp.int32)
    noise = jax.lax.dynamic_slice_in_dim(noise, start, config.response_length, axis=2)
    size = config.bin_samples
    power = jnp.moveaxis(jnp.pad(energy, ((1, 1), (0, 0), (0, 0)), mode="edge"), 0, -1)[..., None] / size
    place = (jnp.arange(size, dtype=jnp.float32) + 0.5)[None, None, None] / size - 0.5  # re the bin's middle
    before, after = jnp.maximum(-place, 0.0), jnp.maximum(place, 0.0)
    power = power[:, :, :-2] * before + power[:, :, 1:-1] * (1 - before - after) + power[:, :, 2:] * after
    return jnp.sum(noise * jnp.sqrt(power).reshape(noise.shape), axis=1)


def _kernels(
    paths: Paths, rest: Float[Array, " p"], head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "p 2 t"]:
    """Impulse response of each path and ear around the middle of the kernel, `rest` samples after it."""
    taps = _taps(config)
    frequency = np.fft.rfftfreq(taps, 1 / config.sample_rate)
    bands = jnp.asarray(octave_gains(frequency), jnp.float32)
    spectrum, delay = _ear_filters(paths.direction, head_quat, config)
    shift = taps // 2 + rest[:, None] + delay * jnp.float32(config.sample_rate)
    angle = shift[..., None] * jnp.asarray(-2 * np.pi * frequency / config.sample_rate, jnp.float32)[None, None]
    gain = jnp.einsum("pb,bf->pf", paths.gain, bands, precision="highest")
    turn = jax.lax.complex(jnp.cos(angle), jnp.sin(angle))
    return jnp.fft.irfft(gain[:, None].astype(jnp.complex64) * spectrum * turn, taps)


def _ear_filters(
    direction: Float[Array, "p 3"], head_quat: Float[Array, "4"], config: AudioConfig
) -> tuple[Complex[Array, "p 2 f"], Float[Array, "p 2"]]:
    """Spectrum without delay, and delay [s], of both ears."""
    if config.receiver == "omni":
        shape = (direction.shape[0], 2)
        return jnp.ones((*shape, _taps(config) // 2 + 1), jnp.complex64), jnp.zeros(shape, jnp.float32)
    return ear_spectrum(_ears(config), ear_angles(to_head(direction, head_quat), config.ear_angle))


def _ears(config: AudioConfig) -> EarTable:
    return ear_table(_taps(config), config.sample_rate, config.head_radius, config.speed_of_sound)


def _taps(config: AudioConfig) -> int:
    return 2 ** math.ceil(math.log2(KERNEL_SECONDS * config.sample_rate))


@functools.cache
def _noise(config: AudioConfig) -> Float[np.ndarray, "2 bands n"]:
    """White noise of unit variance for both ears, split into octaves that are independent of each other.

    The ears' noises are as coherent as the pressures of a diffuse field at two points a head apart: sin(kd) / kd.
    """
    length = NOISE_LENGTH * 2 ** math.ceil(math.log2(config.response_length))
    frequency = np.fft.rfftfreq(length, 1 / config.sample_rate)
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, (2, len(BANDS), frequency.size))
    left, other = np.exp(1j * phase)
    spacing = 0.0 if config.receiver == "omni" else 2 * config.head_radius
    coherence = np.sinc(2 * frequency * spacing / config.speed_of_sound)
    ears = np.stack([left, coherence * left + np.sqrt(1 - coherence**2) * other])
    bands = np.sqrt(octave_gains(frequency)) * high_pass(frequency)
    return (np.fft.irfft(ears * bands, length) * np.sqrt(length)).astype(np.float32)
