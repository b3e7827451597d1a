"""Variants of generated houses: preset of the home, and level of detail of its models."""

from collections.abc import Mapping
from dataclasses import dataclass

from home_mjx.core.checks import check_known
from home_mjx.datasets.seeds import house_id
from home_procgen.primitives.detail import DETAILS

GENERATOR_VERSION = 5  # increase it whenever the same seed would produce another file


@dataclass(frozen=True)
class Equipment:
    """Amount of objects in rooms.

    Attributes:
        extras: Factor on the probability of optional objects.
        small_objects: Factor on the number of small objects that lie about.
        has_fittings: Whether there are switches, sockets, curtains and radiators.
    """

    extras: float = 1.0
    small_objects: float = 1.0
    has_fittings: bool = True


FULL_EQUIPMENT = Equipment()


@dataclass(frozen=True)
class Preset:
    """Size and equipment of homes.

    Attributes:
        code: Number of the preset in house ids.
        detail: Level of detail unless another one is chosen.
        room_counts: Number of rooms of homes of one storey -> weight; None: homes of any size.
        equipment: Amount of objects.
        is_plain: Whether the home has no outdoor rooms, roof, garden and neighbours, and one window per room.
    """

    code: int
    detail: str = DETAILS[0]
    room_counts: Mapping[int, float] | None = None
    equipment: Equipment = FULL_EQUIPMENT
    is_plain: bool = False


PRESETS: Mapping[str, Preset] = {
    "home": Preset(0),
    "flat": Preset(1, "low", {3: 1.0, 4: 1.5, 5: 2.0, 6: 1.5}, Equipment(0.5, 0.2, False), True),
}


@dataclass(frozen=True)
class Variant:
    """Variant of generated houses; a seed stands for another house in each.

    Attributes:
        preset: A key of `PRESETS`.
        detail: One of `DETAILS`; "" for that of the preset.

    Raises:
        ConfigError: The preset or the detail is unknown.

    Example:
        >>> Variant("flat")
        Variant(preset='flat', detail='low')
    """

    preset: str = "home"
    detail: str = ""

    def __post_init__(self) -> None:
        check_known("preset of generated houses", [self.preset], PRESETS)
        if not self.detail:
            object.__setattr__(self, "detail", PRESETS[self.preset].detail)
        check_known("detail of generated houses", [self.detail], DETAILS)

    @property
    def settings(self) -> dict[str, str]:
        """Preset and detail, without those of the preset `home`."""
        own = {"preset": self.preset, "detail": self.detail}
        return own if own != {"preset": "home", "detail": DETAILS[0]} else {}

    @property
    def number(self) -> int:
        """Number that distinguishes the variant in house ids."""
        return GENERATOR_VERSION << 8 | PRESETS[self.preset].code << 4 | DETAILS.index(self.detail)

    def house_id(self, seed: int) -> str:
        """Return the id of a seed's house.

        Example:
            >>> Variant("flat").house_id(10)[-6:]
            '00000a'
        """
        return house_id(seed, self.number)

    @property
    def text(self) -> str:
        """Name of the variant in folders and messages, such as `v4-flat-low`."""
        return "-".join((f"v{GENERATOR_VERSION}", *self.settings.values()))

    @property
    def options(self) -> str:
        """Options of a name of generated houses, such as `preset=flat&detail=low`."""
        return f"preset={self.preset}&detail={self.detail}"


HOME_VARIANT = Variant()
