"""Selection of houses by their contents."""

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real

import numpy as np
from jaxtyping import Int

from home_mjx.core.checks import check_names
from home_mjx.errors import ConfigError
from home_mjx.geometry.polygons import polygon_area
from home_mjx.schema.categories import COARSE, FINE
from home_mjx.schema.compiled import CompiledHouse, RoomTable
from home_mjx.schema.semantic import Semantic

ClosedRange = tuple[float, float]  # minimum and maximum, both inclusive


@dataclass(frozen=True)
class HouseFilter:
    """Required properties of a house; None allows any value.

    Attributes:
        levels: Number of levels, also those without rooms.
        rooms: Number of rooms, of all levels.
        area: Floor area of all rooms [m^2]; the overlap of nested rooms counts twice.
        categories: Fine or coarse categories; the house must have an object of each.

    Example:
        >>> HouseFilter(levels=(1, 1), rooms=(3, 8), categories=("bed", "toilet"))
        HouseFilter(levels=(1, 1), rooms=(3, 8), area=None, categories=('bed', 'toilet'))
    """

    levels: ClosedRange | None = None
    rooms: ClosedRange | None = None
    area: ClosedRange | None = None
    categories: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_names("category", self.categories, {*FINE, *COARSE})
        for name in ("levels", "rooms", "area"):
            limits = getattr(self, name)
            if limits is not None and not _is_range(limits):
                raise ConfigError(f"`{name}` must be (minimum, maximum), got {limits}")

    def accepts(self, house: CompiledHouse) -> bool:
        """Return whether a compiled house has all required properties; True for a filter without any."""
        return self.matches(summarize_contents(house.report, house.rooms, house.semantics))

    def matches(self, contents: "HouseContents") -> bool:
        """Return whether contents meet all requirements; minima and maxima are inclusive. See `accepts`."""
        sizes = ((contents.levels, self.levels), (contents.rooms, self.rooms), (contents.area, self.area))
        met = all(limits is None or limits[0] <= size <= limits[1] for size, limits in sizes)
        return met and set(self.categories) <= contents.categories


@dataclass(frozen=True)
class HouseContents:
    """Properties of a house that a `HouseFilter` tests.

    Attributes:
        levels: Number of levels.
        rooms: Number of rooms.
        area: Floor area of all rooms [m^2].
        categories: Fine and coarse categories of its objects.
    """

    levels: int
    rooms: int
    area: float
    categories: frozenset[str]


def summarize_contents(
    report: Mapping[str, int], rooms: RoomTable, semantics: Int[np.ndarray, "q columns"]
) -> HouseContents:
    """Return a compiled house's properties that a `HouseFilter` uses; of `report`, only "levels" is read."""
    area = sum(polygon_area(polygon) for polygon in rooms.polygon)
    return HouseContents(report["levels"], len(rooms.type), area, _categories(semantics))


def _is_range(limits: object) -> bool:
    """Return whether a value is a tuple or list of two real numbers, the first at most the second."""
    if not isinstance(limits, tuple | list) or len(limits) != 2 or not all(isinstance(x, Real) for x in limits):
        return False
    return limits[0] <= limits[1]


def _categories(semantics: Int[np.ndarray, "q columns"]) -> frozenset[str]:
    """Return the names of fine and coarse categories of objects: rows with an object id, so not of the architecture."""
    rows = semantics[semantics[:, Semantic.OBJECT_ID] >= 0]
    fine, coarse = rows[:, Semantic.FINE].tolist(), rows[:, Semantic.COARSE].tolist()
    return frozenset({FINE[i] for i in fine if i >= 0} | {COARSE[i] for i in coarse if i >= 0})
