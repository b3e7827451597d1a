"""VQA: one image, one question, one answer.

Antol et al., "VQA: Visual Question Answering", ICCV 2015 (arXiv:1505.00468).
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_number
from home_mjx.tasks.language.vocabulary import to_word, tokenize
from home_mjx.tasks.questions.house_qa import QuestionTask, answer_transitions
from home_mjx.tasks.questions.question import MAX_COUNT, YES_NO, Question, askable_objects, indefinite_noun
from home_mjx.tasks.questions.question_kinds import attribute_questions
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import FAILURE, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition

KINDS = ("existence", "count", "color", "material", "size")
ATTRIBUTE_KINDS = ("color", "material", "size")
AFTER_FIRST_STEP = Condition(Feature.TIME, minimum=1)


@dataclass(frozen=True)
class VQA(QuestionTask):
    """Task of answering a question about the current view in the first step.

    Views are those of the default camera: level, with a field of view of 90° in height and width.

    Attributes:
        num_views: Number of views per house for which questions are generated.
        min_image_fraction: Minimum fraction of the image that an object must cover to be asked about.
    """

    kinds: tuple[str, ...] = KINDS
    num_views: int = 32
    min_image_fraction: float = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("num_views", self.num_views, 1, integer=True)
        check_number("min_image_fraction", self.min_image_fraction, 0, 1)

    @property
    def known_kinds(self) -> tuple[str, ...]:
        """Kinds of questions that one view can answer."""
        return KINDS

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows of all questions about `num_views` views, from random cells in random directions.

        Cells are off door leaves, and may repeat.
        """
        cells = random.choice(np.flatnonzero(~view.graph.at_leaf), self.num_views)
        places = view.graph.place[cells]
        yaws = random.uniform(-np.pi, np.pi, self.num_views)
        for place, yaw, parts in zip(places, yaws, view.image_fractions(places, yaws), strict=True):
            for question in self._questions(view, parts):
                yield self._row(question, place, float(yaw))

    def _questions(self, view: HouseView, parts: dict[int, float]) -> Iterator[Question]:
        """Yield questions about a view, given the fraction of the image that each object id covers."""
        seen = [thing for thing in view.all_objects if thing.object_id in parts]
        clear = [thing for thing in seen if parts[thing.object_id] >= self.min_image_fraction]
        nouns, known = sorted({thing.coarse for thing in askable_objects(view.all_objects)}), {}
        for kind in self.kinds:
            asked = (
                attribute_questions(seen, kind, clear)
                if kind in ATTRIBUTE_KINDS
                else view_questions(kind, nouns, seen, clear)
            )
            known |= {question.texts[0]: question for question in asked}
        yield from known.values()

    def _row(self, question: Question, place: np.ndarray, yaw: float) -> TaskRow:
        """Return the row of a question at a start pose: the right answer in the first step succeeds, all else fails."""
        texts = [tokenize(text) for text in question.texts]
        (answer,) = tokenize(question.answer)
        right, _ = answer_transitions(answer, self.success_reward)
        return TaskRow(
            [Selector.point(place.tolist())],
            [TaskStage((right, Transition(FAILURE, (AFTER_FIRST_STEP,))))],
            tokens=texts[0],
            start_pose=(place.tolist(), yaw),
            answer=answer,
            group=(question.kind, question.texts[0]),
            paraphrases=texts[1:],
        )


def view_questions(
    kind: str, nouns: Sequence[str], seen: Sequence[HouseObject], clear: Sequence[HouseObject]
) -> Iterator[Question]:
    """Yield questions about the presence or number of a category's objects, unless one of them is hardly in view.

    Numbers are asked only if they are 1 to `MAX_COUNT`.

    Args:
        kind: "existence" or "count".
        nouns: Categories to ask about.
        seen: Objects of which any part is in view.
        clear: Objects that are well in view.
    """
    well = {thing.object_id for thing in clear}
    faint = {thing.coarse for thing in askable_objects(seen) if thing.object_id not in well}
    counts = Counter(thing.coarse for thing in askable_objects(clear))
    for category in (name for name in nouns if name not in faint):
        number = counts[category]
        if kind == "existence":
            texts = f"do you see {indefinite_noun(category)}", f"is there {indefinite_noun(category)} here"
            yield Question(kind, texts, YES_NO[number == 0])
        elif 1 <= number <= MAX_COUNT:
            texts = f"how many {to_word(category)} do you see", f"how many {to_word(category)} are there"
            yield Question(kind, texts, str(number))
