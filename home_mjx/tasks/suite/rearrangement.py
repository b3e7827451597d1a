"""Tasks with hands: bring objects somewhere, and put objects on others.

Szot et al., "Habitat 2.0: Training Home Assistants to Rearrange their Habitat", 2021 (arXiv:2106.14405); Batra et al.,
"Rearrangement: A Challenge for Embodied AI", 2020 (arXiv:2011.01975).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Array

from home_mjx.core.checks import check_flag, check_known, check_number
from home_mjx.errors import ConfigError
from home_mjx.schema.agent import AgentBody
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.language.phrases import attribute_text, draw_identifying_words, identify_objects, noun_phrase
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import FAILURE, NUM_TOKENS, SUCCESS, Attribute, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.suite.navigation import EXCLUDED_CATEGORIES, STOP_CONDITION, NavigationTask
from home_mjx.tasks.suite.portable_objects import PortableObject, box_gap, find_portable_objects, is_on, is_receptacle
from home_mjx.tasks.suite.target_position import TARGET_POSITION, TARGET_SPEC, observe_target

DESTINATIONS = ("object", "room", "start")  # kinds of destinations
MAX_OBJECTS = 2  # maximum number of objects: a row has four descriptors, two per object
SEQUENCE_TEMPLATES = ("{} and {}", "{} then {}")
Words = dict[Attribute, int]
Pose = tuple[Sequence[float], float]  # on the floor [m], yaw [rad]


@dataclass(frozen=True)
class ManipulationTask(NavigationTask):
    """Options that tasks with hands share.

    Attributes:
        max_mass: Maximum mass of an object to carry [kg].
        max_size: Maximum extent of an object to carry [m].
        gives_positions: Add the observation `target_position`, the position of the stage's target: first of the object
            to pick up, then of its destination, as Habitat 2.0 gives both.
    """

    max_mass: float = AgentBody().max_lift_mass
    max_size: float = 0.5
    gives_positions: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check_flag("gives_positions", self.gives_positions)
        for limit in ("max_mass", "max_size"):
            check_number(limit, getattr(self, limit), 0)

    @property
    def requires_hands(self) -> bool:
        """Always True."""
        return True

    @property
    def observation_spec(self) -> Specs:
        """Specs of the row task, and that of `target_position` with `gives_positions`."""
        given = {TARGET_POSITION: TARGET_SPEC} if self.gives_positions else {}
        return {**super().observation_spec, **given}

    def observe(self, snapshot: Snapshot, state: RowState) -> dict[str, Array]:
        """Return the observations of `observation_spec`."""
        given = {TARGET_POSITION: observe_target(snapshot, state)} if self.gives_positions else {}
        return {**super().observe(snapshot, state), **given}

    def _describe_portables(self, view: HouseView, random: np.random.Generator) -> list[tuple[PortableObject, Words]]:
        """Return portable objects that attribute values identify uniquely, each with a smallest set of such values."""
        things = find_portable_objects(view, self.max_mass, self.max_size)
        told = [(thing, draw_identifying_words(view.objects, thing.object, random)) for thing in things]
        return [(thing, words) for thing, words in told if words is not None]


@dataclass(frozen=True)
class Fetch(ManipulationTask):
    """Pick up an object and bring it to another one, into a room, or to the start of the episode.

    Attributes:
        success_distance: Maximum distance to the destination on success [m].
        destinations: Kinds of destinations, from `DESTINATIONS`.
    """

    success_distance: float = 1.0
    destinations: tuple[str, ...] = field(default=DESTINATIONS)

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)
        if not isinstance(self.destinations, tuple) or not self.destinations:
            raise ConfigError(f"`destinations` must be a tuple of {', '.join(DESTINATIONS)}, got {self.destinations!r}")
        check_known("place", self.destinations, DESTINATIONS)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows of objects and random destinations, endlessly.

        None if no object to carry, or no object as destination, can be identified; the latter for all `destinations`.
        None, too, if no object has a destination: those on the same spot or in the same type of room are none.
        """
        told = self._choose_objects(view, random)
        goals = [thing for thing in view.objects if thing.coarse not in EXCLUDED_CATEGORIES]
        named = identify_objects(view.objects, goals, random)
        if not named:
            return
        goals = [goal for goal, _ in named]
        told = [item for item in told if self._has_destination(view, item[0], goals)]
        while told:
            for at in random.permutation(len(told)).tolist():
                thing, words = told[at]
                place = self.destinations[int(random.integers(len(self.destinations)))]
                if place == "object":
                    yield from self._to_thing(thing, words, named[int(random.integers(len(named)))])
                elif place == "room":
                    yield from self._to_room(view, thing, words, random)
                else:
                    yield self._to_start(view, thing, words, random)

    def _choose_objects(self, view: HouseView, random: np.random.Generator) -> Sequence[tuple[PortableObject, Words]]:
        """Return the objects to bring, each with words that identify it."""
        return self._describe_portables(view, random)

    def _has_destination(self, view: HouseView, thing: PortableObject, goals: Sequence[HouseObject]) -> bool:
        """Return whether any of `destinations` is possible for an object; `goals` are the objects to bring it to."""
        return (
            "start" in self.destinations
            or ("room" in self.destinations and bool(self._other_rooms(view, thing)))
            or ("object" in self.destinations and any(self._is_apart(thing, goal) for goal in goals))
        )

    def _is_apart(self, thing: PortableObject, goal: HouseObject) -> bool:
        """Return whether an object is farther from another one than twice `success_distance`; not from itself."""
        return bool(box_gap(thing.object, goal) > 2 * self.success_distance)

    def _other_rooms(self, view: HouseView, thing: PortableObject) -> list[int]:
        """Return the types of rooms in the house that an object's room does not have; none if it is unknown."""
        own = thing.object.room_types
        return [kind for kind in view.rooms_by_type if kind not in own] if own else []

    def _to_thing(self, thing: PortableObject, words: Words, goal: tuple[HouseObject, Words]) -> Iterator[TaskRow]:
        """Yield the row to bring an object to another one; none if they are within twice `success_distance` already."""
        if self._is_apart(thing, goal[0]):
            near = Condition(Feature.DISTANCE, 1, maximum=self.success_distance)
            yield self._row(thing, words, Selector.objects_with(goal[1]), near, f"to {noun_phrase(goal[1])}")

    def _to_room(
        self, view: HouseView, thing: PortableObject, words: Words, random: np.random.Generator
    ) -> Iterator[TaskRow]:
        """Yield the row to bring an object into another type of room; none without one, or if its own is unknown."""
        others = self._other_rooms(view, thing)
        if others:
            kind = others[int(random.integers(len(others)))]
            inside = Condition(Feature.INSIDE, 1, minimum=1)
            yield self._row(
                thing,
                words,
                Selector.rooms(room_type=kind),
                inside,
                f"to the {attribute_text(Attribute.ROOM_TYPE, kind)}",
            )

    def _to_start(self, view: HouseView, thing: PortableObject, words: Words, random: np.random.Generator) -> TaskRow:
        """Return the row to bring an object to its random start pose."""
        free = view.graph.place[~view.graph.at_leaf]
        start = free[int(random.integers(len(free)))].tolist()
        near = Condition(Feature.DISTANCE, 1, maximum=self.success_distance)
        return self._row(thing, words, Selector.point(start), near, "here", (start, random.uniform(-np.pi, np.pi)))

    def _row(
        self,
        thing: PortableObject,
        words: Words,
        goal: Selector,
        there: Condition,
        where: str,
        pose: Pose | None = None,
    ) -> TaskRow:
        """Return the row with two stages: hold the object, then hold it where the condition `there` is met.

        Half of `success_reward` is paid for each; dropping the object takes the first half back and begins anew. With
        `stop`, the second stage needs it, and any other `stop` fails. `pose` is the start; None: any.
        """
        held, half = Condition(Feature.HELD, 0, minimum=1), self.success_reward / 2
        said, wrong = ((STOP_CONDITION,), (Transition(FAILURE, (STOP_CONDITION,)),)) if self.stop else ((), ())
        back = Transition(0, forbid=(held,), reward=-half)  # dropping the object costs the first reward
        first = TaskStage((Transition(1, (held,), reward=half), *wrong), guide=0)
        done = Transition(SUCCESS, (held, there, *said), self._forbid(thing), reward=half)
        second = TaskStage((done, *wrong, back), guide=1)
        tokens = tokenize(f"bring {self._say(thing, words)} {where}")
        return TaskRow(
            [Selector.objects_with(words), goal, *self._others(thing)],
            [first, second],
            tokens=tokens,
            later_goals=(1,),
            start_pose=pose,
        )

    def _say(self, thing: PortableObject, words: Words) -> str:
        """Return the noun phrase of an object."""
        return noun_phrase(words)

    def _others(self, thing: PortableObject) -> Sequence[Selector]:
        """Return the descriptors after those of the object and its destination."""
        return ()

    def _forbid(self, thing: PortableObject) -> tuple[Condition, ...]:
        """Return conditions that must not hold on success."""
        return ()


@dataclass(frozen=True)
class ObjectPlacement:
    """An object, the receptacle to put it on, and the words that identify each."""

    object: PortableObject
    words: Words
    receptacle: HouseObject
    receptacle_words: Words


def _conflict(pair: ObjectPlacement, other: ObjectPlacement) -> bool:
    """Return whether placements share an object, or an object is on the other's receptacle and might fall off."""
    same = {pair.object.object.object_id, pair.receptacle.object_id} & {
        other.object.object.object_id,
        other.receptacle.object_id,
    }
    return bool(same) or is_on(pair.object.object, other.receptacle) or is_on(other.object.object, pair.receptacle)


@dataclass(frozen=True)
class Rearrange(ManipulationTask):
    """Put objects on others, and release them there.

    Attributes:
        max_objects: Maximum number of objects, 1 or 2.
    """

    max_objects: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("max_objects", self.max_objects, 1, MAX_OBJECTS, integer=True)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows of random objects and receptacles, distinct within a row, endlessly; none without such pairs."""
        told = self._describe_portables(view, random)
        pairs = list(self._pairs(view, told, random))
        while pairs:
            count = int(random.integers(1, self.max_objects + 1))
            chosen = [pairs[i] for i in random.permutation(len(pairs))]
            row = self._combine_pairs(chosen, count, random)
            if row is not None:
                yield row

    def _pairs(
        self, view: HouseView, told: list[tuple[PortableObject, Words]], random: np.random.Generator
    ) -> Iterator[ObjectPlacement]:
        """Yield pairs of an object and a receptacle that has room for it and on which it is not."""
        below = [thing for thing in view.objects if is_receptacle(view, thing, {p.object.object_id for p, _ in told})]
        named = identify_objects(view.objects, below, random)
        for portable, words in told:
            for thing, others in named:
                cells = view.put_cells(view.instance_of(thing), view.plan_radius(portable.instance))[0]
                if len(cells) and not is_on(portable.object, thing):
                    yield ObjectPlacement(portable, words, thing, others)

    def _combine_pairs(self, pairs: list[ObjectPlacement], count: int, random: np.random.Generator) -> TaskRow | None:
        """Return the first `count` pairs without conflicts, in their order, as one row; they may be fewer.

        The first pair is always one of them. None if the instruction exceeds `NUM_TOKENS`.
        """
        chosen: list[ObjectPlacement] = []
        for pair in pairs:
            if len(chosen) < count and not any(_conflict(pair, other) for other in chosen):
                chosen.append(pair)
        said = [f"put {noun_phrase(pair.words)} on {noun_phrase(pair.receptacle_words)}" for pair in chosen]
        text = (
            said[0]
            if len(said) == 1
            else SEQUENCE_TEMPLATES[int(random.integers(len(SEQUENCE_TEMPLATES)))].format(*said)
        )
        tokens = tokenize(text)
        if len(tokens) > NUM_TOKENS:
            return None
        meant = [Selector.objects_with(words) for pair in chosen for words in (pair.words, pair.receptacle_words)]
        return TaskRow(meant, self._stages(len(chosen)), tokens=tokens, later_goals=range(1, len(meant)))

    def _stages(self, count: int) -> list[TaskStage]:
        """Return two stages per object, each for an equal share of `success_reward`: pick up, put down.

        Undone stages cost their reward and are repeated, also those of earlier objects, with an empty hand.
        """
        held = [Condition(Feature.HELD, 2 * k, minimum=1) for k in range(count)]
        on = [Condition(Feature.ON, 2 * k, 2 * k + 1, minimum=1) for k in range(count)]
        part, stages = self.success_reward / (2 * count), []
        wrong = (Transition(FAILURE, (STOP_CONDITION,)),) if self.stop else ()
        for k in range(count):
            done = Transition(2 * k + 1, (on[k],), (held[k],), reward=part)  # the object is in place already
            off = [Transition(2 * j, forbid=(on[j],), reward=-2 * (k - j) * part) for j in range(k)]
            stages.append(TaskStage((Transition(2 * k + 1, (held[k],), reward=part), done, *wrong, *off), guide=2 * k))
            back = Transition(2 * k, forbid=(held[k], on[k]), reward=-part)
            off = [replace(way, forbid=(*way.forbid, held[k]), reward=way.reward - part) for way in off]
            if k < count - 1:
                ways = (Transition(2 * k + 2, (on[k],), (held[k],), reward=part), back, *wrong)
            else:
                said = (STOP_CONDITION,) if self.stop else ()
                ways = (Transition(SUCCESS, (*on, *said), tuple(held), reward=part), *wrong, back)
            stages.append(TaskStage((*ways, *off), guide=2 * k + 1))
        return stages
