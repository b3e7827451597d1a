"""Clips from recordings in any format that ffmpeg reads, such as WAV and FLAC."""

import logging
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.io import wavfile

from home_mjx.audio_jax.auralization.clips import CLIP_RMS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.errors import ConfigError, MissingFileError

MIN_RMS = 1e-5  # minimum RMS re full scale (-100 dB); a recording below it is silent

log = logging.getLogger(__name__)


def read_clip(path: str | Path, config: AudioConfig) -> Float[np.ndarray, " n"]:
    """Read a recording as a clip: float32, one channel, zero mean, RMS 0.1, as from `clip_samples`.

    Channels are averaged. A file with another sample rate is resampled by a polyphase filter, with a log warning.

    Args:
        path: An audio file: WAV, FLAC, Ogg, MP3 or another format of ffmpeg.
        config: Options; provides the sample rate.

    Raises:
        MissingFileError: The file does not exist.
        ConfigError: The file cannot be decoded, has samples that are not finite, or is silent.

    Example:
        >>> read_clip("kettle.flac", AudioConfig()).shape  # doctest: +SKIP
        (48_000,)
    """
    path = Path(path)
    rate, samples = _decode(path)
    if not np.isfinite(samples).all():
        raise ConfigError("the recording has samples that are not finite", file=path, hint="Export it again.")
    sound = samples.astype(float).reshape(len(samples), -1).mean(axis=1)
    if rate != config.sample_rate:
        from scipy.signal import resample_poly

        log.warning("%s: resampled from %d to %d Hz", path, rate, config.sample_rate)
        common = math.gcd(rate, config.sample_rate)
        sound = resample_poly(sound, config.sample_rate // common, rate // common)
    sound = sound - sound.mean() if sound.size else sound
    level = float(np.sqrt(np.mean(sound**2))) if sound.size else 0.0
    if level < MIN_RMS:
        hint = "Use a recording that is not silent; channels of opposite polarity cancel out."
        raise ConfigError("the recording is silent", file=path, hint=hint)
    return (sound * (CLIP_RMS / level)).astype(np.float32)


def _decode(path: Path) -> tuple[int, Float[np.ndarray, "..."]]:
    """Decode a file with ffmpeg; errors as in `read_clip`.

    Return its rate [Hz] and float32 samples re full scale, (n,) or (n, channels).
    """
    import imageio_ffmpeg  # 68 MB of codecs, which synthetic clips do not need

    if not path.is_file():
        raise MissingFileError("there is no such recording", file=path)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.wav"
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-nostdin", "-v", "error", "-protocol_whitelist", "file"]
        command += ["-i", f"file:{path.absolute()}", "-vn", "-c:a", "pcm_f32le", str(plain)]
        done = subprocess.run(command, capture_output=True, check=False)
        if done.returncode != 0 or not plain.is_file():
            said = done.stderr.decode(errors="replace").strip().splitlines() or ["it has no audio stream"]
            hint = "Use a WAV or FLAC file."
            raise ConfigError(f"the recording cannot be read: {said[-1]}", file=path, hint=hint)
        return wavfile.read(plain)
