"""Options of the semantic engine."""

from dataclasses import dataclass

from home_mjx.core.checks import check_known, check_number
from home_mjx.errors import ConfigError

MATERIAL_RULES = ("largest", "share")


@dataclass(frozen=True)
class SemanticOptions:
    """Rules for colours and materials; part of the cache key.

    Colours are the dominant ones of a surface as rendered: texture times diffuse colour, by area and opacity, with the
    nearest name by CIEDE2000. Sizes compare the volume as placed, on a logarithmic scale, with the fine category, or
    with the coarse one if the fine one has too few models.

    Attributes:
        material: `largest`: the texture of the largest area, as in HoME's paper. `share`: every texture of at least
            `share`, as in HoME's code.
        share: Minimum share of the area of a colour or, by the rule `share`, of a material.

    Raises:
        ConfigError: A rule is unknown, or the share is not in (0, 1].
    """

    material: str = "largest"
    share: float = 0.2

    def __post_init__(self) -> None:
        check_known("material rule", (self.material,), MATERIAL_RULES)
        check_number("share", self.share, 0, 1)
        if not self.share:
            raise ConfigError("`share` must be more than 0", hint="It is the minimum share of the area, such as 0.2.")
