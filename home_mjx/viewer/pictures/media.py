"""PNG, WAV, MP4 and WebM files."""

import subprocess
import wave
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from home_mjx.core.files import convert_write_errors, write_durably
from home_mjx.errors import HomeMjxError

H264 = ("-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18")
VP9 = ("-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-crf", "32", "-b:v", "0", "-cpu-used", "4", "-g", "20")
AAC, OPUS = ("-c:a", "aac", "-b:a", "160k"), ("-c:a", "libopus", "-b:a", "96k")


def write_png(path: Path, image: UInt8[np.ndarray, "h w 3"]) -> None:
    """Write an image as PNG, atomically, over an earlier file; the folder must exist.

    Raises:
        ConfigError: It cannot be written, such as on a full disk; no partial file is left.
    """
    with write_durably(path, "picture") as file:
        Image.fromarray(image).save(file, format="PNG")


def write_wav(path: Path, samples: Float[np.ndarray, "2 n"], sample_rate: int) -> float:
    """Write stereo sound as 16 bit PCM, scaled up or down to a peak of 0.9; return the applied gain.

    Peaks below 1e-9 count as 1e-9, so that silence stays silent. There must be a sample, and the folder.

    Raises:
        ConfigError: It cannot be written, such as on a full disk; no partial file is left.
    """
    gain = 0.9 / max(float(np.abs(samples).max()), 1e-9)
    pcm = np.round(samples.T * gain * 32767).astype("<i2")
    with write_durably(path, "sound") as file, wave.open(file, "wb") as out:
        out.setnchannels(2)
        out.setsampwidth(2)
        out.setframerate(sample_rate)
        out.writeframes(pcm.tobytes())
    return gain


def write_mp4(path: Path, frames: UInt8[np.ndarray, "t h w 3"], fps: float, wav: Path | None = None) -> None:
    """Write an H.264 video of frames with even sides, with the sound of `wav` if it is not None, over an earlier file.

    The film is as long as the longer of frames and sound.

    Raises:
        HomeMjxError: ffmpeg failed, such as on a full disk or for odd sides; the message quotes it. No partial file is
            left.
    """
    _encode(path, frames, fps, H264, () if wav is None else ("-i", str(wav), *AAC))


def write_webm(path: Path, frames: UInt8[np.ndarray, "t h w 3"], fps: float, wav: Path | None = None) -> None:
    """Write a VP9 video with Opus sound, which browsers without licences of H.264 and AAC play as well.

    Arguments, length and errors are those of `write_mp4`.
    """
    _encode(path, frames, fps, VP9, () if wav is None else ("-i", str(wav), *OPUS))


def _encode(
    path: Path, frames: UInt8[np.ndarray, "t h w 3"], fps: float, video: tuple[str, ...], audio: tuple[str, ...]
) -> None:
    """Write a film with ffmpeg's options of its picture and its sound."""
    _, height, width, _ = frames.shape
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-")
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, *audio, *video]
    beside = path.with_name(f".new.{path.name}")  # ffmpeg infers the format from the suffix
    try:
        done = subprocess.run([*command, str(beside)], input=frames.tobytes(), capture_output=True, check=False)
        if done.returncode != 0:
            said = done.stderr.decode(errors="replace").strip() or f"exit code {done.returncode}"
            hint = "If the disk is full, free some space, or choose another folder."
            raise HomeMjxError(f"ffmpeg could not write the film: {said}", file=path, hint=hint)
        with convert_write_errors("film", path):
            beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
