"""Impulse responses of receivers, synthesized from early paths and a late energy histogram."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, KERNEL_WIDTH, delay_kernel
from home_mjx.audio_jax.base.directivity import mean_energy
from home_mjx.audio_jax.base.endpoints import Listener, MeasuredHead, SoundSource, emission_gains
from home_mjx.audio_jax.base.filter_basis import filter_basis, num_basis_taps, octave_filters_at_knots, octave_spectra
from home_mjx.audio_jax.base.filters import MAX_RINGING_SECONDS
from home_mjx.audio_jax.base.options import Baked, NoLate
from home_mjx.audio_jax.late_reverb.lookup.lookup import LateArrivals, lookup_late_sound
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.propagation.tracing import Trace, fibonacci_directions, trace
from home_mjx.audio_jax.receivers.channels import channel_delays, channel_filters, late_channel_gains
from home_mjx.audio_jax.receivers.diffuse_noise import NoiseDraw, draw_noise, noise_bin_table
from home_mjx.audio_jax.receivers.noise_gains import noise_gains
from home_mjx.audio_jax.receivers.spherical_head import world_to_head
from home_mjx.core.transforms import is_unit_quat
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

NUM_ISOTROPIC_DIRECTIONS = 64  # directions that sample an isotropic field
NUM_KERNEL_PRE_SAMPLES = 2 * HALF_WIDTH + 3  # samples of a path's kernel before its arrival


def impulse_response(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "e l"]:
    """Compute the impulse response from a point source to each channel of the receiver.

    Keep `key`, typed or raw, while a listener moves, so that successive responses are coherent.

    Returns:
        Pressure re the source's free field at 1 m, `config.response_length` samples per channel from emission on.

    Raises:
        ConfigError: As of `early_paths`, or of `late_energy`. Or `listener.head` does not suit the receiver.

    Example:
        >>> source, listener = SoundSource(radio), Listener(ears, quat, body=agent)  # doctest: +SKIP
        >>> response = impulse_response(scene, source, listener, jax.random.key(0), config)  # doctest: +SKIP
        >>> response.shape  # doctest: +SKIP
        (2, 8000)
    """
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    energy = late_energy(scene, source, listener, trace_key, config)
    return combine_early_late(paths, energy, listener.quat, noise_key, config, listener.head)


def late_energy(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> Float[Array, "k e bands"]:
    """Compute late energy per time bin, channel and octave, re the free field of the source at 1 m.

    `config.late` selects rays drawn by `key`, baked energies, or zeros. For ambisonics e is 7: the energies of W, Y, Z
    and X, then the cross energies of W with Y, Z and X (intensity). Energies are 0 if the listener's quaternion is not
    of unit length.

    Raises:
        ConfigError: `config.late` is `Baked` and the bank has no baked sound.
    """
    if isinstance(config.late, NoLate):
        return jnp.zeros((config.num_bins, config.num_late_channels, len(BANDS)), jnp.float32)
    if isinstance(config.late, Baked):
        energy = baked_energy(scene, source, listener, config)[0]
    else:
        energy = traced_energy(trace(scene, source, listener, key, config), listener.quat, config, listener.head)
    return jnp.where(is_unit_quat(listener.quat), energy, 0.0)  # as for paths, see `early_paths`


def traced_energy(
    traced: Trace, head_quat: Float[Array, "4"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "k e bands"]:
    """Compute the energy of traced rays per time bin, late channel and octave, see `late_energy`.

    The quaternion is not checked.
    """
    energy = energy_histogram(traced, late_channel_gains(traced.direction, head_quat, config, head), config)
    return _broadcast_channels(energy, config)


def _broadcast_channels(energy: Float[Array, "k d bands"], config: AudioConfig) -> Float[Array, "k e bands"]:
    """Broadcast energies of distinct channels (d = 1 or e) to all `config.num_late_channels`."""
    return jnp.broadcast_to(energy, (energy.shape[0], config.num_late_channels, energy.shape[2]))


def baked_energy(
    scene: Scene, source: SoundSource, listener: Listener, config: AudioConfig
) -> tuple[Float[Array, "k e bands"], Float[Array, "3"]]:
    """Return baked late energy per time bin, channel and octave, and its mean direction of incidence over all bins.

    The mean direction is in the world, weighted by energy, of length at most 1. Energies are computed with a direction
    per time span instead. Its length is the share of energy from there; the rest is isotropic. Energies include the
    source's directivity, and are re its free field at 1 m. Channels are those of `late_energy`.
    """
    late = lookup_late_sound(scene, source.pos, listener.pos, config)
    late = late.replace(energy=late.energy * late_directivity_gain(source, late))
    toward, directed, isotropic = _split_directions(late, late.arrival_direction)
    upright = jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32)  # isotropic energy is independent of the head's orientation
    around = jnp.mean(
        late_channel_gains(jnp.asarray(fibonacci_directions(NUM_ISOTROPIC_DIRECTIONS)), upright, config, listener.head),
        axis=0,
    )
    there = late_channel_gains(toward, listener.quat, config, listener.head)
    gain = isotropic[:, None, None] * around[None] + jnp.einsum("ks,seb->keb", directed, there, precision="highest")
    whole = jnp.einsum("kb,ks->s", late.energy, late.span_share, precision="highest")
    mean = jnp.sum(whole[:, None] * late.arrival_direction, axis=0) / jnp.maximum(jnp.sum(late.energy), 1e-30)
    return _broadcast_channels(late.energy[:, None] * gain, config), mean


def late_directivity_gain(source: SoundSource, late: LateArrivals) -> Float[Array, "k bands"] | float:
    """Compute the late energy of a directional source in each bin re an omnidirectional one; 1.0 without directivity.

    In each time span, the length of the mean departure direction is the share of energy emitted that way; the rest is
    emitted isotropically.
    """
    if source.directivity is None:
        return 1.0
    toward, directed, isotropic = _split_directions(late, late.emission_direction)
    there, everywhere = emission_gains(source, toward) ** 2, mean_energy(source.directivity)
    return isotropic[:, None] * everywhere[None] + jnp.matmul(directed, there, precision="highest")


def _split_directions(
    late: LateArrivals, mean: Float[Array, "spans 3"]
) -> tuple[Float[Array, "spans 3"], Float[Array, "k spans"], Float[Array, " k"]]:
    """Return the unit vectors of mean directions, and of each bin's energy the share per vector and the isotropic rest.

    No share is negative, so that sums of gains weighted by them are not either; differences of gains round below 0.
    """
    length = jnp.linalg.norm(mean, axis=1, keepdims=True)
    directed = late.span_share * length.T
    return mean / jnp.maximum(length, 1e-6), directed, jnp.maximum(1 - jnp.sum(directed, axis=1), 0.0)


def combine_early_late(
    paths: Paths,
    energy: Float[Array, "k e bands"],
    head_quat: Float[Array, "4"],
    key: Array,
    config: AudioConfig,
    head: MeasuredHead | None = None,
) -> Float[Array, "c l"]:
    """Return the impulse response: `early_response` plus noise (drawn by `key`) with the late energies.

    The noise is 0 before `direct_onset`.
    """
    late = late_response(energy, key, config, head_quat)
    return early_response(paths, head_quat, config, head) + mask_before_direct(late, paths, config)


def mask_before_direct(late: Float[Array, "e l"], paths: Paths, config: AudioConfig) -> Float[Array, "e l"]:
    """Return a copy of the late response with zeros before `direct_onset`; the first path is the direct one."""
    heard = jnp.arange(config.response_length, dtype=jnp.int32) >= direct_onset(paths, config)
    return jnp.where(heard[None], late, 0.0)


def direct_onset(paths: Paths, config: AudioConfig) -> Int[Array, ""]:
    """Compute the sample after emission at which direct sound may first reach the receiver, rounded towards 0.

    It is the distance of the first path less the receiver's radius; negative within it.
    """
    onset = (paths.distance[0] - config.receiver_radius) * jnp.float32(config.sample_rate / config.speed_of_sound)
    return onset.astype(jnp.int32)


def early_response(
    paths: Paths, head_quat: Float[Array, "4"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "e l"]:
    """Synthesize paths as pulses with fractional delays, causal octave filters and the filters of each channel.

    Paths that arrive after the response's end are left out.

    Args:
        paths: Early paths; the direct one first, which has octave filters of its own.
        head_quat: Orientation of the head, wxyz.
        config: Options.
        head: Measured HRTFs; None: a rigid sphere.

    Returns:
        Pressure re the source's free field at 1 m, `config.response_length` samples per channel.
    """
    length, reach = config.response_length, _pre_delay(config)
    samples = paths.distance * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    toward = world_to_head(paths.direction, head_quat)
    late = (samples - whole)[:, None] + channel_delays(toward, paths.distance, config, head)
    late = jnp.broadcast_to(late, (late.shape[0], config.num_channels))
    more = jnp.floor(late)
    weight = path_basis_weights(paths.gain, toward, paths.distance, config, head)
    kernels = _path_kernels(weight, late - more, config)
    begin = jnp.clip((whole[:, None] + more).astype(jnp.int32) + (reach - NUM_KERNEL_PRE_SAMPLES), 0, length + reach)
    kernels = jnp.where((whole < length)[:, None, None], kernels, 0.0)
    own = octave_spectra(paths.gain[:1], _direct_transform_size(config), config.sample_rate)
    direct = jnp.fft.rfft(kernels[0], _direct_transform_size(config)) * own
    blank = jnp.zeros(length + reach + _direct_transform_size(config), jnp.float32)

    def add(response: Array, path: tuple[Array, Array]) -> tuple[Array, None]:
        """Add the kernel of one path."""
        begin, kernel = path
        there = jax.lax.dynamic_slice_in_dim(response, begin, kernel.size)
        return jax.lax.dynamic_update_slice_in_dim(response, there + kernel, begin, 0), None

    def ear(begin: Int[Array, " p"], kernels: Float[Array, "p t"], direct: Float[Array, " u"]) -> Float[Array, " l"]:
        """Return the response of one channel."""
        # Paths are added sequentially: a scatter would add overlapping kernels in no fixed order on a GPU.
        response = jax.lax.dynamic_update_slice_in_dim(blank, direct, begin[0], 0)
        response, _ = jax.lax.scan(add, response, (begin[1:], kernels[1:]))
        return response[reach : reach + length]

    return jax.vmap(ear, (1, 1, 0))(begin, kernels, jnp.fft.irfft(direct, _direct_transform_size(config)))


def path_basis_weights(
    gain: Float[Array, "p bands"],
    toward: Float[Array, "p 3"],
    distance: Float[Array, " p"],
    config: AudioConfig,
    head: MeasuredHead | None = None,
) -> Float[Array, "p e s"]:
    """Compute the weight of each filter of `filter_basis` per path and channel; the first path counts with gain 1.

    The first path is the direct one. It may cross walls, whose steep spectra the basis does not resolve, so it has
    octave filters of its own. Directions `toward` are unit vectors in the head frame, as of `channel_filters`.
    """
    octaves = octave_filters_at_knots(gain.at[0].set(1.0), config.sample_rate)
    return jnp.real(octaves[:, None] * channel_filters(toward, distance, config, head))


def _path_kernels(
    weight: Float[Array, "p e s"], delay: Float[Array, "p e"], config: AudioConfig
) -> Float[Array, "p e t"]:
    """Compute pulses of `path_basis_weights`, delayed by 0 .. 1 samples; time 0 is at tap `NUM_KERNEL_PRE_SAMPLES`."""
    size = _transform_size(config)
    spectra = np.fft.rfft(filter_basis(config.sample_rate).kernel, size)
    parts = (jnp.asarray(x, jnp.float32) for x in (spectra.real, spectra.imag))
    shaped = jax.lax.complex(*(jnp.einsum("pes,sf->pef", weight, x, precision="highest") for x in parts))
    return jnp.fft.irfft(shaped * jnp.fft.rfft(delay_kernel(delay), size), size)


def late_response(
    energy: Float[Array, "k e bands"], key: Array, config: AudioConfig, head_quat: Float[Array, "4"] | None = None
) -> Float[Array, "c l"]:
    """Synthesize noise with the energies of a histogram in each octave and channel.

    Energy is interpolated linearly between bin centres. The noise field is fixed to the world while the head turns, see
    `noise_mix`. In ambisonics, cross energies of W with Y, Z and X (`late_energy`) are rendered as W's noise in those
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
    return diffuse_response(energy, draw_noise(key, config), head_quat, config)


def diffuse_response(
    energy: Float[Array, "k e bands"], draw: NoiseDraw, head_quat: Float[Array, "4"], config: AudioConfig
) -> Float[Array, "c l"]:
    """Synthesize late pressure per channel from `late_energy` and a given draw of the noise, see `late_response`."""
    table = jnp.asarray(noise_bin_table(config))
    subscripts = "kem,ekms->eks" if table.ndim == 4 else "kem,kms->eks"  # separate noise per channel, or shared noise
    sound = jnp.einsum(
        subscripts, noise_gains(energy, draw, head_quat, config).bin_weights(), table, precision="highest"
    )
    return jnp.roll(sound, -draw.start_bin, axis=1).reshape(config.num_channels, -1)


def _pre_delay(config: AudioConfig) -> int:
    """Return the maximum number of samples by which a path's kernel begins before the arrival at the head centre."""
    return NUM_KERNEL_PRE_SAMPLES + math.ceil(config.max_lead_seconds * config.sample_rate)


def _transform_size(config: AudioConfig) -> int:
    """Return the transform size and length of path kernels [samples], a power of two."""
    return 2 ** math.ceil(math.log2(num_basis_taps(config.sample_rate) + 2 * HALF_WIDTH + KERNEL_WIDTH))


def _direct_transform_size(config: AudioConfig) -> int:
    """Return the transform size of the direct path's octave filters and kernel [samples], a power of two."""
    return 2 ** math.ceil(math.log2(MAX_RINGING_SECONDS * config.sample_rate + _transform_size(config)))
