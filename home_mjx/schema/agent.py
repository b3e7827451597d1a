"""The body of an agent."""

from dataclasses import dataclass

from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError


@dataclass(frozen=True)
class Body:
    """An upright capsule with eyes and ears: the one source of an agent's size.

    Attributes:
        radius: [m]
        height: Total [m].
        mass: [kg]
        eye_height: Of eyes and ears above the floor [m].

    Raises:
        ConfigError: A value cannot be used.

    Example:
        >>> Body(radius=0.25, height=1.5).half_length
        0.5
    """

    radius: float = 0.1
    height: float = 1.6
    mass: float = 60.0
    eye_height: float = 1.5

    def __post_init__(self) -> None:
        for name in ("radius", "height", "mass"):
            check_number(f"body.{name}", getattr(self, name), 1e-6)
        check_number("body.eye_height", self.eye_height, 0)
        if self.height <= 2 * self.radius:
            raise ConfigError(
                f"`body.height` {self.height} m is not above twice `body.radius` {self.radius} m",
                hint="A capsule is taller than it is wide.",
            )
        if self.eye_height > self.height:
            raise ConfigError(
                f"`body.eye_height` {self.eye_height} m is above `body.height` {self.height} m",
                hint="Eyes are part of the body: make it taller.",
            )

    @property
    def half_length(self) -> float:
        """Half the length of the cylinder between the two half balls [m]."""
        return self.height / 2 - self.radius
