"""Room acoustics: ray-traced impulse responses, their auralization for several receivers, and ISO 3382 parameters."""

from home_mjx.audio_jax.auralization.envelope import EnergyEnvelope, clip_power, energy_envelope, mean_band_power
from home_mjx.audio_jax.auralization.recordings import read_clip
from home_mjx.audio_jax.auralization.response import early_response, impulse_response, late_response
from home_mjx.audio_jax.auralization.sources import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.spectra import gcc_leads, gcc_phat, log_mel, stft_magnitude
from home_mjx.audio_jax.auralization.stream import convolve_clip_frame, convolve_frame, emitted_signal, schedule_gain
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.directivity import (
    Directivity,
    first_order_directivity,
    stack_directivities,
    tabulated_directivity,
    talker_directivity,
)
from home_mjx.audio_jax.base.endpoints import Listener, MeasuredHead, SoundSource, SoundSources, is_indoors
from home_mjx.audio_jax.base.presets import PRESETS, audio_preset
from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.audio_jax.late_reverb.bake.bake import BakeOptions
from home_mjx.audio_jax.late_reverb.bake.store import LateReverbBake
from home_mjx.audio_jax.late_reverb.lookup.reading import lookup_late_sound
from home_mjx.audio_jax.moving_sources.frame import render_frame, render_frames
from home_mjx.audio_jax.moving_sources.reception import ReceiverState, pack_receiver_state, render_receiver_state
from home_mjx.audio_jax.parameters.clarity import c50, c80, centre_time, d50, drr, strength
from home_mjx.audio_jax.parameters.decay import decay_curve, decay_time, edt, t20, t30
from home_mjx.audio_jax.parameters.floor import FloorSurvey, survey_floor
from home_mjx.audio_jax.parameters.octaves import octave_responses
from home_mjx.audio_jax.parameters.spatial import iacc, lateral_fraction
from home_mjx.audio_jax.parameters.survey import Survey, survey_room
from home_mjx.audio_jax.parameters.table import RoomParameters, measure_energy, measure_response
from home_mjx.audio_jax.propagation.diffraction import diffracted_paths
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.mirrored import image_source_reflections
from home_mjx.audio_jax.propagation.paths import PathProducer, Paths, direct_path, first_order_reflections
from home_mjx.audio_jax.propagation.surfaces import sound_materials
from home_mjx.audio_jax.propagation.tracing import Trace, trace
from home_mjx.audio_jax.receivers.channels import ambisonic_gains, channel_gains
from home_mjx.audio_jax.receivers.measured import make_measured_head
from home_mjx.audio_jax.receivers.sofa import read_head

__all__ = [
    "CLIPS",
    "PRESETS",
    "AudioConfig",
    "BakeOptions",
    "ContactSoundConfig",
    "Directivity",
    "EnergyEnvelope",
    "FloorSurvey",
    "LateReverbBake",
    "Listener",
    "MeasuredHead",
    "PathProducer",
    "Paths",
    "ReceiverState",
    "RoomParameters",
    "SoundSource",
    "SoundSources",
    "Survey",
    "Trace",
    "ambisonic_gains",
    "audio_preset",
    "c50",
    "c80",
    "centre_time",
    "channel_gains",
    "clip_power",
    "clip_samples",
    "convolve_clip_frame",
    "convolve_frame",
    "d50",
    "decay_curve",
    "decay_time",
    "diffracted_paths",
    "direct_path",
    "drr",
    "early_paths",
    "early_response",
    "edt",
    "emitted_signal",
    "energy_envelope",
    "energy_histogram",
    "first_order_directivity",
    "first_order_reflections",
    "gcc_leads",
    "gcc_phat",
    "iacc",
    "image_source_reflections",
    "impulse_response",
    "is_indoors",
    "late_response",
    "lateral_fraction",
    "log_mel",
    "lookup_late_sound",
    "make_measured_head",
    "mean_band_power",
    "measure_energy",
    "measure_response",
    "octave_responses",
    "pack_receiver_state",
    "read_clip",
    "read_head",
    "render_frame",
    "render_frames",
    "render_receiver_state",
    "schedule_gain",
    "sound_materials",
    "stack_directivities",
    "stft_magnitude",
    "strength",
    "survey_floor",
    "survey_room",
    "t20",
    "t30",
    "tabulated_directivity",
    "talker_directivity",
    "trace",
]
