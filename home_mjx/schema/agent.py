"""Physical parameters of an agent."""

from dataclasses import dataclass

from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError

AGENT_MARGIN = 0.05  # [m], default clearance of free space beyond the agent's radius


@dataclass(frozen=True)
class AgentBody:
    """An upright capsule with eyes and ears: the only definition of an agent's size, strength and speed.

    Attributes:
        radius: Radius of the capsule [m].
        height: Total height [m].
        mass: Mass [kg].
        eye_height: Height of eyes and ears above the floor [m].
        forward_speed: Forward speed at action 1 [m/s].
        strafe_speed: Sideways speed at action 1 [m/s].
        turn_rate: Turn rate at action 1 [rad/s].
        max_push_force: Maximum force of the motors, in any horizontal direction [N].
        reach: Reach of the hand from the body's axis [m].
        max_lift_mass: Maximum mass of an object that the hand lifts [kg].

    Raises:
        ConfigError: A value is out of range.

    Example:
        >>> AgentBody(radius=0.25, height=1.5).half_length
        0.5
    """

    radius: float = 0.1
    height: float = 1.6
    mass: float = 60.0
    eye_height: float = 1.5
    forward_speed: float = 1.0
    strafe_speed: float = 0.7
    turn_rate: float = 1.5708
    max_push_force: float = 300.0
    reach: float = 1.0
    max_lift_mass: float = 10.0

    def __post_init__(self) -> None:
        for name in (
            "radius",
            "height",
            "mass",
            "forward_speed",
            "strafe_speed",
            "turn_rate",
            "max_push_force",
            "reach",
            "max_lift_mass",
        ):
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
        """Half the length of the cylinder between the two hemispheres [m]."""
        return self.height / 2 - self.radius
