"""Room acoustics: ray-traced and baked impulse responses, and their auralization for several receivers."""

from home_mjx.audio_jax.auralization.clips import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.convolution import convolve_clip_frame, convolve_frame, emitted_signal
from home_mjx.audio_jax.auralization.features import gcc_leads, gcc_phat, log_mel, stft_magnitude
from home_mjx.audio_jax.auralization.recordings import read_clip
from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.directivity import first_order_directivity, tabulated_directivity, talker_directivity
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, SoundSources
from home_mjx.audio_jax.base.options import (
    Air,
    Ambisonics,
    Baked,
    Binaural,
    EarlyPaths,
    MicrophoneArray,
    Motion,
    NoLate,
    Omni,
    Traced,
)
from home_mjx.audio_jax.base.presets import audio_preset
from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.audio_jax.late_reverb.bake.field_cache import LateReverbBake
from home_mjx.audio_jax.late_reverb.bake.options import BakeOptions
from home_mjx.audio_jax.moving_sources.frames import render_frame
from home_mjx.audio_jax.moving_sources.receiver_state import render_receiver_state
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.paths import PathProducer, Paths
from home_mjx.audio_jax.propagation.surfaces import sound_materials
from home_mjx.audio_jax.receivers.sofa import read_head

__all__ = [
    "CLIPS",
    "Air",
    "Ambisonics",
    "AudioConfig",
    "BakeOptions",
    "Baked",
    "Binaural",
    "ContactSoundConfig",
    "EarlyPaths",
    "LateReverbBake",
    "Listener",
    "MicrophoneArray",
    "Motion",
    "NoLate",
    "Omni",
    "PathProducer",
    "Paths",
    "SoundSource",
    "SoundSources",
    "Traced",
    "audio_preset",
    "clip_samples",
    "convolve_clip_frame",
    "convolve_frame",
    "early_paths",
    "emitted_signal",
    "first_order_directivity",
    "gcc_leads",
    "gcc_phat",
    "impulse_response",
    "log_mel",
    "read_clip",
    "read_head",
    "render_frame",
    "render_receiver_state",
    "sound_materials",
    "stft_magnitude",
    "tabulated_directivity",
    "talker_directivity",
]
