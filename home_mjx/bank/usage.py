"""How many bytes houses, models and textures take of a bank."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.bank.packing.capacity import Capacity
from home_mjx.bank.packing.pack import TABLES, Library, house_rows, house_slots, model_tables
from home_mjx.bank.packing.tables import Arrays
from home_mjx.bank.packing.texture_layers import texture_bytes
from home_mjx.schema.compiled import CompiledHouse


@dataclass(frozen=True)
class Usage:
    """Bytes in a bank, besides what rounds its tables up to a size class.

    Attributes:
        houses: What each house has to itself, its padded tables included, by id.
        models: What each library model takes, once for all houses, by key; the agent's is the first.
        textures: All texture layers.
    """

    houses: dict[str, int]
    models: dict[str, int]
    textures: int


def bank_usage(houses: Sequence[CompiledHouse]) -> Usage:
    """What some houses take of a bank.

    Args:
        houses: At least one.

    Example:
        >>> found = bank_usage([compiled])  # doctest: +SKIP
        >>> found.houses, max(found.models.values())  # doctest: +SKIP
        ({'0004d52d1aeeb8ae6de39d6bd993e992': 881_000}, 1_900_000)
    """
    library, capacity = Library.of(houses), Capacity.of(houses)
    at, own = dict.fromkeys(library.rows, 0), {}
    for house in houses:
        rows = house_rows(house, library, at, capacity)
        own[house.id] = _table_bytes(rows) + _bytes(house_slots([house], library, [at], capacity))
    models = {key: _table_bytes(model_tables(model, at)) for key, model in library.models.items()}
    return Usage(own, models, texture_bytes(len(library.textures)))


def _table_bytes(rows: Arrays) -> int:
    """Of rows as the tables hold them."""
    return sum(values.size * np.dtype(TABLES[name].dtype).itemsize for name, values in rows.items())


def _bytes(arrays: Arrays) -> int:
    return sum(values.nbytes for values in arrays.values())
