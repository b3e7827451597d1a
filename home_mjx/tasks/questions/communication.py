"""Communication: one agent's instruction names the goal room, another agent has to go there.

A channel of single words, with the speaker and listener of Lowe et al., "Multi-Agent Actor-Critic for Mixed
Cooperative-Competitive Environments", 2017 (arXiv:1706.02275).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_known
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.tasks.language.vocabulary import to_word, tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP, SoundEvent
from home_mjx.tasks.suite.navigation import NavigationTask, arrival_stage

LISTENER, SPEAKER = 0, 1
CHANNELS = ("discrete", "audible")


@dataclass(frozen=True)
class Communication(NavigationTask):
    """Task in which the first agent must enter a room that only the second one's instruction names.

    Both agents may say names of rooms, and observe the other one's word after that step. The meaning of words is theirs
    to agree on; the expert says the name of the room.

    Attributes:
        channel: "discrete": the other agent's word is the observation `heard_words`, at any distance. "audible": each
            word is a sound of its own, emitted by its speaker and attenuated by rooms and closed doors. It is observed
            with `audio`, `stft` or `log_mel`; there are no other sounds.
    """

    channel: str = "discrete"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_known("channel", [self.channel], CHANNELS)

    @property
    def speech(self) -> tuple[str, ...]:
        """Actions that say the name of a room type, one per type."""
        return tuple(f"say:{to_word(kind)}" for kind in ROOM_TYPES)

    @property
    def speech_observations(self) -> tuple[str, ...]:
        """Name of the observation of the other agent's last word; none if words are sounds."""
        return ("heard_words",) if self.channel == "discrete" else ()

    @property
    def requires_hearing(self) -> bool:
        """True if words are sounds, as they are then not observed otherwise."""
        return self.channel == "audible"

    @property
    def num_sources(self) -> int:
        """Number of sound sources: both voices if words are sounds, else 1."""
        return 2 if self.channel == "audible" else 1

    @property
    def min_agents(self) -> int:
        """Minimum number of agents: a listener and a speaker."""
        return 2

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows about room types of the house, endlessly in random order.

        Yields none unless two types have different rooms.
        """
        rooms = view.rooms_by_type
        types = np.array(list(rooms), int)
        while len(set(rooms.values())) > 1:
            for kind in random.permutation(types).tolist():
                yield self._row(kind)

    def _row(self, kind: int) -> TaskRow:
        """Return the row whose goal is a room type, which the speaker's instruction names."""
        room = to_word(ROOM_TYPES[kind])
        inside = (Condition(Feature.INSIDE, 0, minimum=1, agent=LISTENER),)
        stage = arrival_stage(inside, self.stop, self.success_reward)
        (code,) = tokenize(room)
        said = tokenize(f"go to the {room}")
        meant, sounds = [Selector.rooms(room_type=kind)], []
        if self.channel == "audible":
            meant += [Selector.agent(LISTENER), Selector.agent(SPEAKER)]
            sounds = [SoundEvent(1, VOICE_CLIP), SoundEvent(2, VOICE_CLIP)]
        return TaskRow(meant, [stage], tokens=said, sounds=sounds, answer=code, instructed_agents=(SPEAKER,))
