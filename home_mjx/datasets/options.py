"""Options of the house reader."""

from dataclasses import dataclass

from home_mjx.core.checks import check_flag


@dataclass(frozen=True)
class ReadOptions:
    """Selection of the parts of a house to read.

    Args:
        people: Keep models of the coarse category `person`: dense, static meshes.
        plants: Keep models of the coarse category `plant`: foliage of many thousand triangles.
        backdrops: Keep boxes of 20 m and more uncut. By default they are cut to the extent of the level.
        strict: Reject a house with a missing texture, model, room mesh or metadata row, instead of using fallbacks.
            None: strict for generated datasets, tolerant for all others.

    Example:
        >>> ReadOptions(people=False).excluded_categories
        ('person',)
    """

    people: bool = True
    plants: bool = True
    backdrops: bool = False
    strict: bool | None = None

    def __post_init__(self) -> None:
        for name in ("people", "plants", "backdrops"):
            check_flag(name, getattr(self, name))
        if self.strict is not None:
            check_flag("strict", self.strict)

    @property
    def excluded_categories(self) -> tuple[str, ...]:
        """Coarse categories of the objects to leave out."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)
