"""All arrays of a bank: its records and its own fields."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Array, Int, UInt8

from home_mjx.bank.records.acoustics import Acoustics
from home_mjx.bank.records.declaration import Declaration, Key
from home_mjx.bank.records.fronts import CompartmentArrays, Fronts
from home_mjx.bank.records.geometry import Geometry
from home_mjx.bank.records.lights import Lights
from home_mjx.bank.records.materials import Finish, Materials
from home_mjx.bank.records.navigation import NavigationArrays
from home_mjx.bank.records.owners import HouseOwner
from home_mjx.bank.records.physics import Physics
from home_mjx.bank.records.switches import Switches
from home_mjx.core.pytree import Pytree, array, declared_arrays, static
from home_mjx.errors import ConfigError

ID_LENGTH = 32  # [bytes], axis "id_bytes" of house_id


def ascii_id(at: HouseOwner) -> UInt8[np.ndarray, " id_bytes"]:
    """Encode the house's id as `ID_LENGTH` bytes, padded with zeros.

    Raises:
        ConfigError: The id does not have 1 to `ID_LENGTH` ASCII characters.
    """
    data = at.house.id.encode()
    if not at.house.id.isascii() or not 0 < len(data) <= ID_LENGTH:
        raise ConfigError(f"house id `{at.house.id}` must be 1 to {ID_LENGTH} ASCII characters")
    return np.frombuffer(data.ljust(ID_LENGTH, b"\0"), np.uint8)


class BankSpec(Pytree):
    """Static sizes and options of a bank; sizes are size classes, so that similar banks share a compiled step."""

    num_instances: int = static()
    num_bodies: int = static()
    num_doors: int = static()
    num_starts: int = static()
    num_goals: int = static()
    cell: float = static()  # [m], navigation grid
    agent_radius: float = static()  # [m], of the agents that the houses were compiled for
    agent_height: float = static()  # [m]
    num_slides: int = static(default=0)  # number of sliding doors, the last ones
    num_tray_boxes: int = static(default=0)  # boxes that each sliding leaf may have besides its own, as drawers do


class BankArrays(Pytree):
    """Arrays of a `HouseBank`."""

    geometry: Geometry
    materials: Materials
    semantics: Int[Array, "semantic columns"] = array("columns: schema.semantic.Semantic", source="semantics", fill=-1)
    physics: Physics
    acoustics: Acoustics
    navigation: NavigationArrays
    finish: Finish
    lights: Lights
    switches: Switches
    fronts: Fronts
    compartments: CompartmentArrays
    reset_houses: Int[Array, " h"]  # house indices that resets draw from, each active house equally often
    house_id: UInt8[Array, "h id_bytes"] = array("ASCII of the dataset's house id", source=ascii_id)
    spec: BankSpec = static()
    # Baked records by name, see `home_mjx.houses.add_bakes`; empty: nothing is baked.
    bakes: dict[str, Any] = dataclasses.field(default_factory=dict)


Bank = TypeVar("Bank", bound=BankArrays)

RECORDS: dict[str, type] = {
    "": BankArrays,
    "geometry": Geometry,
    "materials": Materials,
    "physics": Physics,
    "acoustics": Acoustics,
    "navigation": NavigationArrays,
    "finish": Finish,
    "lights": Lights,
    "switches": Switches,
    "fronts": Fronts,
    "compartments": CompartmentArrays,
}


def declarations() -> tuple[Declaration, ...]:
    """Return the declarations of all arrays of a bank, record by record; without `reset_houses` and `bakes`.

    Example:
        >>> next(d for d in declarations() if d.name == "physics.body_mass").axes
        ('h', 'bodies')
    """
    return _declarations(tuple(RECORDS.items()))


@functools.cache
def _declarations(records: tuple[tuple[str, type], ...]) -> tuple[Declaration, ...]:
    """Return the declarations of the array fields of (name, class) records, in order; cached."""
    return tuple(
        Declaration.from_field((record, field), annotation, doc, **notes)
        for record, cls in records
        for field, (annotation, doc, notes) in declared_arrays(cls).items()
    )


def get_array(bank: BankArrays, key: Key) -> Array:
    """Return the array of a bank, not a copy, with the key (record, field); record "" is the bank itself."""
    record, field = key
    return getattr(getattr(bank, record) if record else bank, field)


def group_by_record(arrays: Mapping[Key, Any]) -> dict[str, dict[str, Any]]:
    """Group arrays by record, then by field; each record of `RECORDS` has an entry, empty if it has no arrays.

    Raise `KeyError` for other records; fields are not checked.
    """
    tables: dict[str, dict[str, Any]] = {name: {} for name in RECORDS}
    for (record, field), values in arrays.items():
        tables[record][field] = values
    return tables


def replace_arrays(bank: Bank, arrays: Mapping[Key, Array]) -> Bank:
    """Return a bank with the arrays of these keys (record, field) replaced; the given bank is unchanged.

    Other arrays are shared with it. Shapes and dtypes are not compared with those replaced.
    """
    tables = group_by_record(arrays)
    own = tables.pop("")
    records = {name: getattr(bank, name).replace(**fields) for name, fields in tables.items() if fields}
    return bank.replace(**own, **records)
