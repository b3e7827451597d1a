"""Sound: impulse responses by the ray caster, and what two ears hear through them."""

from home_mjx.audio_jax.config import AudioConfig
from home_mjx.audio_jax.sources import CLIPS, clip_samples
from home_mjx.audio_jax.stream import sound_frame

__all__ = ["CLIPS", "AudioConfig", "clip_samples", "sound_frame"]
