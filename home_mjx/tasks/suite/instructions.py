"""InstructionFollowing: instructions of one to three parts, to be carried out in the order they state."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from home_mjx.core.checks import check_known, check_number
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import phrase, telling
from home_mjx.tasks.language.splits import has_new_combination
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.words import Feature, Word
from home_mjx.tasks.suite.navigation import NO_GOALS, Navigation, arrive

VERBS = ("go to", "walk to", "find")
COMBINATIONS = ("all", "seen", "new")
JOINED = ("{} then {}", "{} and then {}", "before you {1} {0}")  # {0} is carried out before {1}


@dataclass(frozen=True)
class InstructionFollowing(Navigation):
    """Go to one object after another, as the instruction says.

    Attributes:
        num_parts: Maximum number of objects, from 1 to 3.
        success_distance: Maximum distance to each object [m].
        combinations: Instructions to keep: "all"; "seen", those for training; or "new", those that describe
            an object with words that "seen" ones never combine, see `new_combinations`.
        unseen_part: Fraction of all combinations of words that is new.
    """

    num_parts: int = 2
    success_distance: float = 1.0
    combinations: str = "all"
    unseen_part: float = 0.2

    def __post_init__(self) -> None:
        super().__post_init__()
        check_known("kind of combinations", [self.combinations], COMBINATIONS)
        check_number("unseen_part", self.unseen_part, 0, 1)
        check_number("num_parts", self.num_parts, 1, 3, whole=True)
        check_number("success_distance", self.success_distance, 0)

    def keeps(self, descriptors: Int[np.ndarray, "t d words"]) -> Bool[np.ndarray, " t"]:
        """Return the mask of rows in `combinations`."""
        if self.combinations == "all":
            return np.ones(len(descriptors), bool)
        is_new = has_new_combination(descriptors, self.unseen_part)
        return is_new if self.combinations == "new" else ~is_new

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield random instructions; the objects in one are distinct."""
        things = [thing for thing in view.things if COARSE[thing.word(Semantic.COARSE)] not in NO_GOALS]
        told = [words for words in (telling(view.things, thing, random) for thing in things) if words is not None]
        while told:
            count = min(int(random.integers(1, self.num_parts + 1)), len(told))
            yield self._row([told[i] for i in random.permutation(len(told))[:count]], random)

    def _row(self, parts: list[dict[Word, int]], random: np.random.Generator) -> Row:
        stages = []
        for at in range(len(parts)):
            there = When(Feature.DISTANCE, at, most=self.success_distance), When(Feature.SEEN, at, least=1)
            if at < len(parts) - 1:
                stages.append(Stage((Go(at + 1, there, reward=self.success_reward / 2),), guide=at))
            else:
                stages.append(arrive(there, self.stop, self.success_reward, guide=at))
        said = [f"{VERBS[int(random.integers(len(VERBS)))]} {phrase(words)}" for words in parts]
        text = said[0]
        for part in said[1:]:
            text = JOINED[int(random.integers(2 if len(said) > 2 else 3))].format(text, part)
        meant = [Meant.of(words) for words in parts]
        return Row(meant, stages, tokens=tokenize(text), then=range(1, len(meant)))
