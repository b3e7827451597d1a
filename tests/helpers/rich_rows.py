"""Rows that use all that a row has room for, so that whatever can be wrong with one can be tried."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import (
    FAILURE,
    SUCCESS,
    Feature,
    Go,
    HouseView,
    Meant,
    Navigation,
    Row,
    Sound,
    Stage,
    When,
    tokenize,
)


@dataclass(frozen=True)
class Rich(Navigation):
    """Go to a thing that can be seen, then into a room; or to a place, and say a word."""

    @property
    def speech(self) -> tuple[str, ...]:
        """One word."""
        return ("say:yes",)

    @property
    def hears(self) -> tuple[str, ...]:
        """What the oracle says."""
        return ("reply",)

    @property
    def clips(self) -> tuple[str, ...]:
        """What sounds."""
        return ("bell",)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Two rows."""
        thing = next(thing for thing in view.things if view.can_be_seen(thing) and thing.coarse == "chair")
        room = int(view.room_types[view.room_types >= 0][0])
        places = view.graph.place[np.flatnonzero(~view.graph.at_leaf)[[0, -1]]].tolist()
        stopped, late = When(Feature.STOPPED, least=1), When(Feature.TIME, least=40)
        near = When(Feature.DISTANCE, 0, most=1.0), When(Feature.SEEN, 0, least=1)
        there = When(Feature.INSIDE, 1, least=1), When(Feature.STRAIGHT, 3, agent=0, most=5.0)
        stages = [
            Stage((Go(1, near, bars=(stopped,), reward=0.5), Go(FAILURE, (stopped,)), Go(FAILURE, (late,))), guide=0),
            Stage((Go(SUCCESS, (*there, stopped), reward=2.5), Go(0, (late,))), guide=1),
        ]
        meant = [
            Meant.thing(coarse=thing.word(Semantic.COARSE), object_id=thing.object_id),
            Meant.space(room_type=room),
            Meant.at(places[0]),
            Meant.someone(0),
        ]
        yes, no = tokenize("yes no")
        sounds = [Sound(2, "bell", every=3.0, lasts=1.0, gain=0.5, towards=0, speed=0.4)]
        talk = {"answer": yes, "told": (0,), "oracle": [(yes, no)], "ask": 1}
        yield Row(meant, stages, tokens=tokenize("find the chair"), sounds=sounds, then=(1,), **talk)
        said = When(Feature.SAID, least=yes, most=yes)
        beside = When(Feature.BESIDE, 1, 1, most=0.5), When(Feature.CLEAR, 1, least=1), When(Feature.TOUCHED, most=0)
        stages = [Stage((Go(SUCCESS, (said,), reward=1.0), Go(FAILURE, beside)), guide=0)]
        yield Row([Meant.at(places[1]), meant[0]], stages, sounds=[Sound(1, "bell")])
