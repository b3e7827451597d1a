"""Interaural cues of every agent, and the direction and distance of a source as a target of learning."""

import jax.numpy as jnp
from jaxtyping import Array, Bool

from home_mjx.audio_jax.auralization.convolution import schedule_gain
from home_mjx.audio_jax.auralization.interaural import MAX_LAG, NUM_BANDS, NUM_LAGS, interaural_cues
from home_mjx.audio_jax.base.options import Binaural, Omni
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.sensors.cameras import eye_position
from home_mjx.tasks.sensors.hearing import HearingState, Stft

SOURCE_TARGET = "source_target"  # name of the sensor and of its observation, which networks do not read
MAX_SOURCE_DISTANCE = 1000.0  # [m], bound; larger than any house
NUM_SCHEDULE_TIMES = 16  # number of times in a frame at which a source may sound
CUE_SCALES = (50.0, 10.0, MAX_LAG, 1.0)  # [dB], [dB], [s], 1: scales of level, difference, lead and coherence


class Interaural(Sensor):
    """`interaural` (4, bands) and `interaural_correlation` (lags,): cues that hardly depend on the kind of sound.

    Rows are the level of both ears, the level difference (left less right), the lead of the left ear, and the
    coherence, each divided by its scale in `CUE_SCALES`. Computed from the last step's frame, see
    `audio_jax.interaural_cues`; silent bands have cues of 0.
    """

    name = "interaural"
    casts_rays = True
    state_owner = Stft.state_owner

    def spec(self, config: EnvConfig) -> Specs:
        """Return the specs of `interaural` and `interaural_correlation`.

        Raises:
            ConfigError: The receiver does not have two ears.
        """
        if not isinstance(config.audio.receiver, Binaural | Omni):
            hint = 'Use receiver="binaural".'
            raise ConfigError(f"interaural cues need two ears, not receiver={config.audio.receiver}", hint=hint)
        text = "level / 50 dB, left less right / 10 dB, lead of the left ear / 0.9 ms, coherence; by band"
        return {
            "interaural": ArraySpec((4, NUM_BANDS), "float32", -4.0, 4.0, text),
            "interaural_correlation": ArraySpec((NUM_LAGS,), "float32", -1.0, 1.0, "correlation of the ears by lag"),
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: HearingState) -> dict[str, Array]:
        """Return both, with a leading agent axis."""
        cues = interaural_cues(state.frame, config.audio.sample_rate)
        rows = (cues.level, cues.level_difference, cues.time_difference, cues.coherence)
        scaled = [row / jnp.float32(scale) for row, scale in zip(rows, CUE_SCALES, strict=True)]
        return {"interaural": jnp.stack(scaled, axis=-2), "interaural_correlation": cues.correlation}


class SourceTarget(Sensor):
    """`source_target` (4,): where the first sound source is; for losses, as no network reads it.

    Sine and cosine of its azimuth from straight ahead (left positive), its distance from the eyes [m] in a straight
    line, and 1 if it sounds during the last step, else 0.
    """

    name = SOURCE_TARGET

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `source_target`."""
        low, high = (-1.0, -1.0, 0.0, 0.0), (1.0, 1.0, MAX_SOURCE_DISTANCE, 1.0)
        text = "sine and cosine of the azimuth of the first source, its distance [m], 1 if it sounds"
        return {SOURCE_TARGET: ArraySpec((4,), "float32", low, high, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: object) -> dict[str, Array]:
        """Return `source_target` with a leading agent axis."""
        away = snapshot.source - eye_position(config, snapshot.pose)
        azimuth = jnp.arctan2(away[:, 1], away[:, 0]) - snapshot.pose.yaw
        distance = jnp.minimum(jnp.linalg.norm(away, axis=-1), MAX_SOURCE_DISTANCE)
        sounds = jnp.broadcast_to(is_sounding(config, snapshot).astype(jnp.float32), azimuth.shape)
        return {SOURCE_TARGET: jnp.stack([jnp.sin(azimuth), jnp.cos(azimuth), distance, sounds], axis=-1)}


def is_sounding(config: EnvConfig, snapshot: Snapshot) -> Bool[Array, ""]:
    """Return whether the first source plays a clip in the last step's frame, by its schedule; words do not count."""
    sounds, frame = snapshot.sounds, config.audio.frame
    time = snapshot.step * frame + jnp.arange(0, frame, max(frame // NUM_SCHEDULE_TIMES, 1), dtype=jnp.int32)
    on = schedule_gain(time, sounds.period[0], sounds.duration[0], config.audio.sample_rate)
    return (sounds.clip[0] >= 0) & (sounds.gain[0] > 0) & jnp.any(on > 0)
