"""Tasks with hands: bring objects somewhere, and put objects on others.

Szot et al., "Habitat 2.0: Training Home Assistants to Rearrange their Habitat", 2021 (arXiv:2106.14405); Batra et al.,
"Rearrangement: A Challenge for Embodied AI", 2020 (arXiv:2011.01975).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from home_mjx.core.checks import check_known, check_number
from home_mjx.errors import ConfigError
from home_mjx.schema.agent import Body
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import name, phrase, telling
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView, Thing
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.words import FAILURE, NUM_TOKENS, SUCCESS, Feature, Word
from home_mjx.tasks.suite.carried import Portable, gap, has_room, lies_on, portable_things
from home_mjx.tasks.suite.navigation import NO_GOALS, STOPPED, Navigation

PLACES = ("thing", "room", "start")  # kinds of destinations
MOST_THINGS = 2  # maximum number of objects: a row has four descriptors, two per object
JOINED = ("{} and {}", "{} then {}")
Words = dict[Word, int]
Pose = tuple[Sequence[float], float]  # on the floor [m], yaw [rad]


@dataclass(frozen=True)
class Handling(Navigation):
    """Options that tasks with hands share.

    Attributes:
        max_mass: Maximum mass of an object to carry [kg].
        max_size: Maximum extent of an object to carry [m].
    """

    max_mass: float = Body().lift
    max_size: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        for limit in ("max_mass", "max_size"):
            check_number(limit, getattr(self, limit), 0)

    @property
    def needs_hands(self) -> bool:
        """Always True."""
        return True

    def _told(self, view: HouseView, random: np.random.Generator) -> list[tuple[Portable, Words]]:
        """Return portable objects that words identify uniquely, with these words."""
        things = portable_things(view, self.max_mass, self.max_size)
        told = [(thing, telling(view.things, thing.thing, random)) for thing in things]
        return [(thing, words) for thing, words in told if words is not None]


@dataclass(frozen=True)
class Fetch(Handling):
    """Pick up an object and bring it to another one, into a room, or to the start of the episode.

    Attributes:
        success_distance: Maximum distance to the destination on success [m].
        places: Kinds of destinations, from `PLACES`.
    """

    success_distance: float = 1.0
    places: tuple[str, ...] = field(default=PLACES)

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)
        if not isinstance(self.places, tuple) or not self.places:
            raise ConfigError(f"`places` must be a tuple of {', '.join(PLACES)}, got {self.places!r}")
        check_known("place", self.places, PLACES)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield objects of the house with random destinations, in a new random order each round."""
        told = self._told(view, random)
        goals = [thing for thing in view.things if thing.coarse not in NO_GOALS]
        named = [(thing, words) for thing in goals if (words := telling(view.things, thing, random)) is not None]
        if not named:
            return
        while told:
            for at in random.permutation(len(told)).tolist():
                thing, words = told[at]
                place = self.places[int(random.integers(len(self.places)))]
                if place == "thing":
                    yield from self._to_thing(thing, words, named[int(random.integers(len(named)))])
                elif place == "room":
                    yield from self._to_room(view, thing, words, random)
                else:
                    yield self._to_start(view, words, random)

    def _to_thing(self, thing: Portable, words: Words, goal: tuple[Thing, Words]) -> Iterator[Row]:
        if gap(thing.thing, goal[0]) > 2 * self.success_distance:  # also excludes the object itself
            near = When(Feature.DISTANCE, 1, most=self.success_distance)
            yield self._row(words, Meant.of(goal[1]), near, f"to {phrase(goal[1])}")

    def _to_room(self, view: HouseView, thing: Portable, words: Words, random: np.random.Generator) -> Iterator[Row]:
        own = thing.thing.word(Semantic.ROOM_TYPE)
        others = [kind for kind in np.unique(view.room_types).tolist() if kind >= 0 and kind != own]
        if others and own >= 0:
            kind = others[int(random.integers(len(others)))]
            inside = When(Feature.INSIDE, 1, least=1)
            yield self._row(words, Meant.space(room_type=kind), inside, f"to the {name(Word.ROOM_TYPE, kind)}")

    def _to_start(self, view: HouseView, words: Words, random: np.random.Generator) -> Row:
        free = view.graph.place[~view.graph.at_leaf]
        start = free[int(random.integers(len(free)))].tolist()
        near = When(Feature.DISTANCE, 1, most=self.success_distance)
        return self._row(words, Meant.at(start), near, "here", (start, random.uniform(-np.pi, np.pi)))

    def _row(self, words: Words, goal: Meant, there: When, where: str, pose: Pose | None = None) -> Row:
        held, half = When(Feature.HELD, 0, least=1), self.success_reward / 2
        said, wrong = ((STOPPED,), (Go(FAILURE, (STOPPED,)),)) if self.stop else ((), ())
        back = Go(0, bars=(held,), reward=-half)  # dropping the object costs the first reward
        first = Stage((Go(1, (held,), reward=half), *wrong), guide=0)
        second = Stage((Go(SUCCESS, (held, there, *said), reward=half), *wrong, back), guide=1)
        tokens = tokenize(f"bring {phrase(words)} {where}")
        return Row([Meant.of(words), goal], [first, second], tokens=tokens, then=(1,), pose=pose)


@dataclass(frozen=True)
class Pair:
    """An object, the receptacle to put it on, and the words that identify each."""

    thing: Portable
    words: Words
    below: Thing
    below_words: Words


def _touch(pair: Pair, other: Pair) -> bool:
    """Return whether pairs share an object, or an object is on the other pair's receptacle and might fall off."""
    same = {pair.thing.thing.object_id, pair.below.object_id} & {other.thing.thing.object_id, other.below.object_id}
    return bool(same) or lies_on(pair.thing.thing, other.below) or lies_on(other.thing.thing, pair.below)


@dataclass(frozen=True)
class Rearrange(Handling):
    """Put objects on others, and release them there.

    Attributes:
        num_things: Maximum number of objects, 1 or 2.
    """

    num_things: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("num_things", self.num_things, 1, MOST_THINGS, whole=True)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield random objects and receptacles for them; those of one row are distinct."""
        told = self._told(view, random)
        pairs = list(self._pairs(view, told, random))
        while pairs:
            count = int(random.integers(1, self.num_things + 1))
            chosen = [pairs[i] for i in random.permutation(len(pairs))]
            row = self._some(chosen, count, random)
            if row is not None:
                yield row

    def _pairs(
        self, view: HouseView, told: list[tuple[Portable, Words]], random: np.random.Generator
    ) -> Iterator[Pair]:
        """Yield objects, each with receptacles that have room for it and on which it is not."""
        below = [thing for thing in view.things if has_room(view, thing, {p.thing.object_id for p, _ in told})]
        named = [(thing, words) for thing in below if (words := telling(view.things, thing, random)) is not None]
        for portable, words in told:
            for thing, others in named:
                cells = view.put(view.instance_of(thing), view.radius(portable.instance))[0]
                if len(cells) and not lies_on(portable.thing, thing):
                    yield Pair(portable, words, thing, others)

    def _some(self, pairs: list[Pair], count: int, random: np.random.Generator) -> Row | None:
        """Return the first pairs without conflicts as one row; None if its instruction is too long."""
        chosen: list[Pair] = []
        for pair in pairs:
            if len(chosen) < count and not any(_touch(pair, other) for other in chosen):
                chosen.append(pair)
        said = [f"put {phrase(pair.words)} on {phrase(pair.below_words)}" for pair in chosen]
        text = said[0] if len(said) == 1 else JOINED[int(random.integers(len(JOINED)))].format(*said)
        tokens = tokenize(text)
        if len(tokens) > NUM_TOKENS:
            return None
        meant = [Meant.of(words) for pair in chosen for words in (pair.words, pair.below_words)]
        return Row(meant, self._stages(len(chosen)), tokens=tokens, then=range(1, len(meant)))

    def _stages(self, count: int) -> list[Stage]:
        """Return two stages per object: pick up, put down. Undone steps cost their reward and must be repeated.

        This includes objects that were put down before; the agent returns to these with an empty hand.
        """
        held = [When(Feature.HELD, 2 * k, least=1) for k in range(count)]
        on = [When(Feature.ON, 2 * k, 2 * k + 1, least=1) for k in range(count)]
        part, stages = self.success_reward / (2 * count), []
        wrong = (Go(FAILURE, (STOPPED,)),) if self.stop else ()
        for k in range(count):
            done = Go(2 * k + 1, (on[k],), (held[k],), reward=part)  # the object is in place already
            off = [Go(2 * j, bars=(on[j],), reward=-2 * (k - j) * part) for j in range(k)]
            stages.append(Stage((Go(2 * k + 1, (held[k],), reward=part), done, *wrong, *off), guide=2 * k))
            back = Go(2 * k, bars=(held[k], on[k]), reward=-part)
            off = [replace(way, bars=(*way.bars, held[k]), reward=way.reward - part) for way in off]
            if k < count - 1:
                ways = (Go(2 * k + 2, (on[k],), (held[k],), reward=part), back, *wrong)
            else:
                said = (STOPPED,) if self.stop else ()
                ways = (Go(SUCCESS, (*on, *said), tuple(held), reward=part), *wrong, back)
            stages.append(Stage((*ways, *off), guide=2 * k + 1))
        return stages
