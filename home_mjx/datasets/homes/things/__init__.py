"""Things of many shapes: `library()` holds every model, the same for all seeds."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType

from home_mjx.datasets.homes.things.bath import fittings, supplies
from home_mjx.datasets.homes.things.beds import frames
from home_mjx.datasets.homes.things.green import decor, plants, textiles
from home_mjx.datasets.homes.things.kitchen import appliances, tableware, units
from home_mjx.datasets.homes.things.lamps import lamps
from home_mjx.datasets.homes.things.leisure import music, sport
from home_mjx.datasets.homes.things.openings import doors, walls
from home_mjx.datasets.homes.things.seats import armchairs, benches, chairs, sofas
from home_mjx.datasets.homes.things.small import electronics, toys, wear
from home_mjx.datasets.homes.things.storage import cabinets, shelves
from home_mjx.datasets.homes.things.tables import coffee, desks, dining
from home_mjx.datasets.procedural.primitives.family import Furniture

__all__ = ["family_models", "library"]

_MODULES = (
    *(chairs, armchairs, sofas, benches),
    *(dining, coffee, desks),
    *(frames, cabinets, shelves),
    *(units, appliances, tableware),
    *(fittings, supplies, lamps),
    *(electronics, toys, wear),
    *(plants, textiles, decor),
    *(doors, walls, sport, music),
)


@cache
def library() -> Mapping[str, Furniture]:
    """Every model by id, in the order of the metadata rows.

    Example:
        >>> library()["home_sofa_2"].fine
        'sofa'
    """
    families = [family for module in _MODULES for family in module.FAMILIES]
    return MappingProxyType({model.id: model for family in families for model in family.models()})


@cache
def family_models() -> Mapping[str, Sequence[Furniture]]:
    """The library models of every family."""
    families: dict[str, list[Furniture]] = defaultdict(list)
    for model in library().values():
        families[model.family].append(model)
    return dict(families)
