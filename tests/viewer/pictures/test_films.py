"""Films as MP4 and WebM: picture and sound stay together."""

import subprocess

import imageio_ffmpeg
import numpy as np
import pytest

from home_mjx.viewer.pictures import media

FPS, RATE, FLASH = 10, 16_000, 12  # frames per second, samples per second, number of the first bright frame


def decode(path, *options: str) -> bytes:
    """Return the raw output of ffmpeg for a film."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", str(path), *options, "-"]
    return subprocess.run(command, capture_output=True, check=True).stdout


@pytest.mark.parametrize("write", [media.write_mp4, media.write_webm])
def test_a_flash_and_its_tone_are_at_the_same_time(tmp_path, write):
    frames = np.zeros((2 * FPS, 32, 48, 3), np.uint8)
    frames[FLASH:, :, 24:] = 255
    tone = 0.5 * np.sin(2 * np.pi * 500 * np.arange(2 * RATE) / RATE) * (np.arange(2 * RATE) >= FLASH * RATE // FPS)
    media.write_wav(tmp_path / "sound.wav", np.stack([tone, 0 * tone]), RATE)
    path = tmp_path / ("film." + write.__name__.removeprefix("write_"))
    write(path, frames, FPS, tmp_path / "sound.wav")
    seen = np.frombuffer(decode(path, "-f", "rawvideo", "-pix_fmt", "gray"), np.uint8).reshape(-1, 32, 48)
    assert len(seen) == len(frames)
    assert np.abs(seen[:, 4:-4, 28:-4].mean(axis=(1, 2)) - 255 * (np.arange(2 * FPS) >= FLASH)).max() < 12
    assert seen[:, 4:-4, 4:20].max() < 12
    sound = np.frombuffer(decode(path, "-f", "f32le", "-ar", str(RATE), "-ac", "2"), np.float32).reshape(-1, 2)
    first = np.argmax(np.abs(sound[:, 0]) > 0.3) / RATE
    assert first == pytest.approx(FLASH / FPS, abs=0.03)
    assert np.abs(sound[:, 1]).max() < 0.05
    assert [entry.name for entry in tmp_path.iterdir() if entry.name.startswith(".new")] == []
