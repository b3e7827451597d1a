"""Energy envelopes of impulse responses and interaural time differences, computed without waveforms."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.clips import clip_samples
from home_mjx.audio_jax.auralization.response import baked_energy, traced_energy
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.base.options import Baked, Binaural, NoLate
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.tracing import trace
from home_mjx.audio_jax.receivers.channels import channel_gains
from home_mjx.audio_jax.receivers.hrtf_interpolation import interpolate_directions
from home_mjx.audio_jax.receivers.spherical_head import ear_angles, ear_spectrum, ear_table, world_to_head
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import is_unit_quat
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

HRTF_TAPS = 256  # of the head's table, which is read for its delays only


class EnergyEnvelope(Pytree):
    """Energy envelope of an impulse response."""

    energy: Float[Array, "k e bands"]  # per time bin, channel and octave, re the free field of the source at 1 m
    # [s], energy-weighted mean arrival-time lead of the left ear; 0 unless `Binaural`
    left_ear_lead: Float[Array, " bands"]


def energy_envelope(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> EnergyEnvelope:
    """Compute the energy envelope of `impulse_response` from the same paths and rays, without synthesis.

    With the same `key` the rays are the same. Energies of paths are added incoherently; paths beyond the last bin are
    dropped. Interaural leads are those of a rigid sphere (Woodworth), or of the listener's measured head. Errors are
    those of `impulse_response`. Inside `jit`, everything is 0 if the listener's quaternion is not of unit length.

    Example:
        >>> envelope = energy_envelope(scene, source, listener, jax.random.key(0), config)  # doctest: +SKIP
        >>> 10 * jnp.log10(envelope.energy.sum(axis=0))  # doctest: +SKIP
    """
    rays, _ = jax.random.split(key)  # as in `impulse_response`
    paths = early_paths(scene, source, listener, config)
    late, directions, weights = _late_energies(scene, source, listener, rays, config)
    late, weights = (jnp.where(is_unit_quat(listener.quat), x, 0.0) for x in (late, weights))  # as of `late_energy`
    power = paths.gain**2
    bins = (paths.distance / (config.bin_seconds * config.speed_of_sound)).astype(jnp.int32)
    member = (bins[None] == jnp.arange(config.num_bins, dtype=jnp.int32)[:, None]).astype(jnp.float32)
    heard = power[:, None] * channel_gains(paths.direction, listener.quat, config, listener.head)
    early = jnp.einsum("kp,peb->keb", member, heard, precision="highest")
    direction = jnp.concatenate([paths.direction, directions])
    weight = jnp.concatenate([power, weights])
    lead = jnp.einsum("n,nb->b", _left_ear_leads(direction, listener, config), weight, precision="highest")
    return EnergyEnvelope(energy=early + late, left_ear_lead=lead / jnp.maximum(jnp.sum(weight, axis=0), 1e-30))


def _late_energies(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> tuple[Float[Array, "k e bands"], Float[Array, "n 3"], Float[Array, "n bands"]]:
    """Return late energies per bin, and n world directions of incidence with their energies over all bins.

    n is 0 with `NoLate`, 2 with `Baked` (the mean direction and its opposite), else the number of rays. Energies of
    directions include the head's gains only with `Baked`, as means over channels.
    """
    if isinstance(config.late, NoLate):
        nowhere, nothing = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, len(BANDS)), jnp.float32)
        return jnp.zeros((config.num_bins, config.num_channels, len(BANDS)), jnp.float32), nowhere, nothing
    if isinstance(config.late, Baked):
        late, toward = baked_energy(scene, source, listener, config)
        late = late[:, : config.num_channels]
        whole, length = jnp.mean(jnp.sum(late, axis=0), axis=0), jnp.linalg.norm(toward)
        ends = jnp.stack([toward, -toward]) / jnp.maximum(length, 1e-6)
        return late, ends, 0.5 * jnp.stack([1 + length, 1 - length])[:, None] * whole[None]
    traced = trace(scene, source, listener, key, config)
    late = traced_energy(traced, listener.quat, config, listener.head)[:, : config.num_channels]
    return late, traced.direction, jnp.sum(traced.energy, axis=0)


def mean_band_power(envelope: Float[Array, "k e bands"], power: Float[Array, "w bands"]) -> Float[Array, "e bands"]:
    """Compute the mean power in each channel and octave during a frame, from energies and the emitted power.

    It is the sum over bins of their energy times the power emitted as many bins earlier, averaged over the frame.

    Args:
        envelope: Energy per time bin, see `EnergyEnvelope`.
        power: Power at 1 m from the source per bin and octave: w = k - 1 + n bins, the last n being the frame's.
    """
    count = envelope.shape[0]
    frame = power.shape[0] - count + 1
    total = jnp.concatenate([jnp.zeros((1, power.shape[1])), jnp.cumsum(power, axis=0)])
    start = count - 1 - jnp.arange(count, dtype=jnp.int32)
    mean = (total[start + frame] - total[start]) / frame  # emitted power, by delay in bins
    return jnp.einsum("keb,kb->eb", envelope, mean, precision="highest")


@functools.cache
def clip_power(name: str, config: AudioConfig) -> Float[np.ndarray, "bins bands"]:
    """Compute a clip's mean power at 1 m from its source, per time bin and octave; a partial last bin is omitted.

    The array is cached: do not write to it. The name is one of `CLIPS`; another raises `ConfigError`.

    Example:
        >>> power = clip_power("tone", AudioConfig())
        >>> power.shape, round(float(power[0].sum()), 3), int(power[0].argmax())
        ((2000, 7), 0.01, 3)
    """
    samples, size = clip_samples(name, config), config.bin_samples
    gains = np.sqrt(octave_gains(np.fft.rfftfreq(len(samples), 1 / config.sample_rate)))  # energies of octaves add up
    bands = np.fft.irfft(np.fft.rfft(samples) * gains, len(samples))
    count = len(samples) // size
    power = np.mean(bands[:, : count * size].reshape(len(BANDS), count, size) ** 2, axis=-1)
    return np.ascontiguousarray(power.T, np.float32)


def _left_ear_leads(direction: Float[Array, "n 3"], listener: Listener, config: AudioConfig) -> Float[Array, " n"]:
    """Return the lead of the left ear [s], negative if the right is first, by world direction; 0 unless `Binaural`."""
    if not isinstance(config.receiver, Binaural):
        return jnp.zeros(direction.shape[0], jnp.float32)
    if listener.head is not None:
        delay = interpolate_directions(listener.head.delay, world_to_head(direction, listener.quat))
        return delay[:, 1] - delay[:, 0]
    table = ear_table(HRTF_TAPS, config.sample_rate, config.receiver.head_radius, config.speed_of_sound)
    _, delay = ear_spectrum(table, ear_angles(world_to_head(direction, listener.quat), config.receiver.ear_angle))
    return delay[:, 1] - delay[:, 0]
