"""Sound: impulse responses by the ray caster, and what two ears hear through them."""

from home_mjx.audio_jax.auralization.envelope import Envelope, band_level, clip_power, energy_response
from home_mjx.audio_jax.auralization.response import ear_gains, early_response, impulse_response, late_response
from home_mjx.audio_jax.auralization.schedule import loudness
from home_mjx.audio_jax.auralization.sources import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.spectra import log_mel, stft_magnitude
from home_mjx.audio_jax.auralization.stream import faded_frame, given_off, sound_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Sounds, Source
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.paths import PathProducer, Paths, direct_path, early_paths, reflected_paths
from home_mjx.audio_jax.propagation.tracing import Trace, trace

__all__ = [
    "CLIPS",
    "AudioConfig",
    "Envelope",
    "Listener",
    "PathProducer",
    "Paths",
    "Sounds",
    "Source",
    "Trace",
    "band_level",
    "clip_power",
    "clip_samples",
    "direct_path",
    "ear_gains",
    "early_paths",
    "early_response",
    "energy_histogram",
    "energy_response",
    "faded_frame",
    "given_off",
    "impulse_response",
    "late_response",
    "log_mel",
    "loudness",
    "reflected_paths",
    "sound_frame",
    "stft_magnitude",
    "trace",
]
