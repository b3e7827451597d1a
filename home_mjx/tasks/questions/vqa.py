"""VQA: one image, one question, one answer.

Antol et al., "VQA: Visual Question Answering", ICCV 2015 (arXiv:1505.00468).
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.tasks.language.vocabulary import spoken, tokenize
from home_mjx.tasks.questions.ask import attributes
from home_mjx.tasks.questions.house_qa import Asking, answered
from home_mjx.tasks.questions.question import MOST, YES_NO, Question, askable, noun, one_of
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView, Thing
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.words import FAILURE, Feature

KINDS = ("existence", "count", "colour", "material", "size")
OF_THINGS = ("colour", "material", "size")
LATE = When(Feature.TIME, least=1)


@dataclass(frozen=True)
class VQA(Asking):
    """Task of answering a question about the current view in the first step.

    Views are those of the default camera: level, with a field of view of 90° in height and width.

    Attributes:
        num_views: Number of views per house for which questions are generated.
        least_part: Minimum fraction of the image that an object must cover to be asked about.
    """

    kinds: tuple[str, ...] = KINDS
    num_views: int = 32
    least_part: float = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("num_views", self.num_views, 1, whole=True)
        check_number("least_part", self.least_part, 0, 1)

    @property
    def known_kinds(self) -> tuple[str, ...]:
        """Kinds of questions that one view can answer."""
        return KINDS

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield all questions about randomly drawn views."""
        cells = random.choice(np.flatnonzero(~view.graph.at_leaf), self.num_views)
        places = view.graph.place[cells]
        yaws = random.uniform(-np.pi, np.pi, self.num_views)
        for place, yaw, parts in zip(places, yaws, view.looks(places, yaws), strict=True):
            for question in self._questions(view, parts):
                yield self._row(question, place, float(yaw))

    def _questions(self, view: HouseView, parts: dict[int, float]) -> Iterator[Question]:
        """Yield questions about a view, given the fraction of the image that each object id covers."""
        seen = [thing for thing in view.everything if thing.object_id in parts]
        clear = [thing for thing in seen if parts[thing.object_id] >= self.least_part]
        nouns, known = sorted({noun(thing) for thing in askable(view.everything)}), {}
        for kind in self.kinds:
            asked = attributes(seen, kind, clear) if kind in OF_THINGS else in_view(kind, nouns, seen, clear)
            known |= {question.texts[0]: question for question in asked}
        yield from known.values()

    def _row(self, question: Question, place: np.ndarray, yaw: float) -> Row:
        texts = [tokenize(text) for text in question.texts]
        (answer,) = tokenize(question.answer)
        right, _ = answered(answer, self.success_reward)
        return Row(
            [Meant.at(place.tolist())],
            [Stage((right, Go(FAILURE, (LATE,))))],
            tokens=texts[0],
            pose=(place.tolist(), yaw),
            answer=answer,
            group=(question.kind, question.texts[0]),
            wordings=texts[1:],
        )


def in_view(kind: str, nouns: Sequence[str], seen: Sequence[Thing], clear: Sequence[Thing]) -> Iterator[Question]:
    """Yield questions about the presence or number of a category's objects, unless one of them is hardly in view.

    Args:
        kind: "existence" or "count".
        nouns: Categories to ask about.
        seen: Objects of which any part is in view.
        clear: Objects that are well in view.
    """
    well = {thing.object_id for thing in clear}
    faint = {noun(thing) for thing in askable(seen) if thing.object_id not in well}
    counts = Counter(noun(thing) for thing in askable(clear))
    for category in (name for name in nouns if name not in faint):
        number = counts[category]
        if kind == "existence":
            texts = f"do you see {one_of(category)}", f"is there {one_of(category)} here"
            yield Question(kind, texts, YES_NO[number == 0])
        elif 1 <= number <= MOST:
            texts = f"how many {spoken(category)} do you see", f"how many {spoken(category)} are there"
            yield Question(kind, texts, str(number))
