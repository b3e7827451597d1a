"""What of a dataset's houses is read."""

from dataclasses import dataclass

from home_mjx.core.checks import check_flag


@dataclass(frozen=True)
class ReadOptions:
    """What of a house is read.

    Args:
        people: Keep models of the coarse category `person`: dense meshes that stand still.
        plants: Keep models of the coarse category `plant`: foliage of many thousand triangles.
        backdrops: Keep boxes of 20 m and more whole. By default what they show outside of the house is cut off.

    Example:
        >>> ReadOptions(people=False).categories_left_out
        ('person',)
    """

    people: bool = True
    plants: bool = True
    backdrops: bool = False

    def __post_init__(self) -> None:
        for name in ("people", "plants", "backdrops"):
            check_flag(name, getattr(self, name))

    @property
    def categories_left_out(self) -> tuple[str, ...]:
        """Coarse categories of which no object is read."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)
