"""Octave-band levels at both ears of every agent, without a waveform."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.convolution import schedule_gain
from home_mjx.audio_jax.auralization.envelope import clip_power, energy_envelope, mean_band_power
from home_mjx.audio_jax.auralization.features import MAX_MEL_LEVEL, MIN_MEL_LEVEL
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Binaural, Omni
from home_mjx.audio_jax.contact_sounds.sound_slots import emitted_power
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake
from home_mjx.schema.compiled import BANDS
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.status import status_flags
from home_mjx.tasks.sensors.hearing import (
    clip_indices,
    clip_names,
    is_inaudible,
    scale_contact_sounds,
    scale_sounds,
    select_bakes,
    silent_history,
    source_tokens,
    trace_responses,
    update_history,
)
from home_mjx.tasks.sounds.word_sounds import voice_power

MAX_EAR_DELAY = 1.0  # [ms], maximum delay between the ears; larger than that of any head
MS_PER_SECOND = 1000.0

_energy_envelope = jax.jit(energy_envelope, inline=True, static_argnames="config")  # one trace, as in `hearing`


class EarLevelsState(Pytree):
    """State of `EarLevels`."""

    time: Int[Array, ""]  # [samples], from the episode's start to the frame's
    tokens: Int[Array, "k a"]  # tokens of the last frames, newest first; -1 none
    power: Float[Array, "a 2 bands"]  # of the last step
    left_lead: Float[Array, " a"]  # [s], of the left ear
    is_inaudible: Bool[Array, " s"]  # of the sources that play clips, see `is_inaudible`


class EarLevels(Sensor):
    """`ear_levels` (14,), `ear_difference` (7,), `ear_delay` (1,): octave-band levels, and interaural cues.

    Levels [dB] of the last step's sound in the octaves from 125 to 8000 Hz, at the left ear and then at the right. 0 dB
    is a pressure of 1 relative to the source's at 1 m; values are clipped to -100 and 100 dB. The difference is left
    minus right [dB]. The delay is the lead of the left ear [ms], averaged over all directions, weighted by their
    energy. For a source behind a wall these are mainly the doors that its sound passes. The rays are those of `audio`,
    so levels agree except for interference; no waveform is computed.
    """

    name = "ear_levels"
    casts_rays = True

    def spec(self, config: EnvConfig) -> Specs:
        """Return the specs of `ear_levels`, `ear_difference` and `ear_delay` by name.

        Raises:
            ConfigError: The receiver does not have two ears.
        """
        if not isinstance(config.audio.receiver, Binaural | Omni):
            hint = 'Use receiver="binaural" or "omni", or the sensor `log_mel`.'
            raise ConfigError(f"ear_levels needs two ears, not receiver={config.audio.receiver}", hint=hint)
        bands, span = len(BANDS), MAX_MEL_LEVEL - MIN_MEL_LEVEL
        return {
            "ear_levels": ArraySpec(
                (2 * bands,), "float32", MIN_MEL_LEVEL, MAX_MEL_LEVEL, "octaves at the left, then right ear [dB]"
            ),
            "ear_difference": ArraySpec((bands,), "float32", -span, span, "octaves, left less right ear [dB]"),
            "ear_delay": ArraySpec((1,), "float32", -MAX_EAR_DELAY, MAX_EAR_DELAY, "lead of the left ear [ms]"),
        }

    def bakes(self, config: EnvConfig) -> tuple[Bake, ...]:
        """Return the bake of late reverberation if `audio.late` is `Baked`; else none."""
        return select_bakes(config)

    def init(self, config: EnvConfig) -> EarLevelsState:
        """Return the state before the first step: power, lead and time are 0, no word was said."""
        agents = config.num_agents
        return EarLevelsState(
            time=jnp.zeros((), jnp.int32),
            tokens=silent_history(config),
            power=jnp.zeros((agents, 2, len(BANDS)), jnp.float32),
            left_lead=jnp.zeros(agents, jnp.float32),
            is_inaudible=jnp.zeros(config.num_sources, bool),
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: EarLevelsState) -> EarLevelsState:
        """Return the state after a step: energy responses traced anew, and the power that they yield at both ears.

        A reset clears time and words. The lead is 0 without power.
        """
        time = jnp.where(snapshot.step == 0, 0, state.time + config.audio.frame)
        said = update_history(snapshot, state.tokens)
        left = source_power(config, snapshot, time)
        if config.speech:
            gain = scale_sounds(snapshot).gain[:, None, None]
            left = left + gain**2 * voice_power(source_tokens(snapshot, said), config.audio)
        if snapshot.contact_sounds is not None:
            left = jnp.concatenate([left, emitted_power(scale_contact_sounds(snapshot), time, config.audio)])
        envelopes = trace_responses(config, snapshot, _energy_envelope)  # axes (a, e)
        power = jax.vmap(jax.vmap(mean_band_power), (0, None))(envelopes.energy, left)  # (a, e, 2, bands)
        weight = jnp.sum(power, axis=2)
        lead = jnp.sum(weight * envelopes.left_ear_lead, axis=(1, 2)) / jnp.maximum(jnp.sum(weight, axis=(1, 2)), 1e-30)
        loudest = jnp.max(jnp.sum(envelopes.energy, axis=(2, 3)), axis=-1)  # octave
        return EarLevelsState(time, said, jnp.sum(power, axis=1), lead, is_inaudible(snapshot, loudest))

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: EarLevelsState) -> dict[str, Array]:
        """Return `ear_levels`, `ear_difference` [dB], `ear_delay` [ms] of the last step, with a leading agent axis."""
        level = jnp.clip(10 * jnp.log10(jnp.maximum(state.power, 1e-12)), MIN_MEL_LEVEL, MAX_MEL_LEVEL)
        return {
            "ear_levels": level.reshape(level.shape[0], -1),
            "ear_difference": level[:, 0] - level[:, 1],
            "ear_delay": jnp.clip(state.left_lead * jnp.float32(MS_PER_SECOND), -MAX_EAR_DELAY, MAX_EAR_DELAY)[:, None],
        }

    def status(self, config: EnvConfig, snapshot: Snapshot, state: EarLevelsState) -> Int[Array, ""]:
        """Return the flag `UNHEARD` if a clip plays but reaches no agent; else 0."""
        return status_flags(UNHEARD=state.is_inaudible)


def source_power(config: EnvConfig, snapshot: Snapshot, time: Int[Array, ""]) -> Float[Array, "e w bands"]:
    """Return the power that each source of clips emits, per time bin and octave, as `mean_band_power` takes it.

    The w bins are those of the frame that begins `time` samples after the start of the episode, and the `num_bins` - 1
    before; 0 where the source is silent or pauses.
    """
    audio, sounds, row = config.audio, scale_sounds(snapshot), clip_indices(config, snapshot)
    table = jnp.asarray(np.stack([clip_power(name, audio) for name in clip_names(config)]))
    bins = time // audio.bin_samples + jnp.arange(1 - audio.num_bins, _num_frame_bins(audio), dtype=jnp.int32)

    def one(row: Array, gain: Array, every: Array, lasts: Array) -> Array:
        """Return the power of one source, by bin and octave."""
        on = schedule_gain(bins * audio.bin_samples + audio.bin_samples // 2, every, lasts, audio.sample_rate)
        played = table[jnp.maximum(row, 0), bins % table.shape[1]]
        return jnp.where(row < 0, 0.0, (gain * on)[:, None] ** 2 * played)

    return jax.vmap(one)(row, sounds.gain, sounds.period, sounds.duration)


def _num_frame_bins(audio: AudioConfig) -> int:
    """Return the number of time bins of a frame, rounded, at least 1."""
    return max(round(audio.frame / audio.bin_samples), 1)
