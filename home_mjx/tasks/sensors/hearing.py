"""Sound at both ears, or other receivers, of every agent, and spectra of it."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.clips import CLIPS, clip_table
from home_mjx.audio_jax.auralization.convolution import RATE_STEPS, convolve_frame, emitted_signal
from home_mjx.audio_jax.auralization.features import (
    MAX_MEL_LEVEL,
    MIN_MEL_LEVEL,
    NUM_MELS,
    log_mel,
    spectrum_shape,
    stft_magnitude,
)
from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.directivity import Directivity
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, SoundSources
from home_mjx.audio_jax.base.options import Ambisonics, Baked, MicrophoneArray
from home_mjx.audio_jax.contact_sounds.sound_slots import ContactSounds, emitted_signals, has_sound, sound_positions
from home_mjx.audio_jax.late_reverb.bake.field_cache import COARSE_BAKE
from home_mjx.audio_jax.moving_sources.frames import render_frames
from home_mjx.audio_jax.moving_sources.receiver_state import (
    MIN_DECAY_RATIO,
    ReceiverState,
    is_truncated,
    render_receiver_state,
    silent_state,
    white_noise_band_shares,
)
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import camera_quat
from home_mjx.houses.bakes import Bake
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot, map_agents
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.state import SOUND_TAG, fold_key
from home_mjx.tasks.base.status import status_flags
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP_NUMBER
from home_mjx.tasks.sounds.word_sounds import NO_WORD, num_audible_frames, synthesize_voices

MAX_PRESSURE = 1e6  # [pressure re the source at 1 m], bound of the observation
MIN_AUDIBLE_ENERGY = 1e-8  # energy of a response re 1 m below which any clip is under -100 dB, the minimum of levels

# Inline: the program is that of plain calls. A reset, a step and other environments of equal options share one trace.
_inline = functools.partial(jax.jit, inline=True, static_argnames="config")
_render_state, _respond, _render_frames, _convolve = map(
    _inline, (render_receiver_state, impulse_response, render_frames, convolve_frame)
)


class HearingState(Pytree):
    """State of `Hearing`; responses of L samples to each of E sources, frames of M samples."""

    phase: Int[Array, ""]  # [samples], position in the clips at the frame's start
    time: Int[Array, ""]  # [samples], from the episode's start to the frame's
    # At the frame's end: impulse responses per channel, or `ReceiverState` with `AudioConfig.motion`; axes (a, e).
    response: Float[Array, "a e c l"] | ReceiverState
    frame: Float[Array, "a c m"]  # sound of the last step
    tokens: Int[Array, "k a"]  # tokens of the last frames, newest first; -1 none. Empty if no agent can speak


class Hearing(Sensor):
    """`audio` (C, M) float32: left and right ear, or the receiver's channels; pressure re the source's at 1 m."""

    name = "audio"
    casts_rays = True

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `audio` (channels, samples): one frame of sound."""
        text = f"{describe_channels(config)}, pressure relative to the source's at 1 m"
        return {
            "audio": ArraySpec(
                (config.audio.num_channels, config.audio.frame), "float32", -MAX_PRESSURE, MAX_PRESSURE, text
            )
        }

    def bakes(self, config: EnvConfig) -> tuple[Bake, ...]:
        """Return the bake of late reverberation if `audio.late` is `Baked`; else none."""
        return select_bakes(config)

    def init(self, config: EnvConfig) -> HearingState:
        """Return the state before the first step: responses, frames and times are 0, and no word was said."""
        agents, audio = config.num_agents, config.audio
        nothing = (
            silent_state(audio)
            if audio.motion is not None
            else jnp.zeros((audio.num_channels, audio.response_length), jnp.float32)
        )
        return HearingState(
            phase=jnp.zeros((), jnp.int32),
            time=jnp.zeros((), jnp.int32),
            response=jax.tree.map(lambda x: jnp.zeros((agents, config.num_traced_sources, *x.shape), x.dtype), nothing),
            frame=jnp.zeros((agents, audio.num_channels, audio.frame), jnp.float32),
            tokens=silent_history(config),
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> HearingState:
        """Return the state after a step: responses traced anew, and the frame, which cross-fades to them.

        A reset clears times and words, and its frame has the new responses from the start.
        """
        clips, rate = jnp.asarray(clip_table(clip_names(config), config.audio)), playback_rate(snapshot)
        first, frame = snapshot.step == 0, config.audio.frame
        loop = clips.shape[1] * (1 if rate is None else RATE_STEPS)  # then any rate ends where it began
        phase = jnp.where(first, 0, (state.phase + frame) % loop)
        time = jnp.where(first, 0, state.time + frame)
        response = trace_responses(config, snapshot)
        before = jax.tree.map(lambda new, old: jnp.where(first, new, old), response, state.response)
        sounds, said = scale_sounds(snapshot), update_history(snapshot, state.tokens)
        left = emitted_signal(clips, sounds, clip_indices(config, snapshot), phase, time, config.audio, rate)
        if config.speech:
            left = left + sounds.gain[:, None] * synthesize_voices(source_tokens(snapshot, said), config.audio)
        if snapshot.contact_sounds is not None:
            left = jnp.concatenate([left, emitted_signals(scale_contact_sounds(snapshot), time, config.audio)])

        def render_agent(old: Any, new: Any) -> Float[Array, "c m"]:
            """Return one agent's frame, from responses before and after the step."""
            if config.audio.motion is not None:
                return _render_frames(left, old, new, config.audio, snapshot.head)
            return jnp.sum(jax.vmap(lambda s, a, b: _convolve(s, a, b, config.audio))(left, old, new), axis=0)

        return HearingState(
            phase=phase, time=time, response=response, frame=jax.vmap(render_agent)(before, response), tokens=said
        )

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> dict[str, Array]:
        """Return `audio` (a, channels, samples): the last step's frame."""
        return {"audio": state.frame}

    def status(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> Int[Array, ""]:
        """Return flags of truncated responses to active sources, and of clips that reach no agent."""
        cut = jax.vmap(jax.vmap(lambda r: is_response_cut(r, config.audio)))(state.response)
        plays = (snapshot.sounds.clip >= 0) | jnp.any(source_tokens(snapshot, state.tokens) >= 0, axis=0)
        if snapshot.contact_sounds is not None:
            plays = jnp.concatenate([plays, has_sound(snapshot.contact_sounds)])
        energy = jax.vmap(jax.vmap(lambda r: received_energy(r, config.audio)))(state.response)
        return status_flags(RESPONSE_CUT=cut & plays[None], UNHEARD=is_inaudible(snapshot, energy))


def select_bakes(config: EnvConfig) -> tuple[Bake, ...]:
    """Return the bakes that responses read: that of late reverberation if `audio.late` is `Baked`; else none."""
    return (COARSE_BAKE,) if isinstance(config.audio.late, Baked) else ()


class Stft(Sensor):
    """`stft` (C, windows, frequencies): magnitude of the short-time Fourier transform of the sound at both ears.

    Computed from each frame alone, see `audio_jax.stft_magnitude`: 25 ms every 10 ms, so (2, 8, 257) at the default
    timing. Pressure relative to the source's at 1 m.
    """

    name = "stft"
    casts_rays = True
    state_owner = Hearing()

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `stft` (channels, windows, frequencies)."""
        shape = config.audio.num_channels, *spectrum_shape(config.audio.frame, config.audio.sample_rate)
        return {
            "stft": ArraySpec(
                shape,
                "float32",
                0.0,
                text="ear, window, frequency: magnitude of the pressure",
            )
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> dict[str, Array]:
        """Compute `stft` of the last step's frame, with a leading agent axis."""
        return {"stft": stft_magnitude(state.frame, config.audio.sample_rate)}


class LogMel(Sensor):
    """`log_mel` (C, windows, 40): power of the sound at both ears in mel bands [dB].

    Computed from each frame alone, see `audio_jax.log_mel`: (2, 8, 40) at the default timing. 0 dB is a pressure of 1
    relative to the source's at 1 m; values are clipped to -100 and 100 dB.
    """

    name = "log_mel"
    casts_rays = True
    state_owner = Stft.state_owner

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `log_mel` (channels, windows, mel bands)."""
        windows, _ = spectrum_shape(config.audio.frame, config.audio.sample_rate)
        return {
            "log_mel": ArraySpec(
                (config.audio.num_channels, windows, NUM_MELS),
                "float32",
                MIN_MEL_LEVEL,
                MAX_MEL_LEVEL,
                "ear, window, mel band: power [dB]",
            )
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> dict[str, Array]:
        """Compute `log_mel` of the last step's frame [dB], with a leading agent axis."""
        rate = config.audio.sample_rate
        return {"log_mel": log_mel(stft_magnitude(state.frame, rate), rate)}


def describe_channels(config: EnvConfig) -> str:
    """Return the receiver's channels as text: "microphones", "W, Y, Z and X" or "left and right ear"."""
    names = {MicrophoneArray: "microphones", Ambisonics: "W, Y, Z and X"}
    return names.get(type(config.audio.receiver), "left and right ear")


def scale_sounds(snapshot: Snapshot) -> SoundSources:
    """Return the snapshot's sounds with gains times the volume sampled for the episode; unchanged if none was."""
    sounds, drawn = snapshot.sounds, snapshot.variation
    return sounds if drawn is None or drawn.volume is None else sounds.replace(gain=sounds.gain * drawn.volume)


def playback_rate(snapshot: Snapshot) -> Float[Array, ""] | None:
    """Return the playback rate of all clips that was sampled for the episode; None if it does not vary."""
    return None if snapshot.variation is None else snapshot.variation.playback_rate


def equalize_sounds(snapshot: Snapshot) -> SoundSources:
    """Return the snapshot's sounds with the equalizer sampled for the episode, as a directivity; unchanged without one.

    An octave's gain is the same in all directions, so that it costs no filter: paths and late energies have octaves.
    """
    sounds, drawn = snapshot.sounds, snapshot.variation
    if drawn is None or drawn.equalizer is None:
        return sounds
    gain = 10 ** (drawn.equalizer[None, None] / 20)
    if sounds.directivity is not None:
        return sounds.replace(directivity=Directivity.build_unchecked(gain=sounds.directivity.gain * gain))
    number = sounds.pos.shape[0]
    upright = jnp.broadcast_to(jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32), (number, 4))
    uniform = Directivity.build_unchecked(gain=jnp.broadcast_to(gain, (number, 2, gain.shape[-1])))
    return sounds.replace(quat=upright, directivity=uniform)


def scale_contact_sounds(snapshot: Snapshot) -> ContactSounds:
    """Return the snapshot's contact sounds, which must exist, with gains times the volume sampled for the episode."""
    noises, drawn = snapshot.contact_sounds, snapshot.variation
    assert noises is not None
    if drawn is None or drawn.contact_sound_volume is None:
        return noises
    strikes, rubs = (x.replace(gain=x.gain * drawn.contact_sound_volume) for x in (noises.transients, noises.sustained))
    return noises.replace(transients=strikes, sustained=rubs)


def clip_names(config: EnvConfig) -> tuple[str, ...]:
    """Return the names of all clips that an environment may play, each once, `config.clip` first."""
    return tuple(dict.fromkeys((config.clip, *config.clips)))


def clip_indices(config: EnvConfig, snapshot: Snapshot) -> Int[Array, " e"]:
    """Return the index into `clip_names` of each source's clip; -1 for silence, voices and other clips."""
    names, clip = clip_names(config), snapshot.sounds.clip
    row = jnp.array([names.index(name) if name in names else -1 for name in CLIPS], jnp.int32)
    return jnp.where(clip < 0, -1, row[jnp.maximum(clip, 0)])


def silent_history(config: EnvConfig) -> Int[Array, "k a"]:
    """Return a history of tokens, all -1: a row per frame in which a word is audible; no rows if no agent can speak."""
    return jnp.full((num_audible_frames(config.audio) if config.speech else 0, config.num_agents), NO_WORD, jnp.int32)


def update_history(snapshot: Snapshot, said: Int[Array, "k a"]) -> Int[Array, "k a"]:
    """Return a history of spoken tokens with the current ones first, without the oldest; a reset drops earlier ones."""
    before = jnp.where(snapshot.step == 0, NO_WORD, said)
    return jnp.concatenate([snapshot.spoken_token[None], before])[: said.shape[0]]


def source_tokens(snapshot: Snapshot, said: Int[Array, "k a"]) -> Int[Array, "k e"]:
    """Return the history of tokens of each source of clips; -1 unless the source is an agent's voice."""
    agents, sounds = said.shape[1], snapshot.sounds
    number = sounds.body - agent_ids(snapshot.bank, agents)[0]
    speaks = (sounds.clip == VOICE_CLIP_NUMBER) & (number >= 0) & (number < agents)
    return jnp.where(speaks, said[:, jnp.clip(number, 0, agents - 1)], NO_WORD)


def trace_responses(config: EnvConfig, snapshot: Snapshot, response: Callable[..., Any] | None = None) -> Any:
    """Trace from all sources to every agent, with axes (a, e).

    By default the result is the field `response` of `HearingState`; another `response`, a function of scene, source,
    listener, key and options, uses the same rays. The rays' random key is that of the episode, the same in all steps.
    """
    response = response or (_render_state if config.audio.motion is not None else _respond)
    pose, num_agents = snapshot.pose, config.num_agents
    sources = all_sources(snapshot)
    # One key per episode, not per step: successive responses stay coherent, so the tail does not flutter.
    keys = jax.random.split(fold_key(snapshot.key, SOUND_TAG), num_agents)

    def one(ears: Array, quat: Array, key: Array, own: Array) -> Any:
        """Trace from all sources to one agent."""
        listener, number = Listener(ears, quat, own, snapshot.head), sources.pos.shape[0]
        each = key[None] if number == 1 else jax.random.split(key, number)

        def from_source(source: SoundSource, key: Array) -> Any:
            """Trace from one source."""
            return response(snapshot.scene, source, listener, key, config.audio)

        return map_agents(from_source, sources, each)

    heads = jax.vmap(camera_quat)(pose.yaw, pose.pitch)
    return map_agents(one, eye_position(config, pose), heads, keys, agent_ids(snapshot.bank, num_agents))


def all_sources(snapshot: Snapshot) -> SoundSource:
    """Return all sources along a leading axis: first those of clips, then contact sounds, which are omnidirectional."""
    sounds = equalize_sounds(snapshot)
    playing = SoundSource.build_unchecked(
        pos=sounds.pos, body=sounds.body, quat=sounds.quat, directivity=sounds.directivity
    )
    if snapshot.contact_sounds is None:
        return playing
    pos, body = sound_positions(snapshot.contact_sounds)
    quat = directivity = None
    if sounds.quat is not None:
        quat = jnp.zeros((*body.shape, 4), jnp.float32).at[:, 0].set(1.0)
    if sounds.directivity is not None:
        directivity = jax.tree.map(lambda x: jnp.ones((*body.shape, *x.shape[1:]), x.dtype), sounds.directivity)
    noises = SoundSource.build_unchecked(pos=pos, body=body, quat=quat, directivity=directivity)
    return jax.tree.map(lambda *x: jnp.concatenate(x), playing, noises)


def is_response_cut(response: Float[Array, "c l"] | ReceiverState, config: AudioConfig) -> Bool[Array, ""]:
    """Return whether a response ends before its energy per time bin is 30 dB below that of its loudest bin.

    A silent one does not.
    """
    if isinstance(response, ReceiverState):
        return is_truncated(response, config)
    energy = jnp.sum(response.reshape(-1, config.num_bins, config.bin_samples) ** 2, axis=(0, 2))
    return energy[-1] > MIN_DECAY_RATIO * jnp.max(energy)


def received_energy(response: Float[Array, "c l"] | ReceiverState, config: AudioConfig) -> Float[Array, ""]:
    """Return the energy of a response, summed over channels, relative to the direct sound at 1 m in a free field."""
    if not isinstance(response, ReceiverState):
        return jnp.sum(response**2)
    bands = jnp.sum(response.paths.gain**2, axis=0) + jnp.sum(response.energy[:, : config.num_channels], axis=(0, 1))
    return bands @ jnp.asarray(white_noise_band_shares(config))


def is_inaudible(snapshot: Snapshot, energy: Float[Array, "a e"]) -> Bool[Array, " s"]:
    """Return which of the s sources of clips play one that no agent receives.

    Words, appliances and contact sounds do not count. `energy` is that of each response (`received_energy`), with
    sources of clips first; NaN counts as not received.
    """
    clip = snapshot.sounds.clip[: snapshot.config.num_sources]
    return (clip >= 0) & ~jnp.any(energy[:, : clip.size] > MIN_AUDIBLE_ENERGY, axis=0)
