"""Dialogue: find one of several objects of a category by asking an oracle."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.scene_compile.semantics.supports import SUPPORTS
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import COLUMN, name
from home_mjx.tasks.language.vocabulary import spoken, tokenize
from home_mjx.tasks.questions.ask import gap_between
from home_mjx.tasks.questions.question import askable, described, noun
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView, Thing
from home_mjx.tasks.rules.program import Meant, When
from home_mjx.tasks.rules.words import Feature, Word
from home_mjx.tasks.suite.navigation import Navigation, arrive

QUESTIONS = {Word.COLOR: "colour", Word.SIZE: "size", Word.MATERIAL: "material", Word.ROOM_TYPE: "room"}
UNKNOWN = "unknown"
TEXTS = ("find one {} and ask which", "go to one {} and ask which one")


@dataclass(frozen=True)
class Dialogue(Navigation):
    """Task of going to one of several objects of a category, and looking at it; an oracle describes it.

    Agents ask by saying `colour`, `size`, `material`, `room` or `on`. The oracle's one-word answer is the observation
    `reply` after that step. Each question costs `question_cost`.

    Attributes:
        success_distance: Maximum distance from the object [m].
    """

    success_distance: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)

    @property
    def speech(self) -> tuple[str, ...]:
        """Questions that agents can ask."""
        return tuple(f"say:{word}" for word in (*QUESTIONS.values(), "on"))

    @property
    def hears(self) -> tuple[str, ...]:
        """The oracle's reply."""
        return ("reply",)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield objects that share their category with others, but are identified by the oracle's replies."""
        things = askable(view.things)
        found = [(thing, words) for thing in things for words in described(view.things, thing)[:1] if len(words) > 1]
        found = [(thing, words) for thing, words in found if self._is_apart(thing, things)]
        while found:
            for at in random.permutation(len(found)).tolist():
                thing, words = found[at]
                yield self._row(view.things, thing, words, random)

    def _is_apart(self, thing: Thing, things: Sequence[Thing]) -> bool:
        """Return whether no place is within `success_distance` of both this object and a peer of its category."""
        peers = [other for other in things if noun(other) == noun(thing) and other.object_id != thing.object_id]
        return bool(peers) and min(gap_between(thing, other) for other in peers) > 2 * self.success_distance

    def _row(self, things: Sequence[Thing], thing: Thing, words: dict[Word, int], random: np.random.Generator) -> Row:
        there = When(Feature.DISTANCE, 1, most=self.success_distance), When(Feature.SEEN, 1, least=1)
        first = [word for word in QUESTIONS if word in words]
        asked = [*first, *(word for word in QUESTIONS if word not in words)]
        oracle = [(QUESTIONS[word], reply(thing, word)) for word in asked]
        oracle.append(("on", bearer(things, thing)))
        return Row(
            [Meant.thing(coarse=thing.word(Semantic.COARSE)), Meant.thing(object_id=thing.object_id)],
            [arrive(there, self.stop, self.success_reward, guide=1)],
            goal=1,
            tokens=tokenize(TEXTS[int(random.integers(len(TEXTS)))].format(spoken(noun(thing)))),
            oracle=[(tokenize(question)[0], tokenize(answer)[0]) for question, answer in oracle],
            ask=len(first),
        )


def reply(thing: Thing, word: Word) -> str:
    """Return the oracle's word for a property of an object; of several colours the main one."""
    value = thing.word(COLUMN[word])
    return name(word, value) if value >= 0 else UNKNOWN


def bearer(things: Sequence[Thing], thing: Thing) -> str:
    """Return the oracle's word for the object or surface that an object rests on or hangs from."""
    support = thing.word(Semantic.SUPPORT)
    if support < 0:
        return UNKNOWN
    below = [other for other in things if other.object_id == thing.word(Semantic.SUPPORTER)]
    return spoken(COARSE[below[0].word(Semantic.COARSE)]) if below else SUPPORTS[support]
