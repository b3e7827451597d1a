"""HouseQA: walk through a house to answer a question about it.

Das et al., "Embodied Question Answering", CVPR 2018 (arXiv:1711.11543), whose houses were those of SUNCG.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from home_mjx.core.checks import check_names, check_number
from home_mjx.errors import ConfigError, did_you_mean
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.questions.ask import ASK
from home_mjx.tasks.questions.balance import balanced
from home_mjx.tasks.questions.question import Question, answers_to
from home_mjx.tasks.rules.build import Drawn, Generator, Row
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.row_task import RowTask
from home_mjx.tasks.rules.words import FAILURE, SUCCESS, Feature, Kind

KINDS = tuple(ASK)
OFFERED = 256  # questions of each kind per house, from which balanced ones are chosen
SPOKEN = When(Feature.SAID, least=0)


@dataclass(frozen=True)
class Asking(RowTask):
    """What tasks share that ask a question.

    Attributes:
        kinds: Of questions.
        success_reward: For the right answer.
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
        """Kinds of questions that there are."""
        return KINDS

    @property
    def name(self) -> str:
        """Of the task."""
        return type(self).__name__

    @property
    def speech(self) -> tuple[str, ...]:
        """The words that answer questions of these kinds."""
        return tuple(f"answer:{word}" for word in answers_to(self.kinds))

    @property
    def generators(self) -> tuple[Generator, ...]:
        """The task itself."""
        return (self,)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """All questions to which a house has an answer."""
        raise NotImplementedError

    def choose(self, drawn: list[Drawn], num_tasks: int, random: np.random.Generator) -> list[Drawn]:
        """Such that each question has each of its answers as often."""
        return balanced(drawn, num_tasks, random)


@dataclass(frozen=True)
class HouseQA(Asking):
    """Answer a question about the house; an answer ends the episode.

    Attributes:
        look_distance: From where a thing that is asked about counts as looked at [m]; for the expert, and for the
            progress that is rewarded. Whoever knows the answer earlier may give it.
    """

    look_distance: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("look_distance", self.look_distance, 0.5)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """All questions to which the house has an answer; of many the same as in other houses."""
        for kind in dict.fromkeys(self.kinds):
            known = {question.texts[0]: question for question in ASK[kind](view)}
            for text in sorted(known, key=lambda text: crc32(text.encode()))[:OFFERED]:
                yield self._row(known[text])

    def _row(self, question: Question) -> Row:
        texts = [tokenize(text) for text in question.texts]
        (answer,) = tokenize(question.answer)
        return Row(
            question.looks,
            self._stages(question.looks, answer),
            tokens=texts[0],
            answer=answer,
            group=(question.kind, question.texts[0]),
            wordings=texts[1:],
        )

    def _stages(self, looks: tuple[Meant, ...], answer: int) -> list[Stage]:
        """A stage per thing to look at, and one in which all is known; answers are taken in all of them."""
        ends = answered(answer, self.success_reward)
        stages = [Stage((*ends, Go(at + 1, self._there(at, look))), guide=at) for at, look in enumerate(looks)]
        return [*stages, Stage(ends, guide=len(looks) - 1)]

    def _there(self, at: int, look: Meant) -> tuple[When, ...]:
        if look.words["kind"] == Kind.ROOM:
            return (When(Feature.INSIDE, at, least=1),)
        return When(Feature.DISTANCE, at, most=self.look_distance), When(Feature.SEEN, at, least=1)


def answered(answer: int, reward: float) -> tuple[Go, Go]:
    """The ends of a question: the right answer, and any other."""
    right = When(Feature.SAID, least=answer, most=answer)
    return Go(SUCCESS, (right,), reward=reward), Go(FAILURE, (SPOKEN,))
