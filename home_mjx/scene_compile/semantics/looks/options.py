"""Options of the semantic engine."""

from dataclasses import dataclass

from home_mjx.core.checks import check_known, check_number
from home_mjx.errors import ConfigError

COLOR_RULES = ("look", "home")
MATERIAL_RULES = ("largest", "share")
SIZE_RULES = ("log", "home")


@dataclass(frozen=True)
class SemanticOptions:
    """Rules for colours, materials and sizes; part of the cache key.

    Attributes:
        color: `look`: dominant colours of the surface as rendered (texture times diffuse colour, by area and
            opacity), nearest name by CIEDE2000. `home`: mean colour of each slot's whole image or its diffuse colour,
            without the overrides of house.json, nearest name in sRGB.
        material: `max_edge`: the texture of the largest area, as in HoME's paper. `share`: every texture of at least
            `share`, as in HoME's code.
        size: `log`: volume as placed, on a logarithmic scale, within the fine category, or the coarse one if that has
            too few models. `home`: the model's volume within the coarse category.
        share: Minimum share of the area of a colour or, by the rule `share`, of a material.

    Raises:
        ConfigError: A rule is unknown, or the share is not in (0, 1].
    """

    color: str = "look"
    material: str = "largest"
    size: str = "log"
    share: float = 0.2

    def __post_init__(self) -> None:
        check_known("colour rule", (self.color,), COLOR_RULES)
        check_known("material rule", (self.material,), MATERIAL_RULES)
        check_known("size rule", (self.size,), SIZE_RULES)
        check_number("share", self.share, 0, 1)
        if not self.share:
            raise ConfigError("`share` must be more than 0", hint="It is the minimum share of the area, such as 0.2.")


HOME2017 = SemanticOptions(color="home", material="share", size="home")  # the rules of HoME's code of 2017
