"""The body of an agent."""

from dataclasses import dataclass


@dataclass(frozen=True)
class AgentShape:
    """An upright capsule.

    Attributes:
        radius: [m]
        height: Total [m].
        mass: [kg]
    """

    radius: float = 0.1
    height: float = 1.6
    mass: float = 60.0

    @property
    def half_length(self) -> float:
        """Half the length of the cylinder between the two half balls [m]."""
        return self.height / 2 - self.radius
