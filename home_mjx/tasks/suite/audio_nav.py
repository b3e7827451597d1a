"""AudioNav: go to the sound source.

Chen et al., "SoundSpaces: Audio-Visual Navigation in 3D Environments", 2020 (arXiv:1912.11474): success is `stop`
within 1 m. Moving sources, and distractors: Younes et al., "Catch Me If You Hear Me", 2023 (arXiv:2111.14843).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Array

from home_mjx.audio_jax.auralization.held_out_sounds import HELD_OUT_CLIPS
from home_mjx.audio_jax.auralization.training_sounds import TRAINING_CLIPS
from home_mjx.core.checks import check_flag, check_known, check_number
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.sounds.sound_events import SoundEvent
from home_mjx.tasks.suite.navigation import EXCLUDED_CATEGORIES, NavigationTask, arrival_stage

SPLITS = {
    "heard": ("radio", "ring", "chirp", "knock", "bell", "bursts"),
    "unheard": ("speech", "tone", "alarm", "whistle"),
}
SPLITS["all"] = (*SPLITS["heard"], *SPLITS["unheard"])
SPLITS["training"] = (*SPLITS["heard"], *TRAINING_CLIPS)
SPLITS["held_out"] = (*SPLITS["unheard"], *HELD_OUT_CLIPS)  # other kinds than those of `training`
SPLITS["devices"] = ("talking_0", "whistling_0")  # a radio with speech, a telephone with a tune; of `held_out`
DISTRACTOR_CLIPS = ("hum", "ticking", "noise")  # never targets
SCHEDULES = ("always", "intermittent", "once", "mixed")
EMITTERS = ("place", "object")
NUM_PLACES = 16  # number of candidate places per house; each has a field of distances
TARGET_INDEX, GOAL_INDEX = 1, 2  # indices of descriptors; the first descriptor is hidden


@dataclass(frozen=True)
class AudioNav(NavigationTask):
    """Go to the sound source; no other observation reveals its position.

    Attributes:
        success_distance: Maximum distance to the source on success [m].
        emitter: "place": a point of free floor, `EnvConfig.source_height` above it; "object": any object. With
            `moving_source` it is always a place.
        schedule: "always", "intermittent" (for `duration` of every `period` seconds), "once" (for `duration` at the
            start) or "mixed" (each row draws one of these).
        period: Period [s].
        duration: Duration [s].
        clip_split: Sounds that are targets: a split of `SPLITS`, such as "heard" and "unheard", "training" and
            "held_out", or "devices"; or the name of one of them.
        num_distractors: Number of other places that play one of `DISTRACTOR_CLIPS`, at most 2, or 1 with
            `moving_source`.
        moving_source: The source moves along the shortest path to another place and stays there. Success then requires
            a view of it, however near it is. The expert's guide is the destination of the source.
        source_speed: Speed of a moving source [m/s].
    """

    success_distance: float = 1.0
    emitter: str = "place"
    schedule: str = "always"
    period: float = 3.0
    duration: float = 1.0
    clip_split: str = "heard"
    num_distractors: int = 0
    moving_source: bool = False
    source_speed: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)
        check_known("kind of emitter", [self.emitter], EMITTERS)
        check_known("schedule", [self.schedule], SCHEDULES)
        check_known("split of sounds", [self.clip_split], [*SPLITS, *SPLITS["training"], *SPLITS["held_out"]])
        check_flag("moving_source", self.moving_source)
        check_number("num_distractors", self.num_distractors, 0, 1 if self.moving_source else 2, integer=True)
        for name in ("period", "duration", "source_speed"):
            check_number(name, getattr(self, name), 0.01)

    @property
    def observation_spec(self) -> Specs:
        """Empty: the task adds no observations, as the instruction is the sound itself."""
        return {}

    def observe(self, snapshot: Snapshot, state: RowState) -> dict[str, Array]:
        """Return an empty dictionary."""
        return {}

    @property
    def num_sources(self) -> int:
        """Number of sound sources: the target and the distractors."""
        return 1 + self.num_distractors

    @property
    def clips(self) -> tuple[str, ...]:
        """Clips of the split, and the distracting ones if there are distractors."""
        return (*self.target_clips, *(DISTRACTOR_CLIPS if self.num_distractors else ()))

    @property
    def target_clips(self) -> tuple[str, ...]:
        """Clips that may be targets: those of `clip_split`, or the one that it names."""
        return SPLITS.get(self.clip_split, (self.clip_split,))

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows with target and distractor clips at places or objects, endlessly; none if these are too few."""
        found = self._emitters(view, random)
        count = 1 + self.num_distractors + self.moving_source
        while len(found) >= count:
            order = random.permutation(len(found)).tolist()
            for at in range(len(found) - count + 1):
                yield self._row([found[i] for i in order[at : at + count]], random)

    def _emitters(self, view: HouseView, random: np.random.Generator) -> list[Selector]:
        """Return candidate emitters: objects of categories that can be goals, or `NUM_PLACES` cells off door leaves.

        Objects are only for the option "object" without `moving_source`. There may be fewer cells.
        """
        if self.emitter == "object" and not self.moving_source:
            things = [thing for thing in view.objects if thing.coarse not in EXCLUDED_CATEGORIES]
            return [Selector.objects(object_id=thing.object_id) for thing in things]
        free = np.flatnonzero(~view.graph.at_leaf)
        return [Selector.point(view.graph.place[i].tolist()) for i in random.permutation(free)[:NUM_PLACES]]

    def _row(self, meant: Sequence[Selector], random: np.random.Generator) -> TaskRow:
        """Return the row whose target is the first of `meant`; a moving source's destination and distractors follow."""
        near = self.success_distance
        if self.moving_source:
            there = (
                Condition(Feature.STRAIGHT, TARGET_INDEX, maximum=near),
                Condition(Feature.CLEAR, TARGET_INDEX, minimum=1),
            )
        else:
            there = (Condition(Feature.DISTANCE, TARGET_INDEX, maximum=near),)
        goal = GOAL_INDEX if self.moving_source else TARGET_INDEX
        others = range(len(meant) - self.num_distractors + 1, len(meant) + 1)
        sounds = [
            self._target(random),
            *(SoundEvent(number, str(random.choice(DISTRACTOR_CLIPS))) for number in others),
        ]
        stages = [arrival_stage(there, self.stop, self.success_reward, goal)]
        return TaskRow([Selector.nothing(), *meant], stages, goal, tokenize("go to the sound"), sounds)

    def _target(self, random: np.random.Generator) -> SoundEvent:
        """Return the sound of the target, with a random clip of the split."""
        when = {
            "always": {},
            "intermittent": {"period": self.period, "duration": self.duration},
            "once": {"duration": self.duration},
        }
        kind = str(random.choice(list(when))) if self.schedule == "mixed" else self.schedule
        walk = {"destination": GOAL_INDEX, "speed": self.source_speed} if self.moving_source else {}
        return SoundEvent(TARGET_INDEX, str(random.choice(self.target_clips)), **when[kind], **walk)
