"""Which houses of a dataset: splits by a hash of the house's id, and filters by what is in the house."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from numbers import Real

from home_mjx.core.checks import check_known, check_names
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.geometry.polygons import polygon_area
from home_mjx.schema.categories import COARSE, FINE
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.semantic import Semantic

SPLITS: Mapping[str, float] = {"train": 0.8, "val": 0.1, "test": 0.1}

Range = tuple[float, float]  # least and most, both allowed


def split_of(house_id: str, fractions: Mapping[str, float] = SPLITS) -> str:
    """The split that a house belongs to, the same for ever and whatever other houses there are.

    Args:
        house_id: The house.
        fractions: Part of all houses in each split; they add up to 1.

    Example:
        >>> split_of("0004d52d1aeeb8ae6de39d6bd993e992")
        'test'
    """
    if abs(sum(fractions.values()) - 1) > 1e-9 or min(fractions.values()) < 0:
        raise ConfigError(f"fractions of splits must add up to 1, got {dict(fractions)}")
    at = int.from_bytes(hashlib.sha256(house_id.encode()).digest()[:8], "big") / 2**64
    names = list(fractions)
    for name in names[:-1]:
        at -= fractions[name]
        if at < 0:
            return name
    return names[-1]


def select_ids(ids: Iterable[str], split: str | None) -> list[str]:
    """Those of some houses that belong to a split of `SPLITS`; all if it is None.

    Raises:
        ConfigError: There is no such split.
    """
    if split is None:
        return list(ids)
    check_known("split", [split], SPLITS)
    return [house_id for house_id in ids if split_of(house_id) == split]


@dataclass(frozen=True)
class HouseFilter:
    """What a house must have; None allows anything.

    Attributes:
        levels: Number of levels.
        rooms: Number of rooms, of all levels.
        area: Floor area of all rooms [m^2]; where rooms nest, it counts twice.
        categories: Fine or coarse categories, of each of which it must have an object.

    Example:
        >>> HouseFilter(levels=(1, 1), rooms=(3, 8), categories=("bed", "toilet"))
        HouseFilter(levels=(1, 1), rooms=(3, 8), area=None, categories=('bed', 'toilet'))
    """

    levels: Range | None = None
    rooms: Range | None = None
    area: Range | None = None
    categories: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_names("category", self.categories, {*FINE, *COARSE})
        for name in ("levels", "rooms", "area"):
            limits = getattr(self, name)
            if limits is not None and not _is_range(limits):
                raise ConfigError(f"`{name}` must be (least, most), got {limits}")

    def accepts(self, house: CompiledHouse) -> bool:
        """Whether a house has all that."""
        area = sum(polygon_area(polygon) for polygon in house.rooms.polygon)
        sizes = ((house.report["levels"], self.levels), (len(house.rooms.type), self.rooms), (area, self.area))
        fits = all(limits is None or limits[0] <= size <= limits[1] for size, limits in sizes)
        return fits and set(self.categories) <= _categories(house)


def _is_range(limits: object) -> bool:
    if not isinstance(limits, tuple | list) or len(limits) != 2 or not all(isinstance(x, Real) for x in limits):
        return False
    return limits[0] <= limits[1]


def _categories(house: CompiledHouse) -> set[str]:
    """Fine and coarse categories of the objects of a house."""
    rows = house.semantics[house.semantics[:, Semantic.OBJECT] >= 0]
    fine, coarse = rows[:, Semantic.FINE].tolist(), rows[:, Semantic.COARSE].tolist()
    return {FINE[i] for i in fine if i >= 0} | {COARSE[i] for i in coarse if i >= 0}
