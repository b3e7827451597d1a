"""Time steps and sample rate of an environment."""

from dataclasses import dataclass

from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError

MAX_STEP_SECONDS = 3600.0  # [s], maximum length of a step
MAX_SAMPLE_RATE = 10**7  # [Hz], maximum sample rate


@dataclass(frozen=True)
class Timing:
    """The common clock of physics, images and sound.

    Attributes:
        ctrl_dt: Length of one environment step, one image and one sound frame [s]; a whole number of `sim_dt` and of
            samples.
        sim_dt: Length of one physics step [s].
        sample_rate: Sample rate of sound [Hz].

    Raises:
        ConfigError: A value is out of range, or the lengths do not divide exactly.

    Example:
        >>> Timing().substeps, Timing().frame
        (10, 1600)
    """

    ctrl_dt: float = 0.1
    sim_dt: float = 0.01
    sample_rate: int = 16000

    def __post_init__(self) -> None:
        for name in ("ctrl_dt", "sim_dt"):
            check_number(name, getattr(self, name), 1e-6, MAX_STEP_SECONDS)
        check_number("sample_rate", self.sample_rate, 1, MAX_SAMPLE_RATE, integer=True)
        if self.substeps < 1 or abs(self.substeps * self.sim_dt - self.ctrl_dt) > 1e-9 * self.ctrl_dt:
            raise ConfigError(
                f"`ctrl_dt` {self.ctrl_dt} s is not a whole number of `sim_dt` {self.sim_dt} s",
                hint="Choose for example ctrl_dt = 10 * sim_dt.",
            )
        samples = self.ctrl_dt * self.sample_rate
        if abs(samples - self.frame) > 1e-6 or self.frame < 1:
            raise ConfigError(
                f"`ctrl_dt` {self.ctrl_dt} s must hold a whole number of samples, got {samples:g}",
                hint="Change it or `sample_rate` so that it divides exactly.",
            )

    @property
    def substeps(self) -> int:
        """Physics steps per environment step."""
        return round(self.ctrl_dt / self.sim_dt)

    @property
    def frame(self) -> int:
        """Sound samples per environment step."""
        return round(self.ctrl_dt * self.sample_rate)
