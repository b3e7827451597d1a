"""Room acoustic parameters of ISO 3382 from responses, energies, or one trace of a room."""

from home_mjx.audio_jax.parameters.clarity import c50, c80, centre_time, d50, drr, strength
from home_mjx.audio_jax.parameters.decay import decay_curve, decay_time, edt, t20, t30
from home_mjx.audio_jax.parameters.floor_survey import FloorSurvey, survey_floor
from home_mjx.audio_jax.parameters.parameters import RoomParameters, measure_energy, measure_response, octave_responses
from home_mjx.audio_jax.parameters.room_survey import Survey, survey_room
from home_mjx.audio_jax.parameters.spatial import iacc, lateral_fraction

__all__ = [
    "FloorSurvey",
    "RoomParameters",
    "Survey",
    "c50",
    "c80",
    "centre_time",
    "d50",
    "decay_curve",
    "decay_time",
    "drr",
    "edt",
    "iacc",
    "lateral_fraction",
    "measure_energy",
    "measure_response",
    "octave_responses",
    "strength",
    "survey_floor",
    "survey_room",
    "t20",
    "t30",
]
