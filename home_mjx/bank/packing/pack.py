"""Packing of compiled houses into the arrays of a `HouseBank`: host side, NumPy only.

Tables that rays traverse are concatenated, with absolute indices in BVHs: first shared rows, then each house's own
rows. Small arrays are padded. Every length except the number of houses is rounded up to a size class, so that similar
banks have equal shapes and share one compiled step. `bank.records` declares the arrays.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from home_mjx.bank.packing.capacity import (
    axis_lengths,
    capacity_of,
    check_fits,
    cumulative_starts,
    house_rows,
    ragged_class,
    required_lengths,
)
from home_mjx.bank.packing.library import Library, Owners
from home_mjx.bank.packing.texture_layers import TEXTURE_SIZE, cutout_shape, texture_shape
from home_mjx.bank.records.bank_arrays import BankSpec, declarations
from home_mjx.bank.records.declaration import HOUSE_AXIS, ROW_KINDS, SHARED, Arrays, Declaration, Key, Sizes
from home_mjx.bank.records.geometry import LEAF_BITS
from home_mjx.bank.records.owners import Counts
from home_mjx.core.workers import map_threads
from home_mjx.errors import CapacityError, ConfigError
from home_mjx.schema.compiled import CompiledHouse

MAX_TRIANGLES = 2 ** (31 - LEAF_BITS)
# Compiler options that must be equal for all houses of a bank, and their values in a house.
COMMON_OPTIONS: Mapping[str, Callable[[CompiledHouse], float]] = {
    "cell": lambda house: house.navigation.cell,
    "agent_radius": lambda house: house.navigation.agent_radius,
    "agent_height": lambda house: house.navigation.agent_height,
}
OPTION_LABELS = {"cell": "navigation cell size", "agent_radius": "agent radius", "agent_height": "agent height"}
# Axes whose lengths `BankSpec` stores.
SPEC_AXES = ("instances", "bodies", "doors", "slides", "tray_boxes", "starts", "goals")


@dataclass(frozen=True)
class PackedBank:
    """Arrays and static numbers of a `bank.HouseBank`."""

    arrays: Arrays
    spec: BankSpec


@dataclass(frozen=True)
class _Part:
    """Owners, and the first row of theirs in each kind of array."""

    owners: Owners
    start: Counts


def pack_bank(houses: Sequence[CompiledHouse], texture_size: int = TEXTURE_SIZE) -> PackedBank:
    """Pack houses into the arrays of a bank, in the given order.

    Args:
        houses: At least one house; all compiled for the same navigation cell and agents.
        texture_size: Edge of the square texture layers [px], a power of two.

    Raises:
        ConfigError: There is no house, houses were compiled differently, an id is not short ASCII, or `texture_size`
            is not a power of two.
        CapacityError: There are more triangles than leaf codes can address.
        DatasetError: A texture file is missing or is not an image.
    """
    library, sizes = plan_bank(houses, texture_size)
    starts = cumulative_starts(library.num_rows, [house_rows(house) for house in houses])
    return _packed(houses, library, sizes, starts, texture_size)


def plan_bank(houses: Sequence[CompiledHouse], texture_size: int = TEXTURE_SIZE) -> tuple[Library, dict[str, int]]:
    """Return the library that the houses share, and the length of every axis of their bank, by name.

    Lengths that the houses need are rounded up to size classes; the number of houses is not.

    Raises:
        ConfigError: There is no house.
        CapacityError: There are more triangles than leaf codes can address.
    """
    if not houses:
        raise ConfigError("a bank needs at least one house")
    library = Library.from_houses(houses)
    own = [house_rows(house) for house in houses]
    count = {kind: library.num_rows[kind] + sum(rows[kind] for rows in own) for kind in ROW_KINDS}
    check_triangles(count["triangle"])
    rows = {kind: ragged_class(number) for kind, number in count.items()}
    return library, _sizes(len(houses), library, capacity_of(houses), rows, texture_size)


def pack_house_slots(houses: Sequence[CompiledHouse], library: Library, capacity: Counts, stride: Counts) -> PackedBank:
    """Pack houses into a bank of exchangeable houses, each with `stride` rows in the concatenated tables.

    Textures have the default edge `TEXTURE_SIZE`.

    Args:
        houses: One house per slot, at least one.
        library: All models and textures of all houses that may ever be exchanged.
        capacity: Lengths of the axes of `AXES`, see `capacity_of`.
        stride: Maximum rows of each kind per house.

    Raises:
        CapacityError: A house needs more, or there are more triangles than leaf codes can address.
        ConfigError, DatasetError: As in `pack_bank`.
        KeyError: The library lacks a model or texture of a house.
    """
    for house in houses:
        check_house_fits(house, capacity, stride)
    rows = {kind: library.num_rows[kind] + len(houses) * stride[kind] for kind in ROW_KINDS}
    check_triangles(rows["triangle"])
    starts = [slot_start(library, stride, house_slot) for house_slot in range(len(houses))]
    return _packed(houses, library, _sizes(len(houses), library, capacity, rows, TEXTURE_SIZE), starts, TEXTURE_SIZE)


def pack_house_slot(
    house: CompiledHouse, library: Library, capacity: Counts, stride: Counts, house_slot: int
) -> tuple[Arrays, dict[Key, int]]:
    """Pack a house for a slot of a `pack_house_slots` bank: return its own arrays, padded, and first rows, by key.

    Concatenated tables have `stride` rows; others, a first axis of 1 instead of houses. Indices in them count the rows
    of the bank. Arrays shared by all houses are left out. Options such as the agent's radius are not compared with the
    bank's.

    Raises:
        CapacityError: The house does not fit `capacity` or `stride`, see `pack_house_slots`.
        ConfigError: The id is not short ASCII.
        KeyError: The library lacks a model or texture of the house.
    """
    check_house_fits(house, capacity, stride)
    start = slot_start(library, stride, house_slot)
    sizes = axis_lengths(capacity) | dict(stride) | {HOUSE_AXIS: 1}
    part = _Part(library.house_owners(house, start, sizes), dict.fromkeys((*ROW_KINDS, HOUSE_AXIS), 0))
    own = [d for d in declarations() if d.kind != SHARED]
    first = {**start, HOUSE_AXIS: house_slot}
    return _fill(own, [part], sizes), {d.key: first[d.kind] for d in own}


def slot_start(library: Library, stride: Counts, house_slot: int) -> dict[str, int]:
    """Return the first row of house slot number `house_slot` in each table; slots follow the library's rows."""
    return {kind: library.num_rows[kind] + house_slot * count for kind, count in stride.items()}


def check_house_fits(house: CompiledHouse, capacity: Counts, stride: Counts) -> None:
    """Raise `CapacityError` if a house needs longer axes than `capacity` or more rows than `stride`; equal ones fit."""
    check_fits(house.id, required_lengths(house), capacity)
    check_fits(house.id, house_rows(house), stride)


def check_triangles(count: int) -> None:
    """Raise `CapacityError` for `MAX_TRIANGLES` triangles or more, which leaf codes cannot address."""
    if count >= MAX_TRIANGLES:
        raise CapacityError(
            f"the bank's models have {count} triangles, at most {MAX_TRIANGLES - 1} fit",
            hint="Use fewer houses in one bank.",
        )


def common_options(houses: Sequence[CompiledHouse]) -> dict[str, float]:
    """Return the values of `COMMON_OPTIONS` in the first of the houses, which must agree to 9 decimals.

    Raises:
        ConfigError: The houses were compiled with different options.
    """
    for name, value in COMMON_OPTIONS.items():
        if len({round(value(house), 9) for house in houses}) > 1:
            raise ConfigError(f"the houses of a bank must have one {OPTION_LABELS[name]}", hint="Compile them alike.")
    return {name: float(value(houses[0])) for name, value in COMMON_OPTIONS.items()}


def _packed(
    houses: Sequence[CompiledHouse], library: Library, sizes: Sizes, starts: Sequence[Counts], texture_size: int
) -> PackedBank:
    """Build the bank's arrays from the library and the houses, whose rows begin at `starts`."""
    spec: dict[str, Any] = {f"num_{name}": sizes[name] for name in SPEC_AXES} | common_options(houses)
    parts = [_Part(library.owners(sizes) | library.shared_owners(texture_size), dict.fromkeys((*ROW_KINDS, SHARED), 0))]
    for i, (house, start) in enumerate(zip(houses, starts, strict=True)):
        parts.append(_Part(library.house_owners(house, start, sizes), {**start, HOUSE_AXIS: i}))
    return PackedBank(_fill(declarations(), parts, sizes), BankSpec(**spec))


def _sizes(num_houses: int, library: Library, capacity: Counts, rows: Counts, texture_size: int) -> dict[str, int]:
    """Return the length of every axis of a bank, by name; `rows` has those of `ROW_KINDS`."""
    layers, texels = texture_shape(len(library.textures), texture_size)
    edge, words = cutout_shape(texture_size)
    shared = {"layers": layers, "texels": texels, "edge": edge, "words": words}
    return {**axis_lengths(capacity), **rows, HOUSE_AXIS: num_houses, **shared}


def _fill(declarations: Iterable[Declaration], parts: Sequence[_Part], sizes: Sizes) -> Arrays:
    """Build every declared array by key, with the rows of its owners, elsewhere padding; arrays run in parallel."""
    declared = list(declarations)
    packed = map_threads(lambda d: d.pack(_placed(d, parts), sizes), declared)
    return {d.key: array for d, array in zip(declared, packed, strict=True)}


def _placed(declaration: Declaration, parts: Sequence[_Part]) -> list[tuple[int, np.ndarray]]:
    """Return (first row, values) of each owner of an array, as `Declaration.pack` takes them.

    Within a part, the rows of owners follow one another from the part's `start`, or 0 if it has none for the kind.
    """
    found, kind = [], declaration.kind
    for part in parts:
        row = part.start.get(kind, 0)
        for owner in part.owners.get(kind, ()):
            values = declaration.values(owner)
            found.append((row, values))
            row += len(values) if values.ndim else 0
    return found
