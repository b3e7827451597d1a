"""Words as sounds: each is a chord of its own, which reverberation does not blur and walls do not hide.

As in the tones of telephones (ITU-T Q.23) a sign is several sines at once, one of each group, so that it is told by
which one of a group is there, however loud. Equal steps on the mel scale (O'Shaughnessy, "Speech Communication", 1987)
give every tone a band of its own in `log_mel`.
"""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.auralization.sources import LOUDNESS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.errors import ConfigError

NUM_GROUPS, NUM_CHOICES = 6, 4  # of tones, and tones of each
NUM_WORDS = NUM_CHOICES ** (NUM_GROUPS - 1)  # the last group is a check
LOWEST, HIGHEST = 300.0, 3600.0  # [Hz]: of the lowest and the highest tone
WORD_SECONDS = 0.2
SOFT = 0.01  # [s], in which a word begins, and ends
SILENCE = -1  # token of no word


def chord(token: Int[Array, "*n"]) -> Int[Array, "*n groups"]:
    """Numbers of the tones that make up a word, one of each group; any two words differ in at least two of them.

    They are the digits of its token to the base 4, the last one first, and one more that makes their sum a multiple
    of 4.

    Example:
        >>> chord(jnp.array([0, 1, 27])).tolist()
        [[0, 4, 8, 12, 16, 20], [1, 4, 8, 12, 16, 23], [3, 6, 9, 12, 16, 22]]
    """
    digits = (token[..., None] // NUM_CHOICES ** jnp.arange(NUM_GROUPS - 1)) % NUM_CHOICES
    check = -jnp.sum(digits, axis=-1, keepdims=True) % NUM_CHOICES
    return jnp.concatenate([digits, check], axis=-1) + NUM_CHOICES * jnp.arange(NUM_GROUPS)


def word_sound(token: Int[Array, ""], config: AudioConfig) -> Float[Array, " n"]:
    """Pressure at 1 m from who says a word, for `WORD_SECONDS`; its RMS is about that of every clip.

    Args:
        token: Of the word; -1: silence.
        config: For its sample rate.

    Raises:
        ConfigError: The sample rate is too low for the highest tone.

    Example:
        >>> word_sound(jnp.int32(7), AudioConfig()).shape
        (3200,)
    """
    sound = jnp.sum(jnp.asarray(_tones(config.sample_rate))[chord(token)], axis=0)
    return jnp.where(token < 0, 0.0, sound)


def num_remembered(config: AudioConfig) -> int:
    """Frames back to the first one, a word of which may still be heard; this frame counts.

    Example:
        >>> num_remembered(AudioConfig())
        7
    """
    window = config.memory_length - 1 + _length(config.sample_rate)
    return 1 + (window - 1) // config.frame


def voices(said: Int[Array, "k e"], config: AudioConfig) -> Float[Array, "e w"]:
    """What leaves mouths in this frame, and before it for as long as it rings on; as `given_off` for `moving_frame`.

    A word begins with the frame in which it is said. Who speaks again before a word has ended says both at once.

    Args:
        said: Tokens that each of e has said in this frame (row 0) and in `num_remembered` - 1 before; -1 none.
        config: For the lengths.

    Example:
        >>> config = AudioConfig()
        >>> said = jnp.full((num_remembered(config), 1), -1).at[0, 0].set(7)
        >>> spoken = voices(said, config)
        >>> spoken.shape, bool(jnp.any(spoken[:, : config.memory_length - 1]))
        ((1, 9599), False)
    """
    past, length, frame = config.memory_length - 1, _length(config.sample_rate), config.frame
    words = jax.vmap(jax.vmap(lambda token: word_sound(token, config)))(said)
    whole = jnp.zeros((said.shape[1], length + past + frame + length), jnp.float32)
    for ago in range(said.shape[0]):
        begin = length + past - ago * frame
        whole = whole.at[:, begin : begin + length].add(words[ago])
    return whole[:, length : length + past + frame + config.ahead]


def voice_power(said: Int[Array, "k e"], config: AudioConfig) -> Float[Array, "e w bands"]:
    """Power of what `voices` gives, per time bin and octave, as `band_level` takes it.

    Args:
        said: As for `voices`.
        config: For the lengths.
    """
    frame, past = round(config.frame / config.bin_samples), config.num_bins - 1
    length = round(WORD_SECONDS / config.bin_seconds)
    of_tone = jnp.asarray(LOUDNESS**2 / NUM_GROUPS * octave_gains(tone_frequencies()).T ** 2, jnp.float32)
    of_word = jnp.where(said[..., None] < 0, 0.0, jnp.sum(of_tone[chord(said)], axis=-2))
    bins = jnp.arange(past + frame)[None] - past + frame * jnp.arange(said.shape[0])[:, None]
    on = ((bins >= 0) & (bins < length)).astype(jnp.float32)
    return jnp.einsum("kw,keb->ewb", on, of_word, precision="highest")


@functools.cache
def _tones(sample_rate: int) -> Float[np.ndarray, "tones n"]:
    """All tones with soft ends; of those of a chord each has a sixth of its power."""
    if sample_rate <= 2 * HIGHEST:
        raise ConfigError(
            f"words have tones up to {HIGHEST:g} Hz, but the sample rate is {sample_rate} Hz",
            hint=f"Give a sample rate above {2 * HIGHEST:g} Hz.",
        )
    time = np.arange(_length(sample_rate)) / sample_rate
    soft = np.clip(np.minimum(time, WORD_SECONDS - time) / SOFT, 0, 1)
    group = np.arange(NUM_GROUPS * NUM_CHOICES) // NUM_CHOICES
    phase = -math.pi * group * (group + 1) / NUM_GROUPS  # of low peaks: Schroeder, IEEE Trans. IT 16 (1970)
    sines = np.sin(2 * np.pi * tone_frequencies()[:, None] * time + phase[:, None])
    tones = (LOUDNESS * math.sqrt(2 / NUM_GROUPS) * soft * sines).astype(np.float32)
    tones.flags.writeable = False
    return tones


def tone_frequencies() -> Float[np.ndarray, " tones"]:
    """Of all tones [Hz], group by group.

    Example:
        >>> tone_frequencies()[[0, -1]].round(6).tolist()
        [300.0, 3600.0]
    """
    low, high = (1127 * math.log1p(f / 700) for f in (LOWEST, HIGHEST))
    return 700 * np.expm1(np.linspace(low, high, NUM_GROUPS * NUM_CHOICES) / 1127)


def _length(sample_rate: int) -> int:
    return round(WORD_SECONDS * sample_rate)
