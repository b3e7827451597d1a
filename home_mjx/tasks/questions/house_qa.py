"""HouseQA: walk through a house to answer a question about it.

Das et al., "Embodied Question Answering", CVPR 2018 (arXiv:1711.11543), on houses of SUNCG.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from home_mjx.core.checks import check_names, check_number
from home_mjx.errors import ConfigError, did_you_mean
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.questions.balance import balance_rows
from home_mjx.tasks.questions.question import Question, answers_to
from home_mjx.tasks.questions.question_kinds import QUESTION_GENERATORS
from home_mjx.tasks.rules.build_bank import FeasibleRow, TaskRow
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS, Feature, TargetKind
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.row_task import GeneratorTask

KINDS = tuple(QUESTION_GENERATORS)
MAX_CANDIDATES = 256  # maximum number of questions of each kind per house before balancing
ANY_ANSWER = Condition(Feature.SAID, minimum=0)


@dataclass(frozen=True)
class QuestionTask(GeneratorTask):
    """Base of tasks that ask a question.

    Attributes:
        kinds: Kinds of questions.
        success_reward: Reward for the correct answer.
    """

    kinds: tuple[str, ...] = KINDS
    success_reward: float = 2.5

    def __post_init__(self) -> None:
        super().__post_init__()
        check_names("kind of question", self.kinds, self.known_kinds)
        if not self.kinds:
            raise ConfigError(f"{self.name} needs at least one of its `kinds`", hint=did_you_mean("", self.known_kinds))
        check_number("success_reward", self.success_reward, 0)

    @property
    def known_kinds(self) -> tuple[str, ...]:
        """All kinds of questions that the task supports."""
        return KINDS

    @property
    def speech(self) -> tuple[str, ...]:
        """Answers to questions of these kinds, as speech actions."""
        return tuple(f"answer:{word}" for word in answers_to(self.kinds))

    def select_rows(self, drawn: list[FeasibleRow], num_tasks: int, random: np.random.Generator) -> list[FeasibleRow]:
        """Select at most `num_tasks` rows per house, so that a question occurs equally often with each answer.

        Raises as `balance_rows`.
        """
        return balance_rows(drawn, num_tasks, random)


@dataclass(frozen=True)
class HouseQA(QuestionTask):
    """Task of answering a question about the house; an answer ends the episode.

    Attributes:
        look_distance: Distance within which a visible object counts as looked at [m]; used by the expert and for the
            progress reward. An agent may answer earlier.
    """

    look_distance: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("look_distance", self.look_distance, 0.5)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield a row for each question, at most `MAX_CANDIDATES` a kind; a hash prefers equal texts in all houses.

        Of several questions of one kind and text, only the last is asked.
        """
        for kind in dict.fromkeys(self.kinds):
            known = {question.texts[0]: question for question in QUESTION_GENERATORS[kind](view)}
            for text in sorted(known, key=lambda text: crc32(text.encode()))[:MAX_CANDIDATES]:
                yield self._row(known[text])

    def _row(self, question: Question) -> TaskRow:
        """Return the row of a question; its other wordings are paraphrases."""
        texts = [tokenize(text) for text in question.texts]
        (answer,) = tokenize(question.answer)
        return TaskRow(
            question.looks,
            self._stages(question.looks, answer),
            tokens=texts[0],
            answer=answer,
            group=(question.kind, question.texts[0]),
            paraphrases=texts[1:],
        )

    def _stages(self, looks: tuple[Selector, ...], answer: int) -> list[TaskStage]:
        """Return a stage per object or room to look at, and a last one; an answer ends the episode in each of them."""
        ends = answer_transitions(answer, self.success_reward)
        stages = [
            TaskStage((*ends, Transition(at + 1, self._there(at, look))), guide=at) for at, look in enumerate(looks)
        ]
        return [*stages, TaskStage(ends, guide=len(looks) - 1)]

    def _there(self, at: int, look: Selector) -> tuple[Condition, ...]:
        """Return the conditions for having looked at descriptor `at`: inside a room, or near an object in view."""
        if look.attributes["kind"] == TargetKind.ROOM:
            return (Condition(Feature.INSIDE, at, minimum=1),)
        return Condition(Feature.DISTANCE, at, maximum=self.look_distance), Condition(Feature.SEEN, at, minimum=1)


def answer_transitions(answer: int, reward: float) -> tuple[Transition, Transition]:
    """Return the transitions to SUCCESS for the correct answer (a token), and to FAILURE for any other word."""
    right = Condition(Feature.SAID, minimum=answer, maximum=answer)
    return Transition(SUCCESS, (right,), reward=reward), Transition(FAILURE, (ANY_ANSWER,))
