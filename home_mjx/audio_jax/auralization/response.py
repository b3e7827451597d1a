"""Impulse responses of two ears, from paths and an energy histogram."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, Int

from home_mjx.audio_jax.auralization.diffuse import KNOTS, Draw, drawn, ear_mix, noise_bins
from home_mjx.audio_jax.auralization.hrtf import EarTable, ear_angles, ear_energy, ear_spectrum, ear_table, to_head
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, delay_kernel
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS, causal_octaves
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.propagation.tracing import Trace, trace
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

QUIETEST = 1e-3  # gain of an octave re the loudest of a path, below which it is taken as this
SOFTEST = 1e-30  # gain of a path below which it is silent
TINY = 1e-36  # power of nothing
LEAD = 0.001  # [s]: no ear hears sound by more earlier or later than the middle of the head


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
    traced = trace(scene, source, listener, trace_key, config)
    return assembled(paths, traced, listener.quat, noise_key, config)


def assembled(
    paths: Paths, traced: Trace, head_quat: Float[Array, "4"], key: Array, config: AudioConfig
) -> Float[Array, "2 l"]:
    """The response that paths and rays make at a head, see `impulse_response`; `key` chooses the noise."""
    energy = energy_histogram(traced, ear_gains(traced.direction, head_quat, config), config)
    late = late_response(energy, key, config, head_quat)
    return early_response(paths, head_quat, config) + after_direct(late, paths, config)


def after_direct(late: Float[Array, "2 l"], paths: Paths, config: AudioConfig) -> Float[Array, "2 l"]:
    """A late part without what would overtake the direct sound."""
    onset = (paths.distance[0] - config.head_radius) * jnp.float32(config.sample_rate / config.speed_of_sound)
    heard = jnp.arange(config.response_length, dtype=jnp.int32) >= onset.astype(jnp.int32)
    return jnp.where(heard[None], late, 0.0)


def ear_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "n 2 bands"]:
    """Energy gain per octave of both ears for sound from each direction in the world."""
    if config.receiver == "omni":
        return jnp.ones((direction.shape[0], 2, len(BANDS)), jnp.float32)
    return ear_energy(_ears(_taps(config), config), ear_angles(to_head(direction, head_quat), config.ear_angle))


def early_response(paths: Paths, head_quat: Float[Array, "4"], config: AudioConfig) -> Float[Array, "2 l"]:
    """Paths as pulses with fractional delays, causal octave filters and the filters of both ears."""
    taps, length = _taps(config), config.response_length
    samples = paths.distance * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    kernels = _kernels(paths, samples - whole, head_quat, config)
    start = jnp.minimum(whole.astype(jnp.int32), length)
    kernels = jnp.where((start < length)[:, None, None], kernels, 0.0)

    def add(response: Array, path: tuple[Array, Array]) -> tuple[Array, None]:
        begin, kernel = path
        there = jax.lax.dynamic_slice_in_dim(response, begin, taps, axis=1)
        return jax.lax.dynamic_update_slice_in_dim(response, there + kernel, begin, axis=1), None

    # One path after the other: a scatter would add overlapping kernels in no fixed order on a GPU.
    response, _ = jax.lax.scan(add, jnp.zeros((2, length + taps), jnp.float32), (start, kernels))
    early = _reach(config)
    return response[:, early : early + length]


def late_response(
    energy: Float[Array, "k 2 bands"], key: Array, config: AudioConfig, head_quat: Float[Array, "4"] | None = None
) -> Float[Array, "2 l"]:
    """Noise that follows an energy histogram in each octave and ear.

    The energy runs linearly from the middle of one bin to that of the next. The noise stays where it is in the world
    while the head turns, see `ear_mix`.
    """
    head_quat = jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32) if head_quat is None else head_quat
    return diffuse_response(energy, drawn(key, config), head_quat, config)


def diffuse_response(
    energy: Float[Array, "k 2 bands"], draw: Draw, head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "2 l"]:
    """The same with noise that was drawn before."""
    bins = config.num_bins
    mix = ear_mix(head_quat, config)[:, :, None] * draw.sign[None]  # (ear, channel, octave)
    amplitude = _amplitudes(jnp.roll(energy, draw.start, axis=0) / config.bin_samples, draw.start)
    each = (amplitude[:, :, :, None] * mix[None, :, None]).reshape(bins, 2, -1)
    sound = jnp.einsum("kem,kms->eks", each, jnp.asarray(noise_bins(config)), precision="highest")
    return jnp.roll(sound, -draw.start, axis=1).reshape(2, -1)


def _amplitudes(power: Float[Array, "k 2 bands"], first: Int[Array, ""]) -> Float[Array, "k 2 knots bands"]:
    """Amplitudes at the start, the middle and the end of bins, of which `first` is where a response begins.

    Between knots they run linearly, which is less than the root of a power that does; each bin is made up for it.
    """
    number = jnp.arange(power.shape[0], dtype=jnp.int32)[:, None, None]
    before = jnp.where(number == first, power, jnp.roll(power, 1, axis=0))
    after = jnp.where(number == (first - 1) % power.shape[0], power, jnp.roll(power, -1, axis=0))
    knots = jnp.sqrt(jnp.stack([(before + power) / 2, power, (power + after) / 2], axis=2))
    low, mid, high = (knots[:, :, i] for i in range(KNOTS))
    here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6
    there = (before + 6 * power + after) / 8
    return knots * jnp.sqrt(there / jnp.maximum(here, TINY))[:, :, None]


def path_spectra(
    gain: Float[Array, "p bands"],
    direction: Float[Array, "p 3"],
    head_quat: Float[Array, "4"],
    size: int,
    config: AudioConfig,
) -> tuple[Complex[Array, "p 2 f"], Float[Array, "p 2"]]:
    """What paths and both ears do to sound, at the frequencies of a transform of `size` samples.

    Returns:
        Spectra without delays, causal but for the `HALF_WIDTH` samples by which an ear's filter rings before; delays of
        both ears [samples].
    """
    loudest = jnp.max(gain, axis=1, keepdims=True)
    level = jnp.log(jnp.maximum(gain, jnp.maximum(QUIETEST * loudest, SOFTEST)))
    table = causal_octaves(size, config.sample_rate)
    real, phase = (
        jnp.matmul(level, jnp.asarray(t, jnp.float32), precision="highest") for t in (np.real(table), np.imag(table))
    )
    amplitude = jnp.where(loudest > SOFTEST, jnp.exp(real), 0.0)
    octaves = jax.lax.complex(amplitude * jnp.cos(phase), amplitude * jnp.sin(phase))[:, None]
    if config.receiver == "omni":
        shape = (gain.shape[0], 2)
        return jnp.broadcast_to(octaves, (*shape, size // 2 + 1)), jnp.zeros(shape, jnp.float32)
    ears, delay = ear_spectrum(_ears(size, config), ear_angles(to_head(direction, head_quat), config.ear_angle))
    return octaves * ears, delay * jnp.float32(config.sample_rate)


def ear_delays(
    direction: Float[Array, "p 3"], head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "p 2"]:
    """By how much both ears hear sound from each direction later than the middle of the head would [samples]."""
    if config.receiver == "omni":
        return jnp.zeros((direction.shape[0], 2), jnp.float32)
    table = _ears(_taps(config), config)
    _, delay = ear_spectrum(table, ear_angles(to_head(direction, head_quat), config.ear_angle))
    return delay * jnp.float32(config.sample_rate)


def _kernels(
    paths: Paths, rest: Float[Array, " p"], head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "p 2 t"]:
    """Impulse response of each path and ear, `rest` samples after sample `_reach` of the kernel."""
    taps, reach = _taps(config), _reach(config)
    spectrum, delay = path_spectra(paths.gain, paths.direction, head_quat, taps, config)
    late = rest[:, None] + delay
    whole = jnp.floor(late)
    kernel = jnp.fft.rfft(delay_kernel(late - whole), taps)
    turn = _turn(whole.astype(jnp.int32) + (reach - HALF_WIDTH + 1), taps)
    return jnp.fft.irfft(spectrum * kernel * turn, taps)


def _turn(samples: Int[Array, "*n"], size: int) -> Complex[Array, "*n f"]:
    """Spectrum of a delay by whole samples."""
    step = (samples[..., None] * jnp.arange(size // 2 + 1, dtype=jnp.int32)[None, None]) % size  # exact
    angle = step.astype(jnp.float32) * jnp.float32(-2 * math.pi / size)
    return jax.lax.complex(jnp.cos(angle), jnp.sin(angle))


def _reach(config: AudioConfig) -> int:
    """Samples by which a kernel begins before the sound reaches the middle of the head."""
    return 2 * HALF_WIDTH + math.ceil(LEAD * config.sample_rate)


def _ears(size: int, config: AudioConfig) -> EarTable:
    return ear_table(size, config.sample_rate, config.head_radius, config.speed_of_sound)


def _taps(config: AudioConfig) -> int:
    return 2 ** math.ceil(math.log2(CAUSAL_SECONDS * config.sample_rate + 2 * _reach(config)))
