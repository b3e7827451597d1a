"""Recordings as clips: what is read, what is resampled and said, and what is refused."""

import logging
import subprocess

import imageio_ffmpeg
import numpy as np
import pytest
from scipy.io import wavfile

from home_mjx.audio_jax import AudioConfig, read_clip
from home_mjx.errors import ConfigError, MissingFileError

CONFIG = AudioConfig()


def tone(rate: int, seconds: float = 1.0, frequency: float = 440.0) -> np.ndarray:
    return 0.3 * np.sin(2 * np.pi * frequency * np.arange(round(rate * seconds)) / rate)


def test_a_recording_at_our_rate_is_only_scaled(tmp_path, caplog):
    path, samples = tmp_path / "tone.wav", tone(CONFIG.sample_rate).astype(np.float32)
    wavfile.write(path, CONFIG.sample_rate, samples)
    with caplog.at_level(logging.INFO):
        clip = read_clip(path, CONFIG)
    assert clip.dtype == np.float32
    np.testing.assert_allclose(clip, samples * (0.1 / np.sqrt(np.mean(samples**2))), atol=1e-5)
    assert not caplog.records


@pytest.mark.parametrize("kind", ["wav", "flac"])
def test_another_rate_is_resampled_and_said(tmp_path, caplog, kind):
    """44.1 kHz, two channels of 16 bits: the same second of the same tone, one sample of ours apart at most."""
    path, stereo = tmp_path / "tone.wav", np.stack([tone(44100), tone(44100)], axis=1)
    wavfile.write(path, 44100, np.round(stereo * 32767).astype(np.int16))
    if kind == "flac":
        coded = path.with_suffix(".flac")
        subprocess.run([imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", path, coded], check=True)
        path = coded
    clip = read_clip(path, CONFIG)
    assert "resampled from 44100 to 16000 Hz" in caplog.text
    assert abs(len(clip) - CONFIG.sample_rate) <= 1
    inside = slice(200, -200)
    exact = tone(CONFIG.sample_rate)[: len(clip)] / 0.3 * 0.1 * 2**0.5
    np.testing.assert_allclose(clip[inside], exact[: len(clip)][inside], atol=2e-3)


def test_files_that_are_no_sound_are_refused(tmp_path):
    with pytest.raises(MissingFileError, match="no such recording"):
        read_clip(tmp_path / "none.wav", CONFIG)
    path = tmp_path / "words.wav"
    path.write_bytes(b"RIFF no sound at all" * 20)
    with pytest.raises(ConfigError, match=r"cannot be read: .*Use a WAV or FLAC file"):
        read_clip(path, CONFIG)
    path.write_bytes(b"")
    with pytest.raises(ConfigError, match="cannot be read"):
        read_clip(path, CONFIG)


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (np.zeros(4000), "is silent"),
        (np.full(4000, 0.5), "is silent"),
        (np.where(np.arange(4000) == 99, np.nan, tone(16000, 0.25)), "not finite"),
        (np.stack([tone(16000, 0.25), -tone(16000, 0.25)], axis=1), "opposite polarity"),
    ],
    ids=["nothing", "only an offset", "not a number", "channels that cancel out"],
)
def test_signals_that_cannot_sound_are_refused(tmp_path, samples, message):
    path = tmp_path / "clip.wav"
    wavfile.write(path, 16000, samples.astype(np.float32))
    with pytest.raises(ConfigError, match=message):
        read_clip(path, CONFIG)
