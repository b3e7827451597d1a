"""The library models of the building's own parts."""

from collections.abc import Mapping, Sequence
from functools import cache

from home_mjx.datasets.homes.structure import garage, railings, stairs
from home_mjx.datasets.procedural.primitives.family import Furniture


@cache
def structure_models() -> Mapping[str, Sequence[Furniture]]:
    """The models of every family.

    Example:
        >>> list(structure_models())
        ['stairs', 'railing', 'garage_door']
    """
    families = (*stairs.FAMILIES, *railings.FAMILIES, *garage.FAMILIES)
    return {family.name: tuple(family.models()) for family in families}
