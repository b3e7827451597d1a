"""What both ears of every agent hear, and spectra of it."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.spectra import LEAST, MOST, NUM_MELS, log_mel, spectrum_shape, stft_magnitude
from home_mjx.audio_jax.auralization.stream import faded_frame, given_off
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Sounds, Source
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import camera_quat
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.keys import SOUND, fold
from home_mjx.tasks.base.pose import over_agents
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.status import flags
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position

LOUDEST = 1e6  # [pressure re the source at 1 m]: no sound is louder
FALL = 1e-3  # -30 dB


class Heard(Pytree):
    """What hearing remembers; responses of L samples to each of E sources, frames of M."""

    phase: Int[Array, ""]  # [samples], position in the clips at the frame's start
    time: Int[Array, ""]  # [samples], from the episode's start to the frame's
    response: Float[Array, "a e 2 l"]  # impulse response per ear at the frame's end
    frame: Float[Array, "a 2 m"]  # the last step's sound


class Hearing(Sensor):
    """`audio` (2, M) float32: left and right ear, pressure relative to the source's at 1 m."""

    name = "audio"
    costly = True

    def spec(self, config: EnvConfig) -> Specs:
        """One frame of stereo sound."""
        text = "left and right ear, pressure relative to the source's at 1 m"
        return {"audio": ArraySpec((2, config.audio.frame), "float32", -LOUDEST, LOUDEST, text)}

    def init(self, config: EnvConfig) -> Heard:
        """Silence."""
        agents, audio = config.num_agents, config.audio
        return Heard(
            phase=jnp.zeros((), jnp.int32),
            time=jnp.zeros((), jnp.int32),
            response=jnp.zeros((agents, config.num_sources, 2, audio.response_length), jnp.float32),
            frame=jnp.zeros((agents, 2, audio.frame), jnp.float32),
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> Heard:
        """Traces the responses anew and fades to them from the last ones, within the frame."""
        clips, row = playable(config, snapshot)
        first, frame = snapshot.step == 0, config.audio.frame
        phase = jnp.where(first, 0, (state.phase + frame) % clips.shape[1])
        time = jnp.where(first, 0, state.time + frame)
        response = hear(config, snapshot)
        before = jnp.where(first, response, state.response)
        left = given_off(clips, _as_loud_as_drawn(snapshot), row, phase, time, config.audio)

        def of_all(old: Float[Array, "e 2 l"], new: Float[Array, "e 2 l"]) -> Float[Array, "2 m"]:
            return jnp.sum(jax.vmap(lambda s, a, b: faded_frame(s, a, b, config.audio))(left, old, new), axis=0)

        return Heard(phase=phase, time=time, response=response, frame=jax.vmap(of_all)(before, response))

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> dict[str, Array]:
        """The last step's frame."""
        return {"audio": state.frame}

    def status(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> Int[Array, ""]:
        """Whether a response to something that plays was cut off."""
        cut = jax.vmap(jax.vmap(lambda r: is_cut(r, config.audio)))(state.response)
        return flags(RESPONSE_CUT=cut & (snapshot.sounds.clip >= 0)[None])


class Stft(Sensor):
    """`stft` (2, windows, frequencies): magnitudes of the short-time Fourier transform of both ears' sound.

    Of each frame alone, see `audio_jax.stft_magnitude`: 25 ms every 10 ms, so (2, 8, 257) at the default clock;
    pressure relative to the source's at 1 m.
    """

    name = "stft"
    costly = True
    keeper = Hearing()

    def spec(self, config: EnvConfig) -> Specs:
        """Of both ears."""
        shape = spectrum_shape(config.audio.frame, config.audio.sample_rate)
        return {
            "stft": ArraySpec((2, *shape), "float32", 0.0, text="ear, window, frequency: magnitude of the pressure")
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> dict[str, Array]:
        """Of the last step's frame."""
        return {"stft": stft_magnitude(state.frame, config.audio.sample_rate)}


class LogMel(Sensor):
    """`log_mel` (2, windows, 40): power of both ears' sound in bands that are equally wide to the ear [dB].

    Of each frame alone, see `audio_jax.log_mel`: (2, 8, 40) at the default clock; 0 dB is a pressure of 1 relative to
    the source's at 1 m; clipped to -100 and 100 dB.
    """

    name = "log_mel"
    costly = True
    keeper = Stft.keeper

    def spec(self, config: EnvConfig) -> Specs:
        """Of both ears."""
        windows, _ = spectrum_shape(config.audio.frame, config.audio.sample_rate)
        return {
            "log_mel": ArraySpec((2, windows, NUM_MELS), "float32", LEAST, MOST, "ear, window, mel band: power [dB]")
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> dict[str, Array]:
        """Of the last step's frame."""
        rate = config.audio.sample_rate
        return {"log_mel": log_mel(stft_magnitude(state.frame, rate), rate)}


def _as_loud_as_drawn(snapshot: Snapshot) -> Sounds:
    sounds, drawn = snapshot.sounds, snapshot.drawn
    return sounds if drawn is None or drawn.volume is None else sounds.replace(gain=sounds.gain * drawn.volume)


def playable(config: EnvConfig, snapshot: Snapshot) -> tuple[Float[Array, "c n"], Int[Array, " e"]]:
    """All clips that an environment may play, and which of them each source plays; -1 silence."""
    names = tuple(dict.fromkeys((config.clip, *config.clips)))
    row = jnp.array([names.index(name) if name in names else -1 for name in CLIPS], jnp.int32)
    clip = snapshot.sounds.clip
    table = np.stack([clip_samples(name, config.audio) for name in names])
    return jnp.asarray(table), jnp.where(clip < 0, -1, row[jnp.maximum(clip, 0)])


def hear(config: EnvConfig, snapshot: Snapshot) -> Float[Array, "a e 2 l"]:
    """Impulse responses from all sources to both ears of every agent."""
    pose, num_agents, sounds = snapshot.pose, config.num_agents, snapshot.sounds
    # One key per episode, not per step: successive responses stay coherent, so the tail does not flutter.
    keys = jax.random.split(fold(snapshot.key, SOUND), num_agents)

    def one(ears: Array, quat: Array, key: Array, own: Array) -> Array:
        listener, number = Listener(ears, quat, body=own), config.num_sources
        each = key[None] if number == 1 else jax.random.split(key, number)

        def from_source(pos: Array, body: Array, key: Array) -> Array:
            return impulse_response(snapshot.scene, Source(pos, body), listener, key, config.audio)

        return over_agents(from_source, sounds.pos, sounds.body, each)

    heads = jax.vmap(camera_quat)(pose.yaw, jnp.zeros_like(pose.pitch))
    return over_agents(one, eye_position(config, pose), heads, keys, agent_ids(snapshot.bank, num_agents))


def is_cut(response: Float[Array, "2 l"], config: AudioConfig) -> Bool[Array, ""]:
    """Whether a response ends before it has fallen by 30 dB from its loudest bin."""
    energy = jnp.sum(response.reshape(2, config.num_bins, config.bin_samples) ** 2, axis=(0, 2))
    return energy[-1] > FALL * jnp.max(energy)
