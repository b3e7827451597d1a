"""Survey of room acoustic parameters between a source and a receiver."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.response import (
    baked_energy,
    combine_early_late,
    late_directivity_gain,
    traced_energy,
)
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Baked, Binaural, NoLate, Omni, Traced
from home_mjx.audio_jax.late_reverb.lookup.lookup import lookup_late_sound
from home_mjx.audio_jax.parameters.parameters import RoomParameters, measure_response, octave_responses
from home_mjx.audio_jax.parameters.spatial import iacc, lateral_fraction
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.propagation.tracing import trace
from home_mjx.audio_jax.receivers.spherical_head import world_to_head
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import is_unit_quat
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

LATERAL_BIN = 0.001  # [s], bin of the histogram for the lateral fraction
SURVEY_CONFIG = AudioConfig(response_seconds=2.0, late=Traced(num_rays=4200, num_bounces=100, octave_rays=True))


class Survey(Pytree):
    """Binaural response with room acoustic parameters per octave band."""

    response: Float[Array, "2 l"]  # pressure at the ears
    parameters: RoomParameters  # of an omnidirectional microphone at the centre of the head
    iacc: Float[Array, " bands"]  # of the whole response
    lateral_fraction: Float[Array, " bands"]


def survey_room(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig = SURVEY_CONFIG
) -> Survey:
    """Trace once and compute the parameters of ISO 3382-1 for two ears, an omnidirectional and a lateral microphone.

    The lateral microphone is a figure-of-eight along the axis of the ears. If `config.late` is `Baked`, late sound is
    looked up instead of traced. The default options have enough rays and duration for measurements. Inside `jit`, the
    response is silent if the listener's quaternion is not of unit length.

    Raises:
        ConfigError: The receiver is neither `Binaural` nor `Omni`, or as of `impulse_response`.

    Example:
        >>> found = survey_room(scene, SoundSource(radio), Listener(ears, quat), jax.random.key(0))  # doctest: +SKIP
        >>> found.parameters.t30.shape  # doctest: +SKIP
        (7,)
    """
    if not isinstance(config.receiver, Binaural | Omni):
        raise ConfigError(f"IACC needs two ears, not receiver={config.receiver}", hint="Use Binaural() or Omni().")
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    ears, late = _late_energies(scene, source, listener, trace_key, config)
    ears, late = (jnp.where(is_unit_quat(listener.quat), x, 0.0) for x in (ears, late))  # as of `late_energy`
    response = combine_early_late(paths, ears, listener.quat, noise_key, config, listener.head)
    both = jnp.broadcast_to(late[:, :1], late.shape)
    pressure, _ = combine_early_late(paths, both, listener.quat, noise_key, replace(config, receiver=Omni()))
    rate = config.sample_rate
    energy = _fine_histogram(paths, jnp.ones(paths.distance.shape, jnp.float32), late[:, 0], config)
    lateral = _fine_histogram(paths, _lateral_gain(paths.direction, listener.quat), late[:, 1], config)
    return Survey(
        response=response,
        parameters=measure_response(pressure, rate),
        iacc=iacc(jnp.moveaxis(octave_responses(response, rate), 1, 0), rate),
        lateral_fraction=lateral_fraction(lateral.T, energy.T, config.bin_seconds / _steps_per_bin(config)),
    )


def _late_energies(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> tuple[Float[Array, "k 2 bands"], Float[Array, "k 2 bands"]]:
    """Return late energies per bin of the two ears, and of an omnidirectional and a figure-of-eight microphone."""
    if isinstance(config.late, NoLate):
        nothing = jnp.zeros((config.num_bins, 2, len(BANDS)), jnp.float32)
        return nothing, nothing
    if isinstance(config.late, Baked):
        ears, _ = baked_energy(scene, source, listener, config)
        found = lookup_late_sound(scene, source.pos, listener.pos, config)
        found = found.replace(energy=found.energy * late_directivity_gain(source, found))
        length = jnp.linalg.norm(found.arrival_direction, axis=1)
        toward = found.arrival_direction / jnp.maximum(length, 1e-6)[:, None]
        sides = (1 - length) / 3 + length * _lateral_gain(toward, listener.quat)  # 1/3 for the isotropic part
        share = jnp.matmul(found.span_share, sides, precision="highest")[:, None]
        return ears, jnp.stack([found.energy, found.energy * share], axis=1)
    traced = trace(scene, source, listener, key, config)
    sides = _lateral_gain(traced.direction, listener.quat)
    gains = jnp.broadcast_to(jnp.stack([jnp.ones_like(sides), sides], axis=1)[..., None], (*sides.shape, 2, 7))
    ears = traced_energy(traced, listener.quat, config, listener.head)
    return ears, energy_histogram(traced, gains, config)


def _lateral_gain(direction: Float[Array, "n 3"], quat: Float[Array, "4"]) -> Float[Array, " n"]:
    """Return the energy gain, squared cosine, of a figure-of-eight microphone along the ear axis; world directions."""
    return world_to_head(direction, quat)[:, 0] ** 2


def _fine_histogram(
    paths: Paths, gain: Float[Array, " p"], late: Float[Array, "k bands"], config: AudioConfig
) -> Float[Array, "m bands"]:
    """Return energies in bins of about 1 ms: of paths times the energy gain `gain`, plus late ones, spread evenly.

    Paths beyond the last bin are dropped.
    """
    parts = _steps_per_bin(config)
    energy = jnp.repeat(late / parts, parts, axis=0)
    at = (paths.distance / jnp.float32(config.bin_seconds / parts * config.speed_of_sound)).astype(jnp.int32)
    return energy.at[at].add(gain[:, None] * paths.gain**2, mode="drop")


def _steps_per_bin(config: AudioConfig) -> int:
    """Return into how many steps of about `LATERAL_BIN` a time bin is divided, at least 1."""
    return max(round(config.bin_seconds / LATERAL_BIN), 1)
