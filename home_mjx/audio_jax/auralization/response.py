"""Impulse responses of receivers, synthesized from early paths and a late energy histogram."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, WIDTH, delay_kernel
from home_mjx.audio_jax.base.directivity import mean_energy
from home_mjx.audio_jax.base.endpoints import Head, Listener, Source, given_toward
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS
from home_mjx.audio_jax.base.shapes import num_taps, octave_shapes, octave_spectra, shapes
from home_mjx.audio_jax.late_reverb.lookup.reading import Arrivals, baked_sound
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.propagation.tracing import Trace, spread, trace
from home_mjx.audio_jax.receivers.channels import channel_delays, channel_values, late_gains
from home_mjx.audio_jax.receivers.diffuse import Draw, drawn, noise_bins
from home_mjx.audio_jax.receivers.hrtf import to_head
from home_mjx.audio_jax.receivers.shares import noise_shares
from home_mjx.core.transforms import is_unit
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

EVERYWHERE = 64  # directions that sample an isotropic field
BEFORE = 2 * HALF_WIDTH + 3  # samples of a path's kernel before its arrival


def impulse_response(
    scene: Scene, source: Source, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "e l"]:
    """Compute the impulse response from a point source to each channel of the receiver.

    Args:
        scene: The environment, whose `executor` casts the rays.
        source: The source.
        listener: The listener.
        key: Random key, typed or raw. Keep it while a listener moves, so that successive responses are coherent.
        config: Options.

    Returns:
        Pressure re the source's free field at 1 m, `config.response_length` samples per channel.

    Example:
        >>> source, listener = Source(radio), Listener(ears, quat, body=agent)  # doctest: +SKIP
        >>> response = impulse_response(scene, source, listener, jax.random.key(0), config)  # doctest: +SKIP
        >>> response.shape  # doctest: +SKIP
        (2, 8000)
    """
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    energy = late_energy(scene, source, listener, trace_key, config)
    return with_late(paths, energy, listener.quat, noise_key, config, listener.head)


def late_energy(
    scene: Scene, source: Source, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "k e bands"]:
    """Compute late energy per time bin, channel and octave, re the free field of the source at 1 m.

    For ambisonics e is 7: the energies of W, Y, Z and X, then the cross energies of W with Y, Z and X (intensity).

    Args:
        scene: The environment.
        source: The source.
        listener: The listener.
        key: Random key of the rays; unused unless `late` is "traced".
        config: Options; `late` selects traced or baked energies, or zeros.
    """
    if config.late == "none":
        return jnp.zeros((config.num_bins, config.num_energies, len(BANDS)), jnp.float32)
    if config.late == "baked":
        energy = baked_histogram(scene, source, listener, config)[0]
    else:
        energy = traced_histogram(trace(scene, source, listener, key, config), listener.quat, config, listener.head)
    return jnp.where(is_unit(listener.quat), energy, 0.0)  # as for paths, see `early_paths`


def traced_histogram(
    traced: Trace, head_quat: Float[Array, "4"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "k e bands"]:
    """Compute the energy of traced rays per time bin, channel and octave."""
    energy = energy_histogram(traced, late_gains(traced.direction, head_quat, config, head), config)
    return _to_all(energy, config)


def _to_all(energy: Float[Array, "k d bands"], config: AudioConfig) -> Float[Array, "k e bands"]:
    """Broadcast the energies of distinct channels to all channels."""
    return jnp.broadcast_to(energy, (energy.shape[0], config.num_energies, energy.shape[2]))


def baked_histogram(
    scene: Scene, source: Source, listener: Listener, config: AudioConfig
) -> tuple[Float[Array, "k e bands"], Float[Array, "3"]]:
    """Return baked late energy per time bin, channel and octave, and its energy-weighted mean direction of incidence.

    In each time span, the length of the mean direction (0 .. 1) is the share of energy from that direction; the rest is
    isotropic.
    """
    late = baked_sound(scene, source.pos, listener.pos, config)
    late = late.replace(energy=late.energy * late_share(source, late))
    length = jnp.linalg.norm(late.comes_from, axis=1, keepdims=True)  # (spans, 1)
    toward = late.comes_from / jnp.maximum(length, 1e-6)
    upright = jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32)  # isotropic energy is independent of the head's orientation
    around = jnp.mean(late_gains(jnp.asarray(spread(EVERYWHERE)), upright, config, listener.head), axis=0)
    there = late_gains(toward, listener.quat, config, listener.head) - around[None]
    gain = around[None] + jnp.einsum("ks,seb->keb", late.span * length.T, there, precision="highest")
    whole = jnp.einsum("kb,ks->s", late.energy, late.span, precision="highest")
    mean = jnp.sum(whole[:, None] * late.comes_from, axis=0) / jnp.maximum(jnp.sum(late.energy), 1e-30)
    return _to_all(late.energy[:, None] * gain, config), mean


def late_share(source: Source, late: Arrivals) -> Float[Array, "k bands"] | float:
    """Compute the late energy of a directional source in each bin re an omnidirectional one; 1.0 without directivity.

    In each time span, the length of the mean departure direction is the share of energy emitted that way; the rest is
    emitted isotropically.
    """
    if source.directivity is None:
        return 1.0
    length = jnp.linalg.norm(late.leaves_to, axis=1, keepdims=True)
    toward = given_toward(source, late.leaves_to / jnp.maximum(length, 1e-6)) ** 2
    everywhere = mean_energy(source.directivity)[None]
    return everywhere + jnp.matmul(late.span, length * (toward - everywhere), precision="highest")


def with_late(
    paths: Paths,
    energy: Float[Array, "k e bands"],
    head_quat: Float[Array, "4"],
    key: Array,
    config: AudioConfig,
    head: Head | None = None,
) -> Float[Array, "c l"]:
    """Synthesize a response from early paths and noise shaped by a late energy histogram after the direct sound."""
    late = late_response(energy, key, config, head_quat)
    return early_response(paths, head_quat, config, head) + after_direct(late, paths, config)


def after_direct(late: Float[Array, "e l"], paths: Paths, config: AudioConfig) -> Float[Array, "e l"]:
    """Zero the late response before the direct sound arrives."""
    heard = jnp.arange(config.response_length, dtype=jnp.int32) >= onset_of(paths, config)
    return jnp.where(heard[None], late, 0.0)


def onset_of(paths: Paths, config: AudioConfig) -> Int[Array, ""]:
    """Compute the first sample of a response that direct sound can reach."""
    onset = (paths.distance[0] - config.receiver_radius) * jnp.float32(config.sample_rate / config.speed_of_sound)
    return onset.astype(jnp.int32)


def early_response(
    paths: Paths, head_quat: Float[Array, "4"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "e l"]:
    """Synthesize paths as pulses with fractional delays, causal octave filters and the filters of each channel.

    Args:
        paths: Early paths; the direct one first, which has octave filters of its own.
        head_quat: Orientation of the head, wxyz.
        config: Options.
        head: Measured HRTFs; None: a rigid sphere.

    Returns:
        Pressure re the source's free field at 1 m, `config.response_length` samples per channel.
    """
    length, reach = config.response_length, _reach(config)
    samples = paths.distance * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    samples = whole if config.early == "home" else samples
    toward = to_head(paths.direction, head_quat)
    late = (samples - whole)[:, None] + channel_delays(toward, paths.distance, config, head)
    late = jnp.broadcast_to(late, (late.shape[0], config.num_channels))
    more = jnp.floor(late)
    weight = path_weights(paths.gain, toward, paths.distance, config, head)
    kernels = _kernels(weight, late - more, config)
    begin = jnp.clip((whole[:, None] + more).astype(jnp.int32) + (reach - BEFORE), 0, length + reach)
    kernels = jnp.where((whole < length)[:, None, None], kernels, 0.0)
    own = octave_spectra(paths.gain[:1], _long(config), config.sample_rate)
    direct = jnp.fft.rfft(kernels[0], _long(config)) * own
    blank = jnp.zeros(length + reach + _long(config), jnp.float32)

    def add(response: Array, path: tuple[Array, Array]) -> tuple[Array, None]:
        begin, kernel = path
        there = jax.lax.dynamic_slice_in_dim(response, begin, kernel.size)
        return jax.lax.dynamic_update_slice_in_dim(response, there + kernel, begin, 0), None

    def ear(begin: Int[Array, " p"], kernels: Float[Array, "p t"], direct: Float[Array, " u"]) -> Float[Array, " l"]:
        # Paths are added sequentially: a scatter would add overlapping kernels in no fixed order on a GPU.
        response = jax.lax.dynamic_update_slice_in_dim(blank, direct, begin[0], 0)
        response, _ = jax.lax.scan(add, response, (begin[1:], kernels[1:]))
        return response[reach : reach + length]

    return jax.vmap(ear, (1, 1, 0))(begin, kernels, jnp.fft.irfft(direct, _long(config)))


def path_weights(
    gain: Float[Array, "p bands"],
    toward: Float[Array, "p 3"],
    distance: Float[Array, " p"],
    config: AudioConfig,
    head: Head | None = None,
) -> Float[Array, "p e s"]:
    """Compute the weight of each basis filter (`shapes`) per path and channel, without the octave gains of the first.

    The first path is the direct one. It may cross walls, whose steep spectra the basis does not resolve, so it has
    octave filters of its own.
    """
    octaves = octave_shapes(gain.at[0].set(1.0), config.sample_rate)
    return jnp.real(octaves[:, None] * channel_values(toward, distance, config, head))


def _kernels(weight: Float[Array, "p e s"], delay: Float[Array, "p e"], config: AudioConfig) -> Float[Array, "p e t"]:
    """Compute impulse responses of paths, from `BEFORE` samples before their arrival on."""
    size = _taps(config)
    spectra = np.fft.rfft(shapes(config.sample_rate).kernel, size)
    parts = (jnp.asarray(x, jnp.float32) for x in (spectra.real, spectra.imag))
    shaped = jax.lax.complex(*(jnp.einsum("pes,sf->pef", weight, x, precision="highest") for x in parts))
    return jnp.fft.irfft(shaped * jnp.fft.rfft(delay_kernel(delay), size), size)


def late_response(
    energy: Float[Array, "k e bands"], key: Array, config: AudioConfig, head_quat: Float[Array, "4"] | None = None
) -> Float[Array, "c l"]:
    """Synthesize noise with the energies of a histogram in each octave and channel.

    Energy is interpolated linearly between bin centres. The noise field is fixed to the world while the head turns, see
    `ear_mix`. In ambisonics, cross energies of W with Y, Z and X (`late_energy`) are rendered as W's noise in those
    channels. Intensity then points to the direction of incidence; without cross energies channels are uncorrelated.

    Args:
        energy: Energy per bin, channel and octave, from `late_energy`.
        key: Random key that selects the noise.
        config: Options.
        head_quat: Orientation of the head, wxyz; None: the identity.

    Returns:
        Pressure, `config.response_length` samples per channel.
    """
    head_quat = jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32) if head_quat is None else head_quat
    return diffuse_response(energy, drawn(key, config), head_quat, config)


def diffuse_response(
    energy: Float[Array, "k e bands"], draw: Draw, head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "c l"]:
    """Synthesize the late response with a given draw of the noise, see `late_response`."""
    table = jnp.asarray(noise_bins(config))
    subscripts = "kem,ekms->eks" if table.ndim == 4 else "kem,kms->eks"  # separate noise per channel, or shared noise
    sound = jnp.einsum(subscripts, noise_shares(energy, draw, head_quat, config).of_bins(), table, precision="highest")
    return jnp.roll(sound, -draw.start, axis=1).reshape(config.num_channels, -1)


def _reach(config: AudioConfig) -> int:
    """Return the samples by which a kernel begins before the arrival at the head centre."""
    return BEFORE + math.ceil(config.lead_seconds * config.sample_rate)


def _taps(config: AudioConfig) -> int:
    """Return the transform size of path kernels [samples]."""
    return 2 ** math.ceil(math.log2(num_taps(config.sample_rate) + 2 * HALF_WIDTH + WIDTH))


def _long(config: AudioConfig) -> int:
    return 2 ** math.ceil(math.log2(CAUSAL_SECONDS * config.sample_rate + _taps(config)))
