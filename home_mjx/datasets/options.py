"""Options of reading houses."""

from dataclasses import dataclass

from home_mjx.core.checks import check_flag


@dataclass(frozen=True)
class ReadOptions:
    """Which parts of a house are read.

    Args:
        people: Keep models of the coarse category `person`: dense, static meshes.
        plants: Keep models of the coarse category `plant`: foliage of many thousand triangles.
        backdrops: Keep boxes of 20 m and more whole. By default they are cut to the extent of the level.

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
        """Coarse categories whose objects are left out."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)
