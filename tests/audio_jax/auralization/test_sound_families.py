"""Synthesized kinds of sounds: many, of other kinds in training than held out, all different, none periodic only."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest

from home_mjx.audio_jax.auralization.clips import clip_samples, clip_table
from home_mjx.audio_jax.auralization.held_out_sounds import HELD_OUT_CLIPS
from home_mjx.audio_jax.auralization.training_sounds import TRAINING_CLIPS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.tasks.suite.audio_nav import DISTRACTOR_CLIPS, SPLITS

CONFIG = AudioConfig()
NAMES = (*TRAINING_CLIPS, *HELD_OUT_CLIPS)


def test_training_and_held_out_kinds_are_many_and_disjoint():
    assert len(SPLITS["training"]) >= 100
    assert len(SPLITS["held_out"]) >= 20
    kinds = [{name.rpartition("_")[0] or name for name in SPLITS[split]} for split in ("training", "held_out")]
    assert not kinds[0] & kinds[1]
    assert not set(SPLITS["training"]) & {*SPLITS["held_out"], *DISTRACTOR_CLIPS}
    assert SPLITS["heard"] == ("radio", "ring", "chirp", "knock", "bell", "bursts")
    assert SPLITS["unheard"] == ("speech", "tone", "alarm", "whistle")


def test_no_two_clips_have_the_same_spectrum():
    """The spectra of twelfths of an octave of any two clips differ by more than 0.5 dB RMS, most by more than 12 dB."""
    table = clip_table(NAMES, CONFIG).astype(float)
    power, frequency = np.abs(np.fft.rfft(table)) ** 2, np.fft.rfftfreq(table.shape[1], 1 / 16000)
    edges = np.geomspace(60, 7900, 84)
    place = np.searchsorted(edges, frequency)
    bands = 10 * np.log10(np.stack([power[:, place == i].sum(axis=1) for i in range(1, 84)], axis=1) / 1e4 + 1e-3)
    apart = np.sqrt(np.mean((bands[:, None] - bands[None]) ** 2, axis=-1))[np.triu_indices(len(NAMES), 1)]
    assert apart.min() > 0.5
    assert np.median(apart) > 12


@pytest.mark.parametrize("name", ["engine_0", "wood_3", "plucked_strings_2", "talking_1", "shower_4"])
def test_loops_do_not_repeat_within(name: str):
    """No shift by a quarter of a second or more reproduces a clip."""
    clip = clip_samples(name, CONFIG).astype(float)
    spectrum = np.abs(np.fft.rfft(clip)) ** 2
    correlation = np.fft.irfft(spectrum)
    assert np.max(correlation[4000 : clip.size - 4000]) < 0.9 * correlation[0]


def test_clips_are_the_same_in_another_process():
    digest = hashlib.sha256(clip_samples("drums_1", CONFIG).tobytes()).hexdigest()
    program = (
        "import hashlib; from home_mjx.audio_jax import AudioConfig, clip_samples;"
        "print(hashlib.sha256(clip_samples('drums_1', AudioConfig()).tobytes()).hexdigest())"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == digest
