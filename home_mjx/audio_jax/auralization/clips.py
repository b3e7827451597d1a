"""Short seamless loops, synthesized deterministically.

Every clip has an RMS of 0.1, the pressure at 1 m from its source; peaks may exceed 1 close to the source.
"""

import functools
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.auralization.clip_synthesis import HOUSEHOLD_CLIPS
from home_mjx.audio_jax.auralization.held_out_sounds import HELD_OUT_CLIPS
from home_mjx.audio_jax.auralization.training_sounds import TRAINING_CLIPS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.core.checks import check_known

CLIP_RMS = 0.1  # RMS of every clip
CLIP_SECONDS = 8.0
NOTES = (0, 4, 7, 12, 7, 4, 9, 5, 2, 5, 9, 11, 7, 4, 2, -1)  # [semitones above C4], of 0.5 s each
MIDDLE_C = 261.626  # [Hz]
SPEECH_SYLLABLE_RATE = 4  # [Hz], of speech
FORMANTS = ((730, 1090, 2440), (270, 2290, 3010), (300, 870, 2240), (530, 1840, 2480), (570, 840, 2410))  # [Hz], vowels
FORMANT_WIDTH = 120.0  # [Hz]
SPEECH_PITCH = 110.0  # [Hz], of speech


def clip_samples(name: str, config: AudioConfig) -> Float[np.ndarray, " n"]:
    """Return the samples of a clip, float32, to be played in a loop.

    Args:
        name: One of `CLIPS`: "radio" (a melody of harmonic notes), "noise" (pink), "speech" (vowels in the rhythm of
            syllables), "tone" (1 kHz), or one of `clip_synthesis.HOUSEHOLD_CLIPS`, such as "ring", "alarm" or "water",
            of `training_sounds.TRAINING_CLIPS`, such as "engine_0", or of `held_out_sounds.HELD_OUT_CLIPS`.
        config: Options; provides the sample rate.

    Returns:
        Read-only samples of an 8 s loop.

    Raises:
        ConfigError: The name is unknown.

    Example:
        >>> clip_samples("radio", AudioConfig()).shape
        (128000,)
    """
    check_known("clip", [name], CLIPS)
    return _clip(name, config.sample_rate)


@functools.cache
def clip_table(names: tuple[str, ...], config: AudioConfig) -> Float[np.ndarray, "c n"]:
    """Return the samples of several clips, stacked, read-only, cached, so that all traces share one constant.

    Example:
        >>> clip_table(("radio", "tone"), AudioConfig()).shape
        (2, 128000)
    """
    table = np.stack([clip_samples(name, config) for name in names])
    table.flags.writeable = False
    return table


@functools.cache
def _clip(name: str, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Return a clip with zero mean and RMS `CLIP_RMS`, read-only float32, cached; `name` is a valid one."""
    samples = _MAKERS[name](round(CLIP_SECONDS * sample_rate), sample_rate)
    samples = samples - samples.mean()
    samples = (samples * (CLIP_RMS / np.sqrt(np.mean(samples**2)))).astype(np.float32)
    samples.flags.writeable = False
    return samples


def _radio(length: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Synthesize the plucked notes `NOTES`, equally spaced over the loop; each rings on, the last ones into the first.

    They have up to 12 harmonics below 0.45 of the sample rate, the nth of amplitude exp(-(1.5 + n) t) / n.
    """
    song = np.zeros(length)
    time = np.arange(length) / sample_rate
    for index, note in enumerate(NOTES):
        pitch = MIDDLE_C * 2 ** (note / 12)
        harmonics = np.arange(1, int(min(12, 0.45 * sample_rate / pitch)) + 1)
        tone = np.sin(2 * np.pi * pitch * harmonics[:, None] * time) * np.exp(-(1.5 + harmonics[:, None]) * time)
        attack = np.minimum(time / 0.005, 1.0)
        song += np.roll(attack * (tone / harmonics[:, None]).sum(axis=0), index * length // len(NOTES))
    return song


def _noise(length: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Synthesize periodic pink noise above 50 Hz: amplitudes f^-0.5 with random phases."""
    frequency = np.fft.rfftfreq(length, 1 / sample_rate)
    amplitude = np.where(frequency < 50, 0, np.maximum(frequency, 1) ** -0.5)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, amplitude.size)
    return np.fft.irfft(amplitude * np.exp(1j * phase), length)


def _speech(length: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Synthesize a glottal buzz of 110 Hz through the formants of one random vowel per syllable, fading in and out.

    There are 32 syllables, which is four a second in a loop of `CLIP_SECONDS`.
    """
    syllables = round(CLIP_SECONDS * SPEECH_SYLLABLE_RATE)
    vowels = np.random.default_rng(2).integers(len(FORMANTS), size=syllables)
    frequency = np.fft.rfftfreq(length, 1 / sample_rate)
    buzz = (np.arange(length) % (sample_rate / SPEECH_PITCH) < 1).astype(float)
    time = np.arange(length) / length * syllables
    voice = np.zeros(length)
    for vowel, formants in enumerate(FORMANTS):
        gain = sum(1 / (1 + ((frequency - f) / FORMANT_WIDTH) ** 2) for f in formants)
        spoken = vowels[time.astype(int)] == vowel
        voice += np.fft.irfft(np.fft.rfft(buzz) * gain, length) * spoken
    return voice * np.sin(np.pi * time) ** 2


def _tone(length: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Synthesize a sine of 1 kHz."""
    return np.sin(2 * np.pi * 1000 * np.arange(length) / sample_rate)


_MAKERS: dict[str, Callable[[int, int], Float[np.ndarray, " n"]]] = {
    "radio": _radio,
    "noise": _noise,
    "speech": _speech,
    "tone": _tone,
    **HOUSEHOLD_CLIPS,
    **TRAINING_CLIPS,  # after the others, and new ones at the end: task arrays store indices
    **HELD_OUT_CLIPS,
}
CLIPS = tuple(_MAKERS)
