"""Communication: one agent knows where to go, another one has to go there.

A channel of single words, as in Lowe et al., "Multi-Agent Actor-Critic for Mixed Cooperative-Competitive Environments",
2017 (arXiv:1706.02275), whose speaker and listener these are.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.core.checks import check_known
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.tasks.language.vocabulary import spoken, tokenize
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Meant, When
from home_mjx.tasks.rules.words import Feature
from home_mjx.tasks.sounds.row import VOICE, Sound
from home_mjx.tasks.suite.navigation import Navigation, arrive

LISTENER, SPEAKER = 0, 1
CHANNELS = ("discrete", "audible")


@dataclass(frozen=True)
class Communication(Navigation):
    """The first agent goes into a room of a type that only the second one is told.

    Both may say names of rooms, and hear what the other one has said after that step. Which word means what is theirs
    to agree on; the expert says the name of the room.

    Attributes:
        channel: "discrete": the other one's word is the observation `heard_words`, wherever it is. "audible": each word
            is a sound of its own, which goes out from who says it through the house, so that rooms and shut doors
            muffle it: hear it with `audio`, `stft` or `log_mel`. Nothing else sounds.
    """

    channel: str = "discrete"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_known("channel", [self.channel], CHANNELS)

    @property
    def speech(self) -> tuple[str, ...]:
        """Names of rooms."""
        return tuple(f"say:{spoken(kind)}" for kind in ROOM_TYPES)

    @property
    def hears(self) -> tuple[str, ...]:
        """Each other, unless words are sounds."""
        return ("heard_words",) if self.channel == "discrete" else ()

    @property
    def needs_ears(self) -> bool:
        """Words that are sounds are observed nowhere else."""
        return self.channel == "audible"

    @property
    def num_sources(self) -> int:
        """Of words that are sounds, both voices."""
        return 2 if self.channel == "audible" else 1

    @property
    def least_agents(self) -> int:
        """A listener and a speaker."""
        return 2

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Types of rooms that the house has, again and again in another order."""
        types = np.unique(view.room_types[view.room_types >= 0])
        while len(types) > 1:
            for kind in random.permutation(types).tolist():
                yield self._row(kind)

    def _row(self, kind: int) -> Row:
        room = spoken(ROOM_TYPES[kind])
        inside = (When(Feature.INSIDE, 0, least=1, agent=LISTENER),)
        stage = arrive(inside, self.stop, self.success_reward)
        (code,) = tokenize(room)
        said = tokenize(f"go to the {room}")
        meant, sounds = [Meant.space(room_type=kind)], []
        if self.channel == "audible":
            meant += [Meant.someone(LISTENER), Meant.someone(SPEAKER)]
            sounds = [Sound(1, VOICE), Sound(2, VOICE)]
        return Row(meant, [stage], tokens=said, sounds=sounds, answer=code, told=(SPEAKER,))
