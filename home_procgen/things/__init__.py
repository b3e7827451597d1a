"""Parametric furniture and fittings; `library()` holds every model and is the same for all seeds."""

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType

from home_procgen.primitives.family import FurnitureModel, models_by_family
from home_procgen.things.appliances import fridges, hot_drinks, mixers, ovens, washing
from home_procgen.things.bath import basins, bathtubs, mirrors, paper, showers, toiletries, toilets, towels
from home_procgen.things.beds import bunks, cots, double, single
from home_procgen.things.decor import books, candles, clocks, figures, ornaments, pictures, table_clocks, vases
from home_procgen.things.electronics import cleaning, gadgets, phones, screens, sound, televisions
from home_procgen.things.family import FurnitureFamily
from home_procgen.things.green import plants
from home_procgen.things.kitchen import cabinets, cookers, hoods, sinks, wall_cabinets
from home_procgen.things.lamps import ceiling, chandeliers, floor, outdoor, pendants, table, wall
from home_procgen.things.leisure import gym, music, pianos
from home_procgen.things.openings import arches, doors, windows
from home_procgen.things.outdoors import tools, yard
from home_procgen.things.seats import armchairs, benches, chairs, garden_seats, office, ottomans, sofas, stools
from home_procgen.things.storage import (
    bookshelves,
    carts,
    dressers,
    hangers,
    media,
    nightstands,
    shelves,
    shoes,
    wardrobes,
)
from home_procgen.things.tables import coffee, desks, dining, vanities
from home_procgen.things.tableware import containers, cups, cutting, food, fruit, glasses, jugs, pans, plates
from home_procgen.things.textiles import curtains, cushions, rugs, wear
from home_procgen.things.toys import baskets, bins, pets, toys
from home_procgen.things.vehicles import cars, cycles
from home_procgen.things.walls import coolers, fans, fences, fireplaces, heaters, partitions, switches

__all__ = ["families", "family_models", "get_model", "library", "library_model"]

_MODULES = (
    *(chairs, stools, armchairs, office, sofas, ottomans, benches, garden_seats),
    *(dining, coffee, desks, vanities),
    *(double, single, cots, bunks),
    *(wardrobes, dressers, nightstands, media, shoes),
    *(bookshelves, shelves, hangers, carts),
    *(cabinets, wall_cabinets, sinks, cookers, hoods),
    *(fridges, washing, ovens, hot_drinks, mixers),
    *(cups, plates, glasses, fruit, cutting, pans, jugs, containers, food),
    *(toilets, basins, bathtubs, showers, towels, mirrors, paper, toiletries),
    *(table, floor, pendants, chandeliers, ceiling, wall, outdoor),
    *(televisions, screens, sound, phones, cleaning, gadgets),
    *(toys, pets, bins, baskets),
    wear,
    plants,
    *(curtains, rugs, cushions),
    *(vases, pictures, clocks, table_clocks, books, figures, ornaments, candles),
    *(doors, windows, arches),
    *(heaters, fireplaces, partitions, fences, switches, coolers, fans),
    gym,
    *(cars, cycles),
    *(tools, yard),
    *(pianos, music),
)


@cache
def families() -> Mapping[str, FurnitureFamily]:
    """Return the families of the library by name."""
    return {family.name: family for module in _MODULES for family in module.FAMILIES}


@cache
def get_model(family: str, number: int) -> FurnitureModel:
    """Return one library model, built on first use.

    Args:
        family: Name of the family.
        number: Number of the model, from 1.

    Example:
        >>> get_model("sofa", 2).id
        'home_sofa_2'
    """
    return families()[family].model(number)


def library_model(model_id: str) -> FurnitureModel:
    """Return the library model with an id.

    Example:
        >>> library_model("home_sofa_2") is get_model("sofa", 2)
        True
    """
    family, _, number = model_id.removeprefix("home_").rpartition("_")
    return get_model(family, int(number))


@cache
def library() -> Mapping[str, FurnitureModel]:
    """Return every model by id, in the order of the metadata rows.

    Example:
        >>> library()["home_sofa_2"].fine
        'sofa'
    """
    models = (get_model(family.name, n) for family in families().values() for n in family.numbers)
    return MappingProxyType({model.id: model for model in models})


@cache
def family_models() -> Mapping[str, Sequence[FurnitureModel]]:
    """Return the library models of every family."""
    return models_by_family(library().values())
