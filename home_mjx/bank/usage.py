"""Memory usage of a bank by houses, models and textures."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax

from home_mjx.bank.packing.library import Owners, model_owners
from home_mjx.bank.packing.pack import plan_bank
from home_mjx.bank.packing.texture_layers import texture_bytes
from home_mjx.bank.records.bank_arrays import BankArrays, declarations
from home_mjx.bank.records.declaration import HOUSE_AXIS, Sizes
from home_mjx.schema.compiled import CompiledHouse


@dataclass(frozen=True)
class Usage:
    """Bytes in a bank, without the padding of concatenated tables to a size class.

    Attributes:
        houses: Bytes private to each house, including its padded tables, by id.
        models: Bytes of each library model, shared by all houses, by key; the agent's is the first.
        textures: Bytes of all texture layers.
    """

    houses: dict[str, int]
    models: dict[str, int]
    textures: int


def bank_usage(houses: Sequence[CompiledHouse]) -> Usage:
    """Return the bytes that houses, at least one, models and textures would take in a bank, without building it.

    Textures have the default edge `TEXTURE_SIZE`; their files are read, to find cut-outs. Ids must be distinct, or only
    the last house of an id is listed.

    Raises:
        ConfigError: There is no house.
        CapacityError: The houses have too many triangles for one bank.
        DatasetError: A texture cannot be read.

    Example:
        >>> found = bank_usage([compiled])  # doctest: +SKIP
        >>> found.houses, max(found.models.values())  # doctest: +SKIP
        ({'0004d52d1aeeb8ae6de39d6bd993e992': 881_000}, 1_900_000)
    """
    library, sizes = plan_bank(houses)
    at = dict.fromkeys(library.num_rows, 0)
    own = {h.id: _owned_bytes(library.house_owners(h, at, sizes), sizes) for h in houses}
    models = {key: _owned_bytes(model_owners(model, at), sizes) for key, model in library.models.items()}
    return Usage(own, models, texture_bytes(len(library.textures)))


def planned_bytes(houses: Sequence[CompiledHouse]) -> dict[str, int]:
    """Return the bytes of each array of a bank of these houses, at least one, without building it.

    Names are such as "geometry.triangle". Textures have the default edge `TEXTURE_SIZE`. The derived layout of the
    `cuda` backend (`Geometry.gpu`) and the few bytes of `reset_houses` are excluded.

    Raises:
        ConfigError: There is no house.
        CapacityError: The houses have too many triangles for one bank.
    """
    _, sizes = plan_bank(houses)
    return {d.name: d.nbytes(sizes) for d in declarations()}


def bank_bytes(bank: BankArrays) -> int:
    """Return the size of all arrays of a bank, or of a bank of `jax.ShapeDtypeStruct`s [bytes].

    Bakes and `Geometry.gpu` are included.
    """
    return sum(leaf.size * leaf.dtype.itemsize for leaf in jax.tree.leaves(bank))


def _owned_bytes(owners: Owners, sizes: Sizes) -> int:
    """Return the total bytes of the rows of all `owners`; a house's own row, `HOUSE_AXIS`, counts with its padding."""
    total = 0
    for declaration in declarations():
        if declaration.kind == HOUSE_AXIS and HOUSE_AXIS in owners:
            total += declaration.nbytes({**sizes, HOUSE_AXIS: 1})
        elif declaration.kind in owners:
            values = (declaration.values(owner) for owner in owners[declaration.kind])
            total += sum(v.size for v in values) * declaration.dtype.itemsize
    return total
