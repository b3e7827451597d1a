"""Options of contact sounds."""

from dataclasses import dataclass

from home_mjx.core.checks import check_flag, check_number

STEP_LENGTH_RANGE = (0.1, 2.0)  # [m], minimum and maximum step length


@dataclass(frozen=True)
class ContactSoundConfig:
    """Contact sounds of bodies: footsteps, impacts, scrapes and doors.

    Attributes:
        footsteps: Sounds of agents' steps on the surface under them.
        impacts: Sounds of impacts on agents, movable bodies and doors; needs physics with contacts, not "kinematic".
        scrapes: Sounds of movable bodies that slide; needs physics with contacts, too.
        doors: Creaks of moving leaves and thuds where they stop.
        step_length: Distance between footsteps [m].
        num_transients: Maximum number of simultaneous transient sounds, each traced as a source.
        num_sustained: Maximum number of simultaneous sustained sounds, each traced as a source.

    Raises:
        ConfigError: A value is out of range.

    Example:
        >>> ContactSoundConfig().num_sounds
        6
    """

    footsteps: bool = True
    impacts: bool = True
    scrapes: bool = True
    doors: bool = True
    step_length: float = 0.65
    num_transients: int = 4
    num_sustained: int = 2

    def __post_init__(self) -> None:
        for name in ("footsteps", "impacts", "scrapes", "doors"):
            check_flag(name, getattr(self, name))
        check_number("step_length", self.step_length, *STEP_LENGTH_RANGE)
        for name in ("num_transients", "num_sustained"):
            check_number(name, getattr(self, name), 1, integer=True)

    @property
    def num_sounds(self) -> int:
        """Maximum number of simultaneous sounds."""
        return self.num_transients + self.num_sustained
