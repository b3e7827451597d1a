"""Rows that use all that a row has room for, so that whatever can be wrong with one can be tried."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language import tokenize
from home_mjx.tasks.rules import (
    FAILURE,
    SUCCESS,
    Condition,
    Feature,
    HouseView,
    Selector,
    SoundEvent,
    TaskRow,
    TaskStage,
    Transition,
)
from home_mjx.tasks.suite import NavigationTask


@dataclass(frozen=True)
class Rich(NavigationTask):
    """Go to a thing that can be seen, then into a room; or to a place, and say a word."""

    @property
    def speech(self) -> tuple[str, ...]:
        """One word."""
        return ("say:yes",)

    @property
    def speech_observations(self) -> tuple[str, ...]:
        """What the oracle says."""
        return ("reply",)

    @property
    def clips(self) -> tuple[str, ...]:
        """What sounds."""
        return ("bell",)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Two rows."""
        thing = next(thing for thing in view.objects if view.is_visible(thing) and thing.coarse == "chair")
        room = next(iter(view.rooms_by_type))
        places = view.graph.place[np.flatnonzero(~view.graph.at_leaf)[[0, -1]]].tolist()
        stopped, late = Condition(Feature.STOPPED, minimum=1), Condition(Feature.TIME, minimum=40)
        near = Condition(Feature.DISTANCE, 0, maximum=1.0), Condition(Feature.SEEN, 0, minimum=1)
        there = Condition(Feature.INSIDE, 1, minimum=1), Condition(Feature.STRAIGHT, 3, agent=0, maximum=5.0)
        stages = [
            TaskStage(
                (
                    Transition(1, near, forbid=(stopped,), reward=0.5),
                    Transition(FAILURE, (stopped,)),
                    Transition(FAILURE, (late,)),
                ),
                guide=0,
            ),
            TaskStage((Transition(SUCCESS, (*there, stopped), reward=2.5), Transition(0, (late,))), guide=1),
        ]
        meant = [
            Selector.objects(coarse=thing.semantic(Semantic.COARSE), object_id=thing.object_id),
            Selector.rooms(room_type=room),
            Selector.point(places[0]),
            Selector.agent(0),
        ]
        yes, no = tokenize("yes no")
        sounds = [SoundEvent(2, "bell", period=3.0, duration=1.0, gain=0.5, destination=0, speed=0.4)]
        talk = {"answer": yes, "instructed_agents": (0,), "oracle": [(yes, no)], "num_identifying_questions": 1}
        yield TaskRow(meant, stages, tokens=tokenize("find the chair"), sounds=sounds, later_goals=(1,), **talk)
        said = Condition(Feature.SAID, minimum=yes, maximum=yes)
        beside = (
            Condition(Feature.BESIDE, 1, 1, maximum=0.5),
            Condition(Feature.CLEAR, 1, minimum=1),
            Condition(Feature.TOUCHED, maximum=0),
        )
        stages = [TaskStage((Transition(SUCCESS, (said,), reward=1.0), Transition(FAILURE, beside)), guide=0)]
        yield TaskRow([Selector.point(places[1]), meant[0]], stages, sounds=[SoundEvent(1, "bell")])
