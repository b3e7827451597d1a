"""Room acoustics: ray-traced impulse responses, their auralization for several receivers, and ISO 3382 parameters."""

from home_mjx.audio_jax.auralization.envelope import Envelope, band_level, clip_power, energy_response
from home_mjx.audio_jax.auralization.recordings import recorded_clip
from home_mjx.audio_jax.auralization.response import early_response, impulse_response, late_response
from home_mjx.audio_jax.auralization.sources import CLIPS, clip_samples
from home_mjx.audio_jax.auralization.spectra import gcc_leads, gcc_phat, log_mel, stft_magnitude
from home_mjx.audio_jax.auralization.stream import faded_frame, given_off, loudness, sound_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.directivity import Directivity, directivities, first_order, measured_directivity, talker
from home_mjx.audio_jax.base.endpoints import Head, Listener, Sounds, Source, is_indoors
from home_mjx.audio_jax.base.presets import PRESETS, audio_preset
from home_mjx.audio_jax.contact_sounds.options import NoiseConfig
from home_mjx.audio_jax.late_reverb.bake.bake import BakeOptions
from home_mjx.audio_jax.late_reverb.bake.store import LateReverbBake
from home_mjx.audio_jax.late_reverb.lookup.reading import baked_sound
from home_mjx.audio_jax.moving_sources.frame import moving_frame, moving_frames
from home_mjx.audio_jax.moving_sources.reception import Reception, received, reception
from home_mjx.audio_jax.parameters.clarity import c50, c80, centre_time, d50, drr, strength
from home_mjx.audio_jax.parameters.decay import decay_curve, decay_time, edt, t20, t30
from home_mjx.audio_jax.parameters.floor import FloorSound, floor_sound
from home_mjx.audio_jax.parameters.octaves import octave_responses
from home_mjx.audio_jax.parameters.spatial import iacc, lateral_fraction
from home_mjx.audio_jax.parameters.survey import Survey, survey_room
from home_mjx.audio_jax.parameters.table import RoomMeasures, measure_energy, measure_response
from home_mjx.audio_jax.propagation.diffraction import bent_paths
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.mirrored import mirrored_paths
from home_mjx.audio_jax.propagation.paths import PathProducer, Paths, direct_path, reflected_paths
from home_mjx.audio_jax.propagation.surfaces import sound_materials
from home_mjx.audio_jax.propagation.tracing import Trace, trace
from home_mjx.audio_jax.receivers.channels import ambisonic_gains, ear_gains
from home_mjx.audio_jax.receivers.measured import measured_head
from home_mjx.audio_jax.receivers.sofa import read_head

__all__ = [
    "CLIPS",
    "PRESETS",
    "AudioConfig",
    "BakeOptions",
    "Directivity",
    "Envelope",
    "FloorSound",
    "Head",
    "LateReverbBake",
    "Listener",
    "NoiseConfig",
    "PathProducer",
    "Paths",
    "Reception",
    "RoomMeasures",
    "Sounds",
    "Source",
    "Survey",
    "Trace",
    "ambisonic_gains",
    "audio_preset",
    "baked_sound",
    "band_level",
    "bent_paths",
    "c50",
    "c80",
    "centre_time",
    "clip_power",
    "clip_samples",
    "d50",
    "decay_curve",
    "decay_time",
    "direct_path",
    "directivities",
    "drr",
    "ear_gains",
    "early_paths",
    "early_response",
    "edt",
    "energy_histogram",
    "energy_response",
    "faded_frame",
    "first_order",
    "floor_sound",
    "gcc_leads",
    "gcc_phat",
    "given_off",
    "iacc",
    "impulse_response",
    "is_indoors",
    "late_response",
    "lateral_fraction",
    "log_mel",
    "loudness",
    "measure_energy",
    "measure_response",
    "measured_directivity",
    "measured_head",
    "mirrored_paths",
    "moving_frame",
    "moving_frames",
    "octave_responses",
    "read_head",
    "received",
    "reception",
    "recorded_clip",
    "reflected_paths",
    "sound_frame",
    "sound_materials",
    "stft_magnitude",
    "strength",
    "survey_room",
    "t20",
    "t30",
    "talker",
    "trace",
]
