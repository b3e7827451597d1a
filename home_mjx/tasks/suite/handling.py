"""Tasks for hands: fetch a thing, put a thing somewhere."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import phrase, telling
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rows.build import Row
from home_mjx.tasks.rows.house_view import HouseView, Thing
from home_mjx.tasks.rows.program import Go, Meant, Stage, When
from home_mjx.tasks.rows.words import SUCCESS, Feature, Word
from home_mjx.tasks.suite.navigation import NO_GOALS, Navigation

SURFACES = frozenset(("table", "desk", "stand", "tv_stand", "kitchen_cabinet", "dresser", "bed", "sofa", "shelving"))
HOLDS = When(Feature.HELD, 0, least=1)


def meant(words: dict[Word, int]) -> Meant:
    """A descriptor of these words."""
    return Meant.thing(**{word.name.lower(): value for word, value in words.items()})


def liftable(view: HouseView) -> list[Thing]:
    """Things that hands can pick up, and of whose category people speak."""
    mass = np.asarray(view.bank.physics.body_mass[view.house])
    return [
        thing
        for thing in view.things
        if thing.body >= 0 and mass[thing.body] <= 10 and COARSE[thing.word(Semantic.COARSE)] not in NO_GOALS
    ]


@dataclass(frozen=True)
class Fetch(Navigation):
    """Pick a thing up that is told by the fewest words that mean it alone."""

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Every thing that can be picked up and told, again and again in another order."""
        things = liftable(view)
        told = [words for words in (telling(view.things, thing, random) for thing in things) if words is not None]
        while told:
            for at in random.permutation(len(told)).tolist():
                stage = Stage((Go(SUCCESS, (HOLDS,), reward=self.success_reward),), guide=0)
                yield Row([meant(told[at])], [stage], tokens=tokenize(f"pick up {phrase(told[at])}"))


@dataclass(frozen=True)
class Rearrange(Navigation):
    """Bring a thing to a piece of furniture and put it on it."""

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Every pair of a thing and a surface, in another order each time."""
        things, surfaces = liftable(view), surfaces_of(view)
        names = {thing.object_id: telling(view.things, thing, random) for thing in (*things, *surfaces)}
        pairs = [(a, b) for a in things for b in surfaces if a is not b and names[a.object_id] and names[b.object_id]]
        while pairs:
            for at in random.permutation(len(pairs)).tolist():
                first, second = (names[thing.object_id] or {} for thing in pairs[at])
                text = f"put {phrase(first)} on {phrase(second)}"
                lies = When(Feature.ON, 0, 1, least=1)
                pick = Stage((Go(1, (HOLDS,), reward=self.success_reward / 2),), guide=0)
                put = Stage(
                    (Go(SUCCESS, (lies,), (HOLDS,), self.success_reward), Go(0, bars=(HOLDS, lies))),
                    guide=1,
                )
                yield Row([meant(first), meant(second)], [pick, put], tokens=tokenize(text))


def surfaces_of(view: HouseView) -> list[Thing]:
    """Furniture on which things are put."""
    return [thing for thing in view.things if COARSE[thing.word(Semantic.COARSE)] in SURFACES]
