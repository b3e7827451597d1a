"""What both ears of every agent hear, and spectra of it."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import clip_samples
from home_mjx.audio_jax.auralization.spectra import LEAST, MOST, NUM_MELS, log_mel, spectrum_shape, stft_magnitude
from home_mjx.audio_jax.auralization.stream import sound_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
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
    """What hearing remembers; sound responses of L samples, frames of M."""

    phase: Int[Array, ""]  # [samples], position in the clip at the frame's start
    response: Float[Array, "a 2 l"]  # impulse response per ear at the frame's end
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
            response=jnp.zeros((agents, 2, audio.response_length), jnp.float32),
            frame=jnp.zeros((agents, 2, audio.frame), jnp.float32),
        )

    def update(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> Heard:
        """Traces the response anew and fades to it from the last one, within the frame."""
        clip = jnp.asarray(clip_samples(config.clip, config.audio))
        first = snapshot.step == 0
        phase = jnp.where(first, 0, (state.phase + config.audio.frame) % clip.shape[0])
        response = hear(config, snapshot)
        before = jnp.where(first, response, state.response)
        frame = jax.vmap(lambda a, b: sound_frame(clip, phase, a, b, config.audio))(before, response)
        return Heard(phase=phase, response=response, frame=frame)

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> dict[str, Array]:
        """The last step's frame."""
        return {"audio": state.frame}

    def status(self, config: EnvConfig, snapshot: Snapshot, state: Heard) -> Int[Array, ""]:
        """Whether a response was cut off."""
        return flags(RESPONSE_CUT=jax.vmap(lambda r: is_cut(r, config.audio))(state.response))


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


def hear(config: EnvConfig, snapshot: Snapshot) -> Float[Array, "a 2 l"]:
    """Impulse response from the source to both ears of every agent."""
    pose, num_agents = snapshot.pose, config.num_agents
    # One key per episode, not per step: successive responses stay coherent, so the tail does not flutter.
    keys = jax.random.split(fold(snapshot.key, SOUND), num_agents)

    def one(ears: Array, quat: Array, key: Array, own: Array) -> Array:
        listener = Listener(ears, quat, body=own)
        return impulse_response(snapshot.scene, Source(snapshot.source), listener, key, config.audio)

    heads = jax.vmap(camera_quat)(pose.yaw, jnp.zeros_like(pose.pitch))
    return over_agents(one, eye_position(config, pose), heads, keys, agent_ids(snapshot.bank, num_agents))


def is_cut(response: Float[Array, "2 l"], config: AudioConfig) -> Bool[Array, ""]:
    """Whether a response ends before it has fallen by 30 dB from its loudest bin."""
    energy = jnp.sum(response.reshape(2, config.num_bins, config.bin_samples) ** 2, axis=(0, 2))
    return energy[-1] > FALL * jnp.max(energy)
