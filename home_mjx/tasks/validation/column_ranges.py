"""Ranges of the columns of a task bank by the names in their declarations, for the validation of files and arrays."""

import functools
import operator
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import all_words
from home_mjx.tasks.rules.declaration import row_columns
from home_mjx.tasks.rules.enums import (
    FAILURE,
    MAX_AGENTS,
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_REPLIES,
    NUM_STAGES,
    Attribute,
    Feature,
    TargetKind,
)
from home_mjx.tasks.rules.features import UNREACHABLE_DISTANCE
from home_mjx.tasks.rules.task_bank import RECORDS
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP_NUMBER

INF = float("inf")
MAX_MAGNITUDE = 1e6  # maximum of a reward, a length [m] or a limit of a condition
MAX_INT16 = 2**15 - 1
DESCRIPTOR_COLUMN = "selectors.{}"  # name of a descriptor's column, by attribute


class Range(NamedTuple):
    """Range of allowed numbers.

    Attributes:
        minimum: Minimum, inclusive.
        maximum: Maximum, inclusive.
        is_integer: Integers only.
        also_allowed: Further allowed values, such as infinity for no limit.

    Example:
        >>> print(Range(0, 3, is_integer=True))
        a whole number from 0 to 3
        >>> Range(0.0, 3.0, also_allowed=(INF,)).contains(np.array([-1.0, 2.0, np.inf, np.nan])).tolist()
        [False, True, True, False]
    """

    minimum: float
    maximum: float
    is_integer: bool = False
    also_allowed: tuple[float, ...] = ()

    def contains(self, values: Any) -> Any:
        """Return whether a number, or each of an array, is within the bounds or also allowed; ignore `is_integer`."""
        within = (values >= self.minimum) & (values <= self.maximum)
        return functools.reduce(operator.or_, [values == number for number in self.also_allowed], within)

    def __str__(self) -> str:
        """Return the wording for messages."""
        others = "".join(f" or {number:g}" for number in self.also_allowed)
        return f"a {'whole ' if self.is_integer else ''}number from {self.minimum:g} to {self.maximum:g}{others}"


def index_range(count: int, allow_none: bool = True) -> Range:
    """Return the range of indices into `count` items; with `allow_none` it includes -1."""
    return Range(-1 if allow_none else 0, count - 1, is_integer=True)


def _indices(count: int) -> Callable[[], Range]:
    """Return a function that returns the range of indices into `count` items, or -1."""
    return lambda: index_range(count)


def _token_range(allow_none: bool) -> Callable[[], Range]:
    """Return a function that returns the range of tokens, with `allow_none` or -1."""
    return lambda: index_range(len(all_words()), allow_none)


# Ranges for any houses and environment, by `Column.values`; functions, since vocabularies are read when first used.
RANGES: Mapping[str, Callable[[], Range]] = {
    "house": lambda: index_range(2**31, allow_none=False),
    "point": lambda: Range(-UNREACHABLE_DISTANCE, UNREACHABLE_DISTANCE),
    "place": lambda: Range(-UNREACHABLE_DISTANCE, UNREACHABLE_DISTANCE, also_allowed=(INF,)),
    "yaw": lambda: Range(-1000.0, 1000.0),
    "task": lambda: index_range(MAX_INT16 + 1, allow_none=False),
    "length": lambda: Range(0.0, MAX_MAGNITUDE),
    "descriptor": _indices(NUM_DESCRIPTORS),
    "kind": _indices(len(TargetKind) - 1),
    "id": _indices(MAX_INT16 + 1),
    "field": _indices(MAX_INT16 + 1),
    "feature": lambda: index_range(len(Feature), allow_none=False),
    "agent": _indices(MAX_AGENTS),
    "agents": _indices(2**MAX_AGENTS),
    "limit": lambda: Range(-MAX_MAGNITUDE, MAX_MAGNITUDE, also_allowed=(-INF, INF)),
    "conditions": _indices(2**NUM_CONDITIONS),
    "next": lambda: Range(FAILURE, NUM_STAGES - 1, is_integer=True),
    "reward": lambda: Range(-MAX_MAGNITUDE, MAX_MAGNITUDE),
    "clip": lambda: Range(VOICE_CLIP_NUMBER, len(CLIPS) - 1, is_integer=True),
    "seconds": lambda: Range(0.001, MAX_MAGNITUDE, also_allowed=(INF,)),
    "gain": lambda: Range(0.0, 1000.0),
    "speed": lambda: Range(0.0, 100.0),
    "token": _token_range(allow_none=True),
    "padded token": _token_range(allow_none=False),
    "replies": lambda: Range(0, NUM_REPLIES, is_integer=True),
}
ATTRIBUTE_VALUES = {  # of the attributes of a descriptor that are not names of a vocabulary
    Attribute.KIND: "kind",
    Attribute.OBJECT_ID: "id",
    Attribute.ROOM: "id",
    Attribute.ON: "descriptor",
    Attribute.IN: "descriptor",
    Attribute.AGENT: "agent",
}


@functools.cache
def column_values() -> Mapping[str, str]:
    """Return, by column, the name of its range; an attribute of descriptors is a column `selectors.<attribute>`.

    Example:
        >>> column_values()["guide"], column_values()["selectors.on"]
        ('descriptor', 'descriptor')
    """
    columns = {key: column.values for key, column in row_columns(RECORDS).items() if column.values != "attributes"}
    return columns | {DESCRIPTOR_COLUMN.format(word.name.lower()): _attribute_values(word) for word in Attribute}


def _attribute_values(word: Attribute) -> str:
    """Return the name of the range of an attribute's values."""
    return ATTRIBUTE_VALUES.get(word) or word.name.lower()


def column_ranges(special: Mapping[str, Range] = MappingProxyType({})) -> dict[str, Range]:
    """Return the range of each column of a row by its key; `special` ranges, by name of values, replace `RANGES`.

    Example:
        >>> print(column_ranges()["reward"])
        a number from -1e+06 to 1e+06
        >>> print(column_ranges({"agent": index_range(2)})["selectors.agent"])
        a whole number from -1 to 1
    """
    return {name: special.get(values) or values_range(values) for name, values in column_values().items()}


@functools.cache
def values_range(values: str) -> Range:
    """Return the range of this name in `RANGES`; for an attribute with a vocabulary, its indices and -1 for any."""
    if values in RANGES:
        return RANGES[values]()
    return index_range(len(vocabularies()[SEMANTIC_COLUMN[Attribute[values.upper()]]]))


def feature_ranges(config: EnvConfig | None = None) -> Float[np.ndarray, "features 2"]:
    """Return the minimum and maximum of each feature's values, both inclusive; inf: no maximum.

    Args:
        config: Options of the environment; None: any environment.

    Example:
        >>> feature_ranges(EnvConfig(hands=False))[Feature.HELD].tolist()
        [0.0, 0.0]
    """
    found = np.tile([0.0, 1.0], (len(Feature), 1))
    found[Feature.TRUE] = 1.0
    found[[Feature.DISTANCE, Feature.STRAIGHT, Feature.BESIDE], 1] = UNREACHABLE_DISTANCE
    found[Feature.TIME, 1] = INF
    found[Feature.CONTAINED] = -1, INF
    found[Feature.SAID] = -1, len(all_words()) - 1
    if config is not None:
        found[Feature.HELD, 1] = config.hands
        found[Feature.SWITCHED_ON, 1] = config.switches is not None
        found[Feature.STOPPED, 1] = config.discrete is not None
        found[Feature.SAID, 1] = found[Feature.SAID, 1] if config.speech else -1
    return found
