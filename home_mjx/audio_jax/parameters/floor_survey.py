"""Maps of sound strength and reverberation time over a floor, for one source and many receivers."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.response import late_energy
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Omni
from home_mjx.audio_jax.parameters.decay import t30
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.types import Scene

RECEIVERS_PER_BATCH = 16  # receivers per batch
ENERGY_1M_RE_10M = 100.0  # free-field energy at 1 m re that at 10 m


class FloorSurvey(Pytree):
    """Room acoustic parameters at many receivers."""

    strength: Float[Array, "n bands"]  # G [dB], re the same source at 10 m in the free field
    t30: Float[Array, "n bands"]  # [s]; NaN where the decay is too short to be read


def survey_floor(
    scene: Scene, source: SoundSource, positions: Float[Array, "n 3"], key: Array, config: AudioConfig
) -> FloorSurvey:
    """Compute level and reverberation time at many world positions [m] from energies, without a waveform.

    Microphones are omnidirectional, whatever `config.receiver`. All share `key`; it is unused if late sound is baked.
    Energy after `config.response_seconds` does not count for the level, which is -280 dB in silence. Errors are those
    of `impulse_response`.

    Example:
        >>> found = survey_floor(scene, SoundSource(radio), places, jax.random.key(0), config)  # doctest: +SKIP
        >>> found.strength.shape  # doctest: +SKIP
        (612, 7)
    """
    config = replace(config, receiver=Omni())
    metres = config.bin_seconds * config.speed_of_sound
    level = jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32)

    def measure(place: Float[Array, "3"]) -> tuple[Float[Array, " bands"], Float[Array, " bands"]]:
        """Return strength and T30 at one position."""
        listener = Listener(place, level)
        paths = early_paths(scene, source, listener, config)
        late = late_energy(scene, source, listener, key, config)[:, 0]
        energy = late.at[(paths.distance / metres).astype(jnp.int32)].add(paths.gain**2, mode="drop")
        strength = 10 * jnp.log10(ENERGY_1M_RE_10M * jnp.maximum(jnp.sum(energy, axis=0), 1e-30))
        loudest = jnp.maximum(jnp.max(energy), 1e-30)
        return strength, t30(energy.T / loudest, config.bin_seconds)

    strength, times = jax.lax.map(measure, positions, batch_size=RECEIVERS_PER_BATCH)
    return FloorSurvey(strength=strength, t30=times)
