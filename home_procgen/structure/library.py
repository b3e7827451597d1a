"""Library models of the building: stairs, railings and garage doors."""

from collections.abc import Mapping, Sequence
from functools import cache

from home_procgen.primitives.family import FurnitureModel
from home_procgen.structure import garage, railings, stairs


@cache
def structure_models() -> Mapping[str, Sequence[FurnitureModel]]:
    """Return the models of every family, by family name.

    Example:
        >>> list(structure_models())
        ['stairs', 'railing', 'garage_door']
    """
    families = (*stairs.FAMILIES, *railings.FAMILIES, *garage.FAMILIES)
    return {family.name: tuple(family.models()) for family in families}
