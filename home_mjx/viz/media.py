"""PNG, WAV and MP4 files."""

import subprocess
import wave
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from home_mjx.errors import HomeMjxError


def write_png(path: Path, image: UInt8[np.ndarray, "h w 3"]) -> None:
    """Writes a picture."""
    Image.fromarray(image).save(path)


def write_wav(path: Path, samples: Float[np.ndarray, "2 n"], sample_rate: int) -> float:
    """Writes stereo sound as 16 bit PCM, scaled so that its peak is 0.9.

    Returns:
        The gain that was applied.
    """
    gain = 0.9 / max(float(np.abs(samples).max()), 1e-9)
    pcm = np.round(samples.T * gain * 32767).astype("<i2")
    with wave.open(str(path), "wb") as out:
        out.setnchannels(2)
        out.setsampwidth(2)
        out.setframerate(sample_rate)
        out.writeframes(pcm.tobytes())
    return gain


def write_mp4(path: Path, frames: UInt8[np.ndarray, "t h w 3"], fps: float, wav: Path | None = None) -> None:
    """Writes a film, with the sound of `wav` if given.

    Raises:
        HomeMjxError: ffmpeg failed; the message quotes it.
    """
    _, height, width, _ = frames.shape
    video = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    audio = ["-i", str(wav), "-c:a", "aac", "-b:a", "160k"] if wav else []
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *video, *audio]
    command += ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", str(path)]
    done = subprocess.run(command, input=frames.tobytes(), capture_output=True, check=False)
    if done.returncode != 0:
        raise HomeMjxError(f"ffmpeg could not write the film: {done.stderr.decode(errors='replace')}", file=path)
