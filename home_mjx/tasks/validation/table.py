"""Ranges of the columns of a task bank, shared by the validation of files and of arrays."""

import functools
import operator
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.auralization.sources import CLIPS
from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.communication.talk import NUM_REPLIES
from home_mjx.tasks.language.phrases import COLUMN
from home_mjx.tasks.language.vocabulary import words
from home_mjx.tasks.rules.features import FAR
from home_mjx.tasks.rules.words import FAILURE, NUM_CONDITIONS, NUM_DESCRIPTORS, NUM_STAGES, Feature, Kind, Word
from home_mjx.tasks.sounds.row import VOICED

INF = float("inf")
GREAT = 1e6  # maximum of a reward, a length [m] or a limit of a condition
MOST_AGENTS = 15  # maximum number of agents: bits of the column `told`
SHORT = 2**15 - 1
MEANT = "meant.{}"  # name of a descriptor's column, by word


class Range(NamedTuple):
    """Range of allowed numbers.

    Attributes:
        least: Minimum, inclusive.
        most: Maximum, inclusive.
        whole: Integers only.
        besides: Further allowed values, such as infinity for no limit.

    Example:
        >>> print(Range(0, 3, whole=True))
        a whole number from 0 to 3
        >>> Range(0.0, 3.0, besides=(INF,)).holds(np.array([-1.0, 2.0, np.inf, np.nan])).tolist()
        [False, True, True, False]
    """

    least: float
    most: float
    whole: bool = False
    besides: tuple[float, ...] = ()

    def holds(self, values: Any) -> Any:
        """Return whether a number, or each of an array, is within the range."""
        within = (values >= self.least) & (values <= self.most)
        return functools.reduce(operator.or_, [values == number for number in self.besides], within)

    def __str__(self) -> str:
        """Return the wording for messages."""
        others = "".join(f" or {number:g}" for number in self.besides)
        return f"a {'whole ' if self.whole else ''}number from {self.least:g} to {self.most:g}{others}"


def index_of(count: int, none: bool = True) -> Range:
    """Return the range of indices into `count` items; with `none` it includes -1."""
    return Range(-1 if none else 0, count - 1, whole=True)


@functools.cache
def limits() -> dict[str, Range]:
    """Return the range of each column for any houses and environment; descriptor columns as `meant.<word>`.

    Example:
        >>> print(limits()["reward"])
        a number from -1e+06 to 1e+06
    """
    descriptor, again = index_of(NUM_DESCRIPTORS), Range(0.001, GREAT, besides=(INF,))
    limit, token = Range(-GREAT, GREAT, besides=(-INF, INF)), index_of(len(words()))
    bits = index_of(2**NUM_CONDITIONS)
    meant = {MEANT.format(word.name.lower()): _of_word(word) for word in Word}
    episode = {"house": index_of(2**31, none=False), "start": Range(-FAR, FAR), "yaw": Range(-1000.0, 1000.0)}
    program = {"place": Range(-FAR, FAR, besides=(INF,)), "field": index_of(SHORT + 1), "guide": descriptor}
    program |= {"feature": index_of(len(Feature), none=False), "first": descriptor, "second": descriptor}
    program |= {"agent": index_of(MOST_AGENTS), "least": limit, "most": limit, "needs": bits, "bars": bits}
    program |= {"next": Range(FAILURE, NUM_STAGES - 1, whole=True), "reward": Range(-GREAT, GREAT)}
    sound = {"emitter": descriptor, "towards": descriptor, "clip": Range(VOICED, len(CLIPS) - 1, whole=True)}
    sound |= {"every": again, "lasts": again, "gain": Range(0.0, 1000.0), "speed": Range(0.0, 100.0)}
    talk = {"answer": token, "oracle": token, "ask": Range(0, NUM_REPLIES, whole=True)}
    talk |= {"told": index_of(2**MOST_AGENTS), "tokens": index_of(len(words()), none=False)}
    own = {"task": index_of(SHORT + 1, none=False), "length": Range(0.0, GREAT), "goal": index_of(2**31, none=False)}
    return episode | program | talk | own | meant | {f"sound_{name}": range_ for name, range_ in sound.items()}


def _of_word(word: Word) -> Range:
    if word in COLUMN:
        return index_of(len(vocabularies()[COLUMN[word]]))
    counts = {Word.KIND: len(Kind) - 1, Word.ON: NUM_DESCRIPTORS, Word.IN: NUM_DESCRIPTORS, Word.AGENT: MOST_AGENTS}
    return index_of(counts.get(word, SHORT + 1))


def feature_limits(config: EnvConfig | None = None) -> Float[np.ndarray, "features 2"]:
    """Return the minimum and maximum of each feature.

    Args:
        config: Options of the environment; None: any environment.

    Example:
        >>> feature_limits(EnvConfig(hands=False))[Feature.HELD].tolist()
        [0.0, 0.0]
    """
    found = np.tile([0.0, 1.0], (len(Feature), 1))
    found[Feature.TRUE] = 1.0
    found[[Feature.DISTANCE, Feature.STRAIGHT, Feature.BESIDE], 1] = FAR
    found[Feature.TIME, 1] = INF
    found[Feature.SAID] = -1, len(words()) - 1
    if config is not None:
        found[Feature.HELD, 1] = config.hands
        found[Feature.STOPPED, 1] = config.discrete is not None
        found[Feature.SAID, 1] = found[Feature.SAID, 1] if config.speech else -1
    return found
