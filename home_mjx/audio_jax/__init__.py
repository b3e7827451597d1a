"""Sound: impulse responses by the ray caster, and what two ears hear through them."""

from home_mjx.audio_jax.auralization.response import ear_gains, early_response, impulse_response, late_response
from home_mjx.audio_jax.auralization.sources import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.stream import sound_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import Paths, early_paths
from home_mjx.audio_jax.propagation.tracing import Trace, trace

__all__ = [
    "CLIPS",
    "AudioConfig",
    "Paths",
    "Trace",
    "clip_samples",
    "ear_gains",
    "early_paths",
    "early_response",
    "energy_histogram",
    "impulse_response",
    "late_response",
    "sound_frame",
    "trace",
]
