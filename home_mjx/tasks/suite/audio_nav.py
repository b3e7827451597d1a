"""AudioNav: go to the sound source.

Chen et al., "SoundSpaces: Audio-Visual Navigation in 3D Environments", 2020 (arXiv:1912.11474): success is `stop`
within 1 m. Moving sources, and distractors: Younes et al., "Catch Me If You Hear Me", 2023 (arXiv:2111.14843).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Array

from home_mjx.core.checks import check_flag, check_known, check_number
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Meant, When
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.rules.words import Feature
from home_mjx.tasks.sounds.row import Sound
from home_mjx.tasks.suite.navigation import NO_GOALS, Navigation, arrive

SPLITS = {
    "heard": ("radio", "ring", "chirp", "knock", "bell", "bursts"),
    "unheard": ("speech", "tone", "alarm", "whistle"),
}
SPLITS["all"] = (*SPLITS["heard"], *SPLITS["unheard"])
DISTRACTING = ("hum", "ticking", "noise")  # never targets
SCHEDULES = ("always", "intermittent", "once")
EMITTERS = ("place", "object")
NUM_PLACES = 16  # number of candidate places per house; each has a field of distances
TARGET, GOAL = 1, 2  # indices of descriptors; the first descriptor is hidden


@dataclass(frozen=True)
class AudioNav(Navigation):
    """Go to the sound source; no other observation reveals its position.

    Attributes:
        success_distance: Maximum distance to the source on success [m].
        emitter: "place": a point of free floor, `EnvConfig.source_height` above it; "object": any object.
        schedule: "always", "intermittent" (for `lasts` of every `every` seconds) or "once" (for `lasts` at the start).
        every: Period [s].
        lasts: Duration [s].
        clip_split: Sounds that are targets: "heard", "unheard" or "all" of `SPLITS`, or the name of one of them.
        distractors: Number of other places that play one of `DISTRACTING`, at most 2, or 1 with `moving`.
        moving: The source moves along the shortest path to another place and stays there. Success then requires a view
            of it, however near it is. The expert's guide is the destination of the source.
        speed: Speed of a moving source [m/s].
    """

    success_distance: float = 1.0
    emitter: str = "place"
    schedule: str = "always"
    every: float = 3.0
    lasts: float = 1.0
    clip_split: str = "heard"
    distractors: int = 0
    moving: bool = False
    speed: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)
        check_known("kind of emitter", [self.emitter], EMITTERS)
        check_known("schedule", [self.schedule], SCHEDULES)
        check_known("split of sounds", [self.clip_split], [*SPLITS, *SPLITS["all"]])
        check_flag("moving", self.moving)
        check_number("distractors", self.distractors, 0, 1 if self.moving else 2, whole=True)
        for name in ("every", "lasts", "speed"):
            check_number(name, getattr(self, name), 0.01)

    @property
    def observation_spec(self) -> Specs:
        """No observations: the instruction is the sound itself."""
        return {}

    def observe(self, snapshot: Snapshot, state: RowState) -> dict[str, Array]:
        """Return no observations."""
        return {}

    @property
    def num_sources(self) -> int:
        """Number of the target and the distractors."""
        return 1 + self.distractors

    @property
    def clips(self) -> tuple[str, ...]:
        """Clips of the split, and the distracting ones if there are distractors."""
        return (*self.sought, *(DISTRACTING if self.distractors else ()))

    @property
    def sought(self) -> tuple[str, ...]:
        """Clips that are targets."""
        return SPLITS.get(self.clip_split, (self.clip_split,))

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield clips at each of the house's places or objects, in a new random order each round."""
        found = self._emitters(view, random)
        count = 1 + self.distractors + self.moving
        while len(found) >= count:
            order = random.permutation(len(found)).tolist()
            for at in range(len(found) - count + 1):
                yield self._row([found[i] for i in order[at : at + count]], random)

    def _emitters(self, view: HouseView, random: np.random.Generator) -> list[Meant]:
        if self.emitter == "object" and not self.moving:
            things = [thing for thing in view.things if COARSE[thing.word(Semantic.COARSE)] not in NO_GOALS]
            return [Meant.thing(object_id=thing.object_id) for thing in things]
        free = np.flatnonzero(~view.graph.at_leaf)
        return [Meant.at(view.graph.place[i].tolist()) for i in random.permutation(free)[:NUM_PLACES]]

    def _row(self, meant: Sequence[Meant], random: np.random.Generator) -> Row:
        near = self.success_distance
        if self.moving:
            there = When(Feature.STRAIGHT, TARGET, most=near), When(Feature.CLEAR, TARGET, least=1)
        else:
            there = (When(Feature.DISTANCE, TARGET, most=near),)
        goal = GOAL if self.moving else TARGET
        others = range(len(meant) - self.distractors + 1, len(meant) + 1)
        sounds = [self._target(random), *(Sound(number, str(random.choice(DISTRACTING))) for number in others)]
        stages = [arrive(there, self.stop, self.success_reward, goal)]
        return Row([Meant.hidden(), *meant], stages, goal, tokenize("go to the sound"), sounds)

    def _target(self, random: np.random.Generator) -> Sound:
        when = {"always": {}, "intermittent": {"every": self.every, "lasts": self.lasts}, "once": {"lasts": self.lasts}}
        walk = {"towards": GOAL, "speed": self.speed} if self.moving else {}
        return Sound(TARGET, str(random.choice(self.sought)), **when[self.schedule], **walk)
