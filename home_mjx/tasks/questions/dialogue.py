"""Dialogue: find one of several objects of a category by asking an oracle."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.schema.semantic import SUPPORTS, Semantic
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN, attribute_text
from home_mjx.tasks.language.vocabulary import to_word, tokenize
from home_mjx.tasks.questions.question import askable_objects, identifying_words
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import Attribute, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector
from home_mjx.tasks.suite.navigation import NavigationTask, arrival_stage
from home_mjx.tasks.suite.portable_objects import box_gap

QUESTION_WORDS = {
    Attribute.COLOR: "colour",
    Attribute.SIZE: "size",
    Attribute.MATERIAL: "material",
    Attribute.ROOM_TYPE: "room",
}
UNKNOWN = "unknown"
INSTRUCTIONS = ("find one {} and ask which", "go to one {} and ask which one")


@dataclass(frozen=True)
class Dialogue(NavigationTask):
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
        """Actions that ask the oracle: `say:` and colour, size, material, room or on."""
        return tuple(f"say:{word}" for word in (*QUESTION_WORDS.values(), "on"))

    @property
    def speech_observations(self) -> tuple[str, ...]:
        """Name of the observation of the oracle's reply: `reply`."""
        return ("reply",)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows, endlessly, about objects that only the oracle's replies identify; none if there are none.

        Their category alone does not identify them, and all others of it are more than twice `success_distance` away.
        """
        things = askable_objects(view.objects)
        found = [
            (thing, words) for thing in things for words in identifying_words(view.objects, thing)[:1] if len(words) > 1
        ]
        found = [(thing, words) for thing, words in found if self._is_apart(thing, things)]
        while found:
            for at in random.permutation(len(found)).tolist():
                thing, words = found[at]
                yield self._row(view.objects, thing, words, random)

    def _is_apart(self, thing: HouseObject, things: Sequence[HouseObject]) -> bool:
        """Return whether `thing` has peers of its category, all more than twice `success_distance` away."""
        peers = [other for other in things if other.coarse == thing.coarse and other.object_id != thing.object_id]
        return bool(peers) and min(box_gap(thing, other) for other in peers) > 2 * self.success_distance

    def _row(
        self,
        things: Sequence[HouseObject],
        thing: HouseObject,
        words: dict[Attribute, int],
        random: np.random.Generator,
    ) -> TaskRow:
        """Return the row of a hidden object; `words` identify it, and the oracle's first replies are these."""
        there = Condition(Feature.DISTANCE, 1, maximum=self.success_distance), Condition(Feature.SEEN, 1, minimum=1)
        first = [word for word in QUESTION_WORDS if word in words]
        asked = [*first, *(word for word in QUESTION_WORDS if word not in words)]
        said = {word: attribute_text(word, words[word]) for word in first}
        oracle = [(QUESTION_WORDS[word], said.get(word) or reply_word(thing, word)) for word in asked]
        oracle.append(("on", support_word(things, thing)))
        return TaskRow(
            [Selector.objects(coarse=thing.semantic(Semantic.COARSE)), Selector.objects(object_id=thing.object_id)],
            [arrival_stage(there, self.stop, self.success_reward, guide=1)],
            goal=1,
            tokens=tokenize(INSTRUCTIONS[int(random.integers(len(INSTRUCTIONS)))].format(to_word(thing.coarse))),
            oracle=[(tokenize(question)[0], tokenize(answer)[0]) for question, answer in oracle],
            num_identifying_questions=len(first),
        )


def reply_word(thing: HouseObject, word: Attribute) -> str:
    """Return the oracle's word for an attribute; the main colour, the first room label, or `UNKNOWN`."""
    value = thing.semantic(SEMANTIC_COLUMN[word])
    return attribute_text(word, value) if value >= 0 else UNKNOWN


def support_word(things: Sequence[HouseObject], thing: HouseObject) -> str:
    """Return the category of the object that supports `thing`, else the surface's name; `UNKNOWN` if not known.

    The surface's name is also returned if that object is not in `things`.
    """
    support = thing.semantic(Semantic.SUPPORT)
    if support < 0:
        return UNKNOWN
    below = [other for other in things if other.object_id == thing.semantic(Semantic.SUPPORTER)]
    return to_word(below[0].coarse) if below else SUPPORTS[support]
