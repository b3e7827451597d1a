"""Words as sounds: one chord per word, which can be decoded despite reverberation and attenuation by walls.

As in telephone signalling (DTMF, ITU-T Q.23), a sign is several simultaneous sines, one of each group of frequencies.
It is decoded from which tone of each group is present, at any level. Equal steps on the mel scale (O'Shaughnessy,
"Speech Communication", 1987) put each tone into a band of its own in `log_mel`.
"""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.auralization.clips import CLIP_RMS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.errors import ConfigError

NUM_GROUPS, NUM_CHOICES = 6, 4  # groups of tones, the last a check digit; tones of each group
MIN_FREQUENCY, MAX_FREQUENCY = 300.0, 3600.0  # [Hz] frequencies of the lowest and the highest tone
WORD_SECONDS = 0.2  # [s] duration of a word
FADE_SECONDS = 0.01  # [s] duration of fade-in and fade-out
NO_WORD = -1  # token if no word is said


def word_tones(token: Int[Array, "*n"]) -> Int[Array, "*n groups"]:
    """Return the indices of a word's tones, one of each group; any two words differ in at least two of them.

    They are the base-4 digits of its token, the last one first, and a check digit that makes their sum a multiple of 4.
    Tokens are from 0 to 4^5 - 1; further digits are dropped.

    Example:
        >>> word_tones(jnp.array([0, 1, 27])).tolist()
        [[0, 4, 8, 12, 16, 20], [1, 4, 8, 12, 16, 23], [3, 6, 9, 12, 16, 22]]
    """
    digits = (token[..., None] // NUM_CHOICES ** jnp.arange(NUM_GROUPS - 1)) % NUM_CHOICES
    check = -jnp.sum(digits, axis=-1, keepdims=True) % NUM_CHOICES
    return jnp.concatenate([digits, check], axis=-1) + NUM_CHOICES * jnp.arange(NUM_GROUPS)


def synthesize_word(token: Int[Array, ""], config: AudioConfig) -> Float[Array, " n"]:
    """Synthesize a word for `WORD_SECONDS`: pressure at 1 m, with about the RMS of a clip.

    Args:
        token: Token of the word; -1: silence.
        config: Options with the sample rate.

    Raises:
        ConfigError: The sample rate is too low for the highest tone.

    Example:
        >>> synthesize_word(jnp.int32(7), AudioConfig()).shape
        (3200,)
    """
    sound = jnp.sum(jnp.asarray(_tones(config.sample_rate))[word_tones(token)], axis=0)
    return jnp.where(token < 0, 0.0, sound)


def num_audible_frames(config: AudioConfig) -> int:
    """Return the number of frames, including this one, whose words this frame may contain: word plus response length.

    Example:
        >>> num_audible_frames(AudioConfig())
        7
    """
    window = config.memory_length - 1 + _word_samples(config.sample_rate)
    return 1 + (window - 1) // config.frame


def synthesize_voices(said: Int[Array, "k e"], config: AudioConfig) -> Float[Array, "e w"]:
    """Synthesize the signals that speakers emit in the past, this frame and the look-ahead, as `emitted_signal` does.

    A word begins with the frame in which it is said. Words that a speaker says before the last one has ended overlap.

    Args:
        said: Tokens of e speakers in this frame (row 0) and in the `num_audible_frames` - 1 before; -1 if none.
        config: Options with the lengths of frame and memory.

    Example:
        >>> config = AudioConfig()
        >>> said = jnp.full((num_audible_frames(config), 1), -1).at[0, 0].set(7)
        >>> spoken = synthesize_voices(said, config)
        >>> spoken.shape, bool(jnp.any(spoken[:, : config.memory_length - 1]))
        ((1, 9599), False)
    """
    past, length, frame = config.memory_length - 1, _word_samples(config.sample_rate), config.frame
    words = jax.vmap(jax.vmap(lambda token: synthesize_word(token, config)))(said)
    whole = jnp.zeros((said.shape[1], length + past + frame + length), jnp.float32)
    for ago in range(said.shape[0]):
        begin = length + past - ago * frame
        whole = whole.at[:, begin : begin + length].add(words[ago])
    return whole[:, length : length + past + frame + config.num_lookahead]


def voice_power(said: Int[Array, "k e"], config: AudioConfig) -> Float[Array, "e w bands"]:
    """Return the power of the signals of `synthesize_voices` per time bin and octave, see `mean_band_power`."""
    frame, past = round(config.frame / config.bin_samples), config.num_bins - 1
    length = round(WORD_SECONDS / config.bin_seconds)
    of_tone = jnp.asarray(CLIP_RMS**2 / NUM_GROUPS * octave_gains(tone_frequencies()).T ** 2, jnp.float32)
    of_word = jnp.where(said[..., None] < 0, 0.0, jnp.sum(of_tone[word_tones(said)], axis=-2))
    bins = jnp.arange(past + frame)[None] - past + frame * jnp.arange(said.shape[0])[:, None]
    on = ((bins >= 0) & (bins < length)).astype(jnp.float32)
    return jnp.einsum("kw,keb->ewb", on, of_word, precision="highest")


@functools.cache
def _tones(sample_rate: int) -> Float[np.ndarray, "tones n"]:
    """Synthesize all tones, faded, each a sixth of a chord's power; `ConfigError` if the sample rate is too low."""
    if sample_rate <= 2 * MAX_FREQUENCY:
        raise ConfigError(
            f"words have tones up to {MAX_FREQUENCY:g} Hz, but the sample rate is {sample_rate} Hz",
            hint=f"Give a sample rate above {2 * MAX_FREQUENCY:g} Hz.",
        )
    time = np.arange(_word_samples(sample_rate)) / sample_rate
    soft = np.clip(np.minimum(time, WORD_SECONDS - time) / FADE_SECONDS, 0, 1)
    group = np.arange(NUM_GROUPS * NUM_CHOICES) // NUM_CHOICES
    phase = -math.pi * group * (group + 1) / NUM_GROUPS  # low crest factor: Schroeder, IEEE Trans. IT 16 (1970)
    sines = np.sin(2 * np.pi * tone_frequencies()[:, None] * time + phase[:, None])
    tones = (CLIP_RMS * math.sqrt(2 / NUM_GROUPS) * soft * sines).astype(np.float32)
    tones.flags.writeable = False
    return tones


def tone_frequencies() -> Float[np.ndarray, " tones"]:
    """Return the frequencies of all tones [Hz], ascending and thus group by group, in equal steps on the mel scale.

    Example:
        >>> tone_frequencies()[[0, -1]].round(6).tolist()
        [300.0, 3600.0]
    """
    low, high = (1127 * math.log1p(f / 700) for f in (MIN_FREQUENCY, MAX_FREQUENCY))
    return 700 * np.expm1(np.linspace(low, high, NUM_GROUPS * NUM_CHOICES) / 1127)


def _word_samples(sample_rate: int) -> int:
    """Return the number of samples of a word."""
    return round(WORD_SECONDS * sample_rate)
