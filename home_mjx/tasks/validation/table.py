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
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import all_words
from home_mjx.tasks.rules.features import UNREACHABLE_DISTANCE
from home_mjx.tasks.rules.words import (
    FAILURE,
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_STAGES,
    Attribute,
    Feature,
    TargetKind,
)
from home_mjx.tasks.sounds.row import VOICE_CLIP_NUMBER

INF = float("inf")
MAX_MAGNITUDE = 1e6  # maximum of a reward, a length [m] or a limit of a condition
MAX_AGENTS = 15  # maximum number of agents: bits of the column `instructed_agents`
MAX_INT16 = 2**15 - 1
DESCRIPTOR_COLUMN = "selectors.{}"  # name of a descriptor's column, by word


class Range(NamedTuple):
    """Range of allowed numbers.

    Attributes:
        minimum: Minimum, inclusive.
        maximum: Maximum, inclusive.
        is_integer: Integers only.
        also_allowed: Further allowed values, such as infinity for no limit.

    Example:
        >>> print(Range(0, 3, whole=True))
        a whole number from 0 to 3
        >>> Range(0.0, 3.0, besides=(INF,)).holds(np.array([-1.0, 2.0, np.inf, np.nan])).tolist()
        [False, True, True, False]
    """

    minimum: float
    maximum: float
    is_integer: bool = False
    also_allowed: tuple[float, ...] = ()

    def contains(self, values: Any) -> Any:
        """Return whether a number, or each of an array, is within the range."""
        within = (values >= self.minimum) & (values <= self.maximum)
        return functools.reduce(operator.or_, [values == number for number in self.also_allowed], within)

    def __str__(self) -> str:
        """Return the wording for messages."""
        others = "".join(f" or {number:g}" for number in self.also_allowed)
        return f"a {'whole ' if self.is_integer else ''}number from {self.minimum:g} to {self.maximum:g}{others}"


def index_range(count: int, allow_none: bool = True) -> Range:
    """Return the range of indices into `count` items; with `allow_none` it includes -1."""
    return Range(-1 if allow_none else 0, count - 1, is_integer=True)


@functools.cache
def column_ranges() -> dict[str, Range]:
    """Return the range of each column for any houses and environment; descriptor columns as `selectors.<word>`.

    Example:
        >>> print(limits()["reward"])
        a number from -1e+06 to 1e+06
    """
    descriptor, again = index_range(NUM_DESCRIPTORS), Range(0.001, MAX_MAGNITUDE, also_allowed=(INF,))
    limit, token = Range(-MAX_MAGNITUDE, MAX_MAGNITUDE, also_allowed=(-INF, INF)), index_range(len(all_words()))
    bits = index_range(2**NUM_CONDITIONS)
    meant = {DESCRIPTOR_COLUMN.format(word.name.lower()): _attribute_range(word) for word in Attribute}
    episode = {
        "house": index_range(2**31, allow_none=False),
        "start": Range(-UNREACHABLE_DISTANCE, UNREACHABLE_DISTANCE),
        "yaw": Range(-1000.0, 1000.0),
    }
    program = {
        "place": Range(-UNREACHABLE_DISTANCE, UNREACHABLE_DISTANCE, also_allowed=(INF,)),
        "field": index_range(MAX_INT16 + 1),
        "guide": descriptor,
    }
    program |= {"feature": index_range(len(Feature), allow_none=False), "first": descriptor, "second": descriptor}
    program |= {"agent": index_range(MAX_AGENTS), "minimum": limit, "maximum": limit, "require": bits, "forbid": bits}
    program |= {"next": Range(FAILURE, NUM_STAGES - 1, is_integer=True), "reward": Range(-MAX_MAGNITUDE, MAX_MAGNITUDE)}
    sound = {
        "emitter": descriptor,
        "destination": descriptor,
        "clip": Range(VOICE_CLIP_NUMBER, len(CLIPS) - 1, is_integer=True),
    }
    sound |= {"period": again, "duration": again, "gain": Range(0.0, 1000.0), "speed": Range(0.0, 100.0)}
    talk = {"answer": token, "oracle": token, "num_identifying_questions": Range(0, NUM_REPLIES, is_integer=True)}
    talk |= {"instructed_agents": index_range(2**MAX_AGENTS), "tokens": index_range(len(all_words()), allow_none=False)}
    own = {
        "task": index_range(MAX_INT16 + 1, allow_none=False),
        "length": Range(0.0, MAX_MAGNITUDE),
        "goal": index_range(2**31, allow_none=False),
    }
    return episode | program | talk | own | meant | {f"sound_{name}": range_ for name, range_ in sound.items()}


def _attribute_range(word: Attribute) -> Range:
    if word in SEMANTIC_COLUMN:
        return index_range(len(vocabularies()[SEMANTIC_COLUMN[word]]))
    counts = {
        Attribute.KIND: len(TargetKind) - 1,
        Attribute.ON: NUM_DESCRIPTORS,
        Attribute.IN: NUM_DESCRIPTORS,
        Attribute.AGENT: MAX_AGENTS,
    }
    return index_range(counts.get(word, MAX_INT16 + 1))


def feature_ranges(config: EnvConfig | None = None) -> Float[np.ndarray, "features 2"]:
    """Return the minimum and maximum of each feature.

    Args:
        config: Options of the environment; None: any environment.

    Example:
        >>> feature_limits(EnvConfig(hands=False))[Feature.HELD].tolist()
        [0.0, 0.0]
    """
    found = np.tile([0.0, 1.0], (len(Feature), 1))
    found[Feature.TRUE] = 1.0
    found[[Feature.DISTANCE, Feature.STRAIGHT, Feature.BESIDE], 1] = UNREACHABLE_DISTANCE
    found[Feature.TIME, 1] = INF
    found[Feature.SAID] = -1, len(all_words()) - 1
    if config is not None:
        found[Feature.HELD, 1] = config.hands
        found[Feature.STOPPED, 1] = config.discrete is not None
        found[Feature.SAID, 1] = found[Feature.SAID, 1] if config.speech else -1
    return found
