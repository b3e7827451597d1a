"""Recipes of furniture and fittings, from which `home_procgen.build_library` builds the shipped models."""

from collections.abc import Mapping
from functools import cache

from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel
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

__all__ = ["build_models", "families"]

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


def build_models(detail: str = DETAILS[0]) -> dict[str, FurnitureModel]:
    """Build every model from its recipe, by id, in the order of the metadata rows.

    Args:
        detail: Level of detail of the meshes.
    """
    models = (family.model(number, detail) for family in families().values() for number in family.numbers)
    return {model.id: model for model in models}
