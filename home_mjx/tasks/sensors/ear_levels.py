"""Octave-band levels at both ears of every agent, without a waveform."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.envelope import band_level, clip_power, energy_response
from home_mjx.audio_jax.auralization.spectra import LEAST, MOST
from home_mjx.audio_jax.auralization.stream import loudness
from home_mjx.audio_jax.base.config import EARS, AudioConfig
from home_mjx.audio_jax.contact_sounds.slots import noises_power
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import BANDS
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.status import flags
from home_mjx.tasks.sensors.hearing import (
    are_unheard,
    as_loud_as_drawn,
    clip_names,
    clip_rows,
    hear,
    no_words,
    noises_as_loud_as_drawn,
    spoken,
    with_words,
)
from home_mjx.tasks.sounds.voice import voice_power

LONGEST = 1.0  # [ms], maximum delay between the ears; larger than that of any head
MILLI = 1000.0


class Levels(Pytree):
    """State of `EarLevels`."""

    time: Int[Array, ""]  # [samples], from the episode's start to the frame's
    said: Int[Array, "k a"]  # tokens of the last frames, newest first; -1 none
    power: Float[Array, "a 2 bands"]  # of the last step
    lead: Float[Array, " a"]  # [s], of the left ear
    unheard: Bool[Array, " s"]  # of the sources that play clips, see `are_unheard`


class EarLevels(Sensor):
    """`ear_levels` (14,), `ear_difference` (7,), `ear_delay` (1,): octave-band levels, and interaural cues.

    Levels [dB] of the last step's sound in the octaves from 125 to 8000 Hz, at the left ear and then at the right. 0 dB
    is a pressure of 1 relative to the source's at 1 m; values are clipped to -100 and 100 dB. The difference is left
    minus right [dB]. The delay is the lead of the left ear [ms], averaged over all directions, weighted by their
    energy. For a source behind a wall these are mainly the doors that its sound passes. The rays are those of `audio`,
    so levels agree except for interference; no waveform is computed.
    """

    name = "ear_levels"
    costly = True

    def spec(self, config: EnvConfig) -> Specs:
        """Return all three specs.

        Raises:
            ConfigError: The receiver does not have two ears.
        """
        if config.audio.receiver not in EARS:
            hint = 'Use receiver="binaural" or "omni", or the sensor `log_mel`.'
            raise ConfigError(f"ear_levels needs two ears, not receiver={config.audio.receiver!r}", hint=hint)
        bands, span = len(BANDS), MOST - LEAST
        return {
            "ear_levels": ArraySpec((2 * bands,), "float32", LEAST, MOST, "octaves at the left, then right ear [dB]"),
            "ear_difference": ArraySpec((bands,), "float32", -span, span, "octaves, left less right ear [dB]"),
            "ear_delay": ArraySpec((1,), "float32", -LONGEST, LONGEST, "lead of the left ear [ms]"),
        }

    def init(self, config: EnvConfig) -> Levels:
        """Return a silent state."""
        agents = config.num_agents
        return Levels(
            time=jnp.zeros((), jnp.int32),
            said=no_words(config),
            power=jnp.zeros((agents, 2, len(BANDS)), jnp.float32),
            lead=jnp.zeros(agents, jnp.float32),
            unheard=jnp.zeros(config.num_sources, bool),
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: Levels) -> Levels:
        """Trace energy responses anew and compute the power at both ears."""
        time = jnp.where(snapshot.step == 0, 0, state.time + config.audio.frame)
        said = with_words(snapshot, state.said)
        left = power_given_off(config, snapshot, time)
        if config.speech:
            gain = as_loud_as_drawn(snapshot).gain[:, None, None]
            left = left + gain**2 * voice_power(spoken(snapshot, said), config.audio)
        if snapshot.noises is not None:
            left = jnp.concatenate([left, noises_power(noises_as_loud_as_drawn(snapshot), time, config.audio)])
        envelopes = hear(config, snapshot, energy_response)  # axes (a, e)
        power = jax.vmap(jax.vmap(band_level), (0, None))(envelopes.energy, left)  # (a, e, 2, bands)
        weight = jnp.sum(power, axis=2)
        lead = jnp.sum(weight * envelopes.lead, axis=(1, 2)) / jnp.maximum(jnp.sum(weight, axis=(1, 2)), 1e-30)
        loudest = jnp.max(jnp.sum(envelopes.energy, axis=(2, 3)), axis=-1)  # octave
        return Levels(time, said, jnp.sum(power, axis=1), lead, are_unheard(snapshot, loudest))

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Levels) -> dict[str, Array]:
        """Return levels, difference and delay of the last step."""
        level = jnp.clip(10 * jnp.log10(jnp.maximum(state.power, 1e-12)), LEAST, MOST)
        return {
            "ear_levels": level.reshape(level.shape[0], -1),
            "ear_difference": level[:, 0] - level[:, 1],
            "ear_delay": jnp.clip(state.lead * jnp.float32(MILLI), -LONGEST, LONGEST)[:, None],
        }

    def status(self, config: EnvConfig, snapshot: Snapshot, state: Levels) -> Int[Array, ""]:
        """Return the flag of a clip that plays but reaches no agent."""
        return flags(UNHEARD=state.unheard)


def power_given_off(config: EnvConfig, snapshot: Snapshot, time: Int[Array, ""]) -> Float[Array, "e w bands"]:
    """Return the power that each source emits in a frame and before it, per time bin and octave; see `band_level`.

    Args:
        config: Options.
        snapshot: The environment.
        time: Samples from the start of the episode, and of the clips, to the frame.
    """
    audio, sounds, row = config.audio, as_loud_as_drawn(snapshot), clip_rows(config, snapshot)
    table = jnp.asarray(np.stack([clip_power(name, audio) for name in clip_names(config)]))
    bins = time // audio.bin_samples + jnp.arange(1 - audio.num_bins, _bins_of_frame(audio), dtype=jnp.int32)

    def one(row: Array, gain: Array, every: Array, lasts: Array) -> Array:
        on = loudness(bins * audio.bin_samples + audio.bin_samples // 2, every, lasts, audio.sample_rate)
        played = table[jnp.maximum(row, 0), bins % table.shape[1]]
        return jnp.where(row < 0, 0.0, (gain * on)[:, None] ** 2 * played)

    return jax.vmap(one)(row, sounds.gain, sounds.every, sounds.lasts)


def _bins_of_frame(audio: AudioConfig) -> int:
    return max(round(audio.frame / audio.bin_samples), 1)
