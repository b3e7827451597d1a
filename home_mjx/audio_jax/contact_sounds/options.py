"""What bodies may be heard doing."""

from dataclasses import dataclass

from home_mjx.core.checks import check_flag, check_number

LENGTHS = (0.1, 2.0)  # [m], the shortest and the longest step


@dataclass(frozen=True)
class NoiseConfig:
    """Sounds of bodies: of steps, blows, things that slide, and doors.

    Attributes:
        footsteps: Agents step on what is under them.
        impacts: Agents, movable bodies and doors are struck; needs physics with contacts, not "kinematic".
        scrapes: Movable bodies slide on what they touch; likewise.
        doors: Leaves creak while they turn and thud where they stop.
        step_length: From one footstep to the next [m].
        num_strikes: Short sounds that are heard at once, each traced for itself.
        num_rubs: The same of lasting ones.

    Raises:
        ConfigError: A value cannot be used.

    Example:
        >>> NoiseConfig().num_noises
        6
    """

    footsteps: bool = True
    impacts: bool = True
    scrapes: bool = True
    doors: bool = True
    step_length: float = 0.65
    num_strikes: int = 4
    num_rubs: int = 2

    def __post_init__(self) -> None:
        for name in ("footsteps", "impacts", "scrapes", "doors"):
            check_flag(name, getattr(self, name))
        check_number("step_length", self.step_length, *LENGTHS)
        for name in ("num_strikes", "num_rubs"):
            check_number(name, getattr(self, name), 1, whole=True)

    @property
    def num_noises(self) -> int:
        """All that are heard at once."""
        return self.num_strikes + self.num_rubs
