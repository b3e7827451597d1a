"""InstructionFollowing: instructions of one to three parts, to be carried out in the order they state."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from home_mjx.core.checks import check_known, check_number
from home_mjx.tasks.language.phrases import identify_objects, noun_phrase
from home_mjx.tasks.language.splits import mask_new_descriptors
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import Attribute, Feature
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.suite.navigation import EXCLUDED_CATEGORIES, NavigationTask, arrival_stage

VERBS = ("go to", "walk to", "find")
COMBINATIONS = ("all", "seen", "new")
SEQUENCE_TEMPLATES = ("{} then {}", "{} and then {}", "before you {1} {0}")  # {0} is carried out before {1}


@dataclass(frozen=True)
class InstructionFollowing(NavigationTask):
    """Go to one object after another, as the instruction says.

    Attributes:
        max_parts: Maximum number of objects, from 1 to 3.
        success_distance: Maximum distance to each object [m].
        combinations: Instructions to keep: "all"; "seen", those for training; or "new", those that describe
            an object with words that "seen" ones never combine, see `mask_new_combinations`.
        unseen_fraction: Fraction of all combinations of words that is new.
    """

    max_parts: int = 2
    success_distance: float = 1.0
    combinations: str = "all"
    unseen_fraction: float = 0.2

    def __post_init__(self) -> None:
        super().__post_init__()
        check_known("kind of combinations", [self.combinations], COMBINATIONS)
        check_number("unseen_fraction", self.unseen_fraction, 0, 1)
        check_number("max_parts", self.max_parts, 1, 3, integer=True)
        check_number("success_distance", self.success_distance, 0)

    def filter_rows(self, descriptors: Int[np.ndarray, "t d words"]) -> Bool[np.ndarray, " t"]:
        """Return the mask of rows that `combinations` keeps, by the words of their descriptors."""
        if self.combinations == "all":
            return np.ones(len(descriptors), bool)
        is_new = mask_new_descriptors(descriptors, self.unseen_fraction)
        return is_new if self.combinations == "new" else ~is_new

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows of random instructions about distinct objects, endlessly; none if no object can be identified."""
        things = [thing for thing in view.objects if thing.coarse not in EXCLUDED_CATEGORIES]
        told = [words for _, words in identify_objects(view.objects, things, random)]
        while told:
            count = min(int(random.integers(1, self.max_parts + 1)), len(told))
            yield self._row([told[i] for i in random.permutation(len(told))[:count]], random)

    def _row(self, parts: list[dict[Attribute, int]], random: np.random.Generator) -> TaskRow:
        """Return a row with one stage per part, each of which identifies an object, in order, and a random wording."""
        stages = []
        for at in range(len(parts)):
            there = (
                Condition(Feature.DISTANCE, at, maximum=self.success_distance),
                Condition(Feature.SEEN, at, minimum=1),
            )
            if at < len(parts) - 1:
                stages.append(TaskStage((Transition(at + 1, there, reward=self.success_reward / 2),), guide=at))
            else:
                stages.append(arrival_stage(there, self.stop, self.success_reward, guide=at))
        said = [f"{VERBS[int(random.integers(len(VERBS)))]} {noun_phrase(words)}" for words in parts]
        text = said[0]
        for part in said[1:]:
            text = SEQUENCE_TEMPLATES[int(random.integers(2 if len(said) > 2 else 3))].format(text, part)
        meant = [Selector.objects_with(words) for words in parts]
        return TaskRow(meant, stages, tokens=tokenize(text), later_goals=range(1, len(meant)))
