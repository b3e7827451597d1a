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
        strict: Refuse a house that lacks a texture, a model, a mesh of a room or a row of the tables, instead of
            taking stand-ins. None: strict for datasets that were generated, tolerant for all others.

    Example:
        >>> ReadOptions(people=False).categories_left_out
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
    def categories_left_out(self) -> tuple[str, ...]:
        """Coarse categories whose objects are left out."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)
