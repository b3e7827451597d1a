"""Options of baking light probes."""

from dataclasses import dataclass

from home_mjx.core.checks import check_number

MIN_SPACING = 0.2  # [m]
MAX_TEXELS = 20.0  # [1/m]


@dataclass(frozen=True)
class ProbeOptions:
    """Options of baking light probes.

    Attributes:
        spacing: Approximate distance between neighbouring probes of a room [m].
        rays: Rays per probe, whose hits all passes share, and per texel.
        texels: Texels per metre on floors, walls and ceilings; 0: none, as if all faces were furniture.
        change: Relative change of the light by the last pass, after which the rest of the series is estimated.
        seed: Seed of the random rotations of rays and of points on lamps.

    Raises:
        ConfigError: An option is out of range.

    Example:
        >>> ProbeOptions(spacing=1.0).rays
        128
    """

    spacing: float = 0.5
    rays: int = 128
    texels: float = 5.0
    change: float = 0.005
    seed: int = 0

    def __post_init__(self) -> None:
        check_number("spacing", self.spacing, MIN_SPACING)
        check_number("rays", self.rays, 8, integer=True)
        check_number("texels", self.texels, 0, MAX_TEXELS)
        check_number("change", self.change, 1e-5, 0.5)
        check_number("seed", self.seed, 0, integer=True)
